// Measured points -> the frontier of error and cost, and advice for every decade.
#pragma once

#include <optional>
#include <vector>

namespace cdot {

struct CostedError {
  double error;  // [m, rad]
  double cost;   // CPU seconds per simulated second
};

// The indices of the points on the frontier, by ascending cost: no other point has a smaller error and a smaller cost.
// Errors below `resolution` count as equal to it. A point must have an error smaller by the share `margin` to count.
std::vector<std::size_t> frontier_of(const std::vector<CostedError>& points, double resolution, double margin = 0);

// The cheapest point of the frontier for every decade of accuracy that the points reach.
struct Advice {
  int decade;                    // the accuracy is 10^decade
  std::size_t point;             // index into the points
  std::optional<double> factor;  // cost of ten times more accuracy; none if no point reaches it
};
std::vector<Advice> advice_from(const std::vector<CostedError>& points, const std::vector<std::size_t>& frontier,
                                int coarsest_decade = -1, int finest_decade = -10);

}  // namespace cdot
