// Numbers that follow functions of time jump or have kinks at times that are known. A step that would pass one ends
// there, so that each step sees one smooth piece and every method keeps its order.
#pragma once

#include "runtime/state/world_data.hpp"

namespace cdot {

// Call before a step from `time` on, of about h: its numbers in time will be those from `time` on to the returned time,
// the first one at which a derivative of this order or a lower one jumps; of joints, which prescribe positions, at
// least a kink. Infinite without such a time.
template <class S>
double begin_piece(WorldData<S>& world, Island<S>& island, double time, double h, int order);

// The same for the awake islands, as methods with steps from outside need it: at jumps.
template <class S>
double begin_pieces(WorldData<S>& world, double time, double h);

// True if a number of the island has left its range, or is not finite.
template <class S>
bool leaves_its_range(const Island<S>& island);

}  // namespace cdot
