// Euler's step of h with Drift::soft. The present impulses are those of a step of `last_step`; 0: none.
#pragma once

#include "runtime/state/world_data.hpp"

namespace cdot {

template <class S>
void step_soft(WorldData<S>& world, Island<S>& island, typename S::Scalar h, double last_step);

}  // namespace cdot
