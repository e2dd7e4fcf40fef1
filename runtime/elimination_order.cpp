#include "runtime/elimination_order.hpp"

#include <algorithm>
#include <iterator>
#include <set>
#include <tuple>

namespace cdot {
namespace {

// What a block is chosen by: rows of its neighbours, length of the succession that it waits for,
// its number.
using Key = std::tuple<int, int, int>;

int rows_of(const std::vector<int>& blocks, const std::vector<int>& rows) {
  int sum = 0;
  for (int block : blocks) sum += rows[block];
  return sum;
}

// Both sorted; without i and k.
std::vector<int> united_without(const std::vector<int>& a, const std::vector<int>& b, int i, int k) {
  std::vector<int> both;
  both.reserve(a.size() + b.size());
  std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
  both.erase(std::remove_if(both.begin(), both.end(), [&](int j) { return j == i || j == k; }),
             both.end());
  return both;
}

}  // namespace

std::vector<Elimination> minimum_degree_order(const std::vector<int>& rows,
                                              std::vector<std::vector<int>> neighbours) {
  const int count = static_cast<int>(rows.size());
  std::vector<Key> key;
  for (int i = 0; i < count; ++i) key.emplace_back(rows_of(neighbours[i], rows), 0, i);
  std::set<Key> waiting(key.begin(), key.end());
  std::vector<Elimination> order;
  std::vector<int> place(rows.size());
  while (!waiting.empty()) {
    const auto [degree, succession, block] = *waiting.begin();
    waiting.erase(waiting.begin());
    place[block] = static_cast<int>(order.size());
    order.push_back({block, std::move(neighbours[block])});
    const std::vector<int>& clique = order.back().neighbours;
    for (int i : clique) {
      waiting.erase(key[i]);
      neighbours[i] = united_without(neighbours[i], clique, i, block);
      key[i] = {rows_of(neighbours[i], rows), std::max(std::get<1>(key[i]), succession + 1), i};
      waiting.insert(key[i]);
    }
  }
  for (Elimination& one : order)
    std::sort(one.neighbours.begin(), one.neighbours.end(),
              [&](int i, int j) { return place[i] < place[j]; });
  return order;
}

}  // namespace cdot
