// Numbers that follow functions of time jump or have kinks at times that are known. A step that would pass one ends
// there, so that each step sees one smooth piece and every method keeps its order.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "runtime/state/world_data.hpp"

namespace cdot {

// Call before a step from `time` on, of about h: its numbers in time will be those from `time` on to the returned time,
// the first one at which a derivative of this order or a lower one jumps; of joints and ends, which prescribe
// positions, at least a kink. An end whose speed falls in the last instant of a step would take back what it pushed
// before. Infinite without such a time.
template <class S>
double begin_piece(WorldData<S>& world, Island<S>& island, double time, double h, int order);

// The same for the awake islands, as methods with steps from outside need it: at jumps.
template <class S>
double begin_pieces(WorldData<S>& world, double time, double h);

// Times this near count as one: a jump there was meant to be at the start of a step from `time` on of about h, or at
// its end.
template <class T>
double one_time(double time, double h) {
  return std::max(1e-9 * h, 4 * double(std::numeric_limits<T>::epsilon()) * std::abs(time));
}

// The joint with a number that has left its range, or is not finite; -1: none.
template <class S>
int joint_out_of_range(const Island<S>& island);

}  // namespace cdot
