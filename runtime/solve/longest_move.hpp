// How far a projection moves the bodies for the error that it removes. A regular projection moves them by a few times
// the error; near a singular pose by the error over the smallest singular value. Where no near pose satisfies the
// joints, as in a closed loop of which one part is 1 mm too long, Newton finds one a metre away or none at all.
#pragma once

#include <algorithm>
#include <cmath>

#include "runtime/state/world_data.hpp"

namespace cdot {

// A projection goes too far if it moves a body by more than farthest_reach + 2 n times the error, n bodies in the
// island, and by more than `noticeable` sizes of the island. Over all scenes and hard cases a sound projection stays
// below 80 times (a taut bridge); the errors of a chain's n joints add up.
inline constexpr double farthest_reach = 200, noticeable = 1e-3;

struct LongestMove {
  double way = 0;  // [m]; rotations count with the island's size as arm
  int body = -1;
};

// The largest of `moves`, or of changes of velocity.
template <class S, class Moves>
LongestMove longest_move(const Island<S>& island, const Moves& moves) {
  LongestMove found;
  for (int i : island.bodies) {
    typename S::Scalar numbers[S::freedom];
    S::write(moves[i], numbers);
    double lengths = 0, angles = 0;
    for (int k = 0; k < S::freedom; ++k) (k < S::lengths ? lengths : angles) += double(numbers[k]) * double(numbers[k]);
    const double way = std::sqrt(std::max(lengths, angles * double(island.size) * double(island.size)));
    if (way > found.way) found = {way, i};
  }
  return found;
}

// `error`: of a row, in [m] or [rad]; an angle moves a body of the island's size by up to that arm.
template <class S>
bool too_far(const Island<S>& island, const LongestMove& move, double error) {
  const double size = double(island.size), times = farthest_reach + 2 * static_cast<double>(island.bodies.size());
  return move.way > times * error * std::max(1.0, size) && move.way > noticeable * size;
}

}  // namespace cdot
