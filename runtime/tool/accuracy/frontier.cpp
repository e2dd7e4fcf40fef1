// Errors and costs -> the frontier, and advice from it.
#include "runtime/tool/accuracy/frontier.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace cdot {

std::vector<std::size_t> frontier_of(const std::vector<CostedError>& points, double resolution, double margin) {
  const auto error = [&](std::size_t k) { return std::max(points[k].error, resolution); };
  std::vector<std::size_t> by_cost(points.size());
  std::iota(by_cost.begin(), by_cost.end(), std::size_t{0});
  std::stable_sort(by_cost.begin(), by_cost.end(), [&](std::size_t a, std::size_t b) {
    return points[a].cost != points[b].cost ? points[a].cost < points[b].cost : error(a) < error(b);
  });
  std::vector<std::size_t> frontier;
  double best = std::numeric_limits<double>::infinity();
  for (const std::size_t k : by_cost) {
    if (error(k) >= (1 - margin) * best) continue;
    best = error(k);
    frontier.push_back(k);
  }
  return frontier;
}

std::vector<Advice> advice_from(const std::vector<CostedError>& points, const std::vector<std::size_t>& frontier,
                                int coarsest_decade, int finest_decade) {
  std::vector<Advice> advice;
  for (int decade = coarsest_decade; decade >= finest_decade; --decade) {
    const auto cheapest = std::find_if(frontier.begin(), frontier.end(),
                                       [&](std::size_t k) { return points[k].error <= std::pow(10.0, decade); });
    if (cheapest == frontier.end()) break;
    if (!advice.empty()) advice.back().factor = points[*cheapest].cost / points[advice.back().point].cost;
    advice.push_back({decade, *cheapest, {}});
  }
  return advice;
}

}  // namespace cdot
