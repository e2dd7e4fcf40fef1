// Newton for the middle of a step of the implicit midpoint rule (midpoint.cpp).
#pragma once

#include "runtime/state/world_data.hpp"

namespace cdot {

// Newton for v_m and lambda of a step of h from the start in Flow. Leaves v_m in the velocities, lambda in
// Batch::correction, the end in the poses, and J v of the mean velocity in Batch::rate. False if the step is too long
// for it.
template <class S>
bool find_middle(WorldData<S>& world, Island<S>& island, typename S::Scalar h);

}  // namespace cdot
