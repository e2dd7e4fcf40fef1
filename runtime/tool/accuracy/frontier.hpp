// What is worth choosing among measured points: the frontier of error and cost, and advice for every decade.
#pragma once

#include <optional>
#include <vector>

namespace cdot {

struct CostedError {
  double error;  // [m, rad]
  double cost;   // CPU seconds per simulated second
};

// The indices of the points that no other point beats: none has both a smaller error and a smaller cost. Ascending by
// cost; of equal ones the first. Errors below `resolution` cannot be told apart and count as equal to it, and an error
// that is smaller by less than the share `margin` is no reason to pay more.
std::vector<std::size_t> frontier_of(const std::vector<CostedError>& points, double resolution, double margin = 0);

// The cheapest point of the frontier for every decade of accuracy that somebody may ask for and that the points reach.
struct Advice {
  int decade;                    // the error asked for is 10^decade
  std::size_t point;             // index into the points
  std::optional<double> factor;  // what ten times more accuracy costs; none where nothing measured reaches it
};
std::vector<Advice> advice_from(const std::vector<CostedError>& points, const std::vector<std::size_t>& frontier,
                                int coarsest_decade = -1, int finest_decade = -10);

}  // namespace cdot
