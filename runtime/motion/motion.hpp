// How bodies move apart from their joints: forces, and poses from velocities.
#pragma once

#include "runtime/state/world_data.hpp"

namespace cdot {

// velocity += h M^-1 f: constant forces, gravity, springs between points, drag.
template <class S>
void apply_forces(WorldData<S>& world, Island<S>& island, typename S::Scalar h);

// M^-1 of the same forces, explicitly, into Bodies::velocity_rate; and with the gyroscopic torques dv/dt of bodies
// without joints.
template <class S>
void push_free_bodies(WorldData<S>& world, Island<S>& island);
template <class S>
void free_accelerations(WorldData<S>& world, Island<S>& island);

// q += h v; bodies whose inertia tensor turns with them keep I w.
template <class S>
void integrate(WorldData<S>& world, Island<S>& island, typename S::Scalar h);

// The inertia tensors at the present poses, w = I^-1 L with them: for whoever moves poses, in a
// space that has gyroscopes.
template <class S>
void turn_inertias(WorldData<S>& world, Island<S>& island);
// The same with w kept in place of L.
template <class S>
void set_inertias(WorldData<S>& world, Island<S>& island);
template <class S, class F>
void for_each_gyroscope(WorldData<S>& world, const Island<S>& island, F f) {
  for (int index : island.gyroscopes) f(world.gyroscopes[index], world.turning[index]);
}

}  // namespace cdot
