#include "runtime/direct/elimination_order.hpp"

#include <algorithm>
#include <iterator>
#include <set>
#include <tuple>

namespace cdot {
namespace {

// The criteria of choice: whether the elimination adds fill-in, rows of the neighbours, length of the chain of
// eliminations before it, the block's number.
using Key = std::tuple<bool, int, int, int>;

int rows_of(const std::vector<int>& blocks, const std::vector<int>& rows) {
  int sum = 0;
  for (int block : blocks) sum += rows[block];
  return sum;
}

// Above this number of neighbours the check of all pairs costs more than it saves.
constexpr size_t most_looked_at = 64;

bool fills_in(int block, const std::vector<std::vector<int>>& neighbours) {
  if (neighbours[block].size() > most_looked_at) return true;
  for (int i : neighbours[block])
    for (int j : neighbours[block])
      if (j < i && !std::binary_search(neighbours[i].begin(), neighbours[i].end(), j)) return true;
  return false;
}

// The union of two sorted lists, without i and k.
std::vector<int> united_without(const std::vector<int>& a, const std::vector<int>& b, int i, int k) {
  std::vector<int> both;
  both.reserve(a.size() + b.size());
  std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
  both.erase(std::remove_if(both.begin(), both.end(), [&](int j) { return j == i || j == k; }), both.end());
  return both;
}

// One block at a time.
std::vector<Elimination> single_order(const std::vector<int>& rows, std::vector<std::vector<int>> neighbours) {
  const int count = static_cast<int>(rows.size());
  std::vector<Key> key;
  const auto key_of = [&](int i, int succession) {
    return Key{fills_in(i, neighbours), rows_of(neighbours[i], rows), succession, i};
  };
  for (int i = 0; i < count; ++i) key.push_back(key_of(i, 0));
  std::set<Key> waiting(key.begin(), key.end());
  std::vector<Elimination> order;
  while (!waiting.empty()) {
    const auto [fills, degree, succession, block] = *waiting.begin();
    waiting.erase(waiting.begin());
    order.push_back({{block}, std::move(neighbours[block])});
    const std::vector<int>& clique = order.back().neighbours;
    for (int i : clique) neighbours[i] = united_without(neighbours[i], clique, i, block);
    for (int i : clique) {
      waiting.erase(key[i]);
      key[i] = key_of(i, std::max(std::get<2>(key[i]), succession + 1));
      waiting.insert(key[i]);
    }
  }
  return order;
}

std::vector<int> places(const std::vector<Elimination>& order, size_t blocks) {
  std::vector<int> place(blocks);
  int next = 0;
  for (const Elimination& one : order)
    for (int block : one.blocks) place[block] = next++;
  return place;
}

void sort_neighbours(std::vector<Elimination>& order, size_t blocks) {
  const std::vector<int> place = places(order, blocks);
  for (Elimination& one : order)
    std::sort(one.neighbours.begin(), one.neighbours.end(), [&](int i, int j) { return place[i] < place[j]; });
}

// Joins a block to the next one if its neighbours are that block and that block's neighbours. Both then need one update
// of the others in place of two. Blocks without such an update stay single.
std::vector<Elimination> joined(std::vector<Elimination> order, const std::vector<int>& rows, int widest) {
  std::vector<int> holder = places(order, rows.size());
  std::vector<Elimination> joined;
  for (Elimination& one : order) {
    const int next = one.neighbours.empty() ? -1 : holder[one.neighbours.front()];
    if (one.neighbours.size() > 1 && one.neighbours.size() == order[next].neighbours.size() + 1 &&
        rows_of(one.blocks, rows) + rows_of(order[next].blocks, rows) <= widest)
      order[next].blocks.insert(order[next].blocks.begin(), one.blocks.begin(), one.blocks.end());
    else joined.push_back(std::move(one));
  }
  return joined;
}

}  // namespace

std::vector<Elimination> minimum_degree_order(const std::vector<int>& rows, std::vector<std::vector<int>> neighbours,
                                              int widest) {
  auto order = single_order(rows, std::move(neighbours));
  sort_neighbours(order, rows.size());
  order = joined(std::move(order), rows, widest);
  sort_neighbours(order, rows.size());
  return order;
}

}  // namespace cdot
