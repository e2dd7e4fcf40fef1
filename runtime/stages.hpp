// The stages of a step, in the order in which step() calls them. One file each.
#pragma once

#include "runtime/world_state.hpp"

namespace cdot {

// Islands, order of slots, patterns: all that depends on what is connected, not on where it is.
// Allocates; does nothing if nothing was added since.
template <class S>
void prepare_topology(WorldState<S>& world);

// velocity += h M^-1 f: constant forces, gravity, springs between points, drag.
template <class S>
void apply_forces(WorldState<S>& world, Island<S>& island, typename S::Scalar h);

// Adds to the inertias what the tension of the last step's impulses stiffens. Only if the settings
// ask for it.
template <class S>
void stiffen_bodies(WorldState<S>& world, Island<S>& island, typename S::Scalar h);

// C, J, bias of every row at the present poses, and of rows under a law its softness and bounds.
template <class S>
void evaluate_rows(WorldState<S>& world, Island<S>& island, typename S::Scalar h);

// Impulses such that J v = -bias, by the solver of the settings.
template <class S>
void solve_iterative(WorldState<S>& world, Island<S>& island, typename S::Scalar h);
template <class S>
void solve_direct(WorldState<S>& world, Island<S>& island);

// q += h v; bodies whose inertia tensor turns with them keep I w.
template <class S>
void integrate(WorldState<S>& world, Island<S>& island, typename S::Scalar h);

// The inertia tensors at the present poses, w = I^-1 L with them: for whoever moves poses, in a
// space that has gyroscopes.
template <class S>
void turn_inertias(WorldState<S>& world, Island<S>& island);
template <class S, class F>
void for_each_gyroscope(WorldState<S>& world, const Island<S>& island, F f) {
  for (int index : island.gyroscopes) f(world.gyroscopes[index], world.gyroscopes[index].body);
}

// Brings the poses back to C = 0, and the velocities with them. Only for Drift::projection.
template <class S>
void settle_poses(WorldState<S>& world, Island<S>& island);
template <class S>
void correct_drift(WorldState<S>& world, Island<S>& island, typename S::Scalar h);

// Islands that have rested long enough fall asleep.
template <class S>
void put_to_sleep(WorldState<S>& world, double h);
template <class S>
void wake(WorldState<S>& world, int body);

// Fills K and, where the iterative solver needs it, its factorisation.
template <class S>
void factorize_rows(WorldState<S>& world, Island<S>& island);

}  // namespace cdot
