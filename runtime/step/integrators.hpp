// The integrators, one file each.
#pragma once

#include "runtime/state/world_state.hpp"

namespace cdot {

// One step of h of the integrator of the settings, for one island.
template <class S>
void step_euler(WorldState<S>& world, Island<S>& island, typename S::Scalar h);
template <class S>
void step_rattle(WorldState<S>& world, Island<S>& island, typename S::Scalar h);
template <class S>
void step_runge_kutta(WorldState<S>& world, Island<S>& island, typename S::Scalar h);

}  // namespace cdot
