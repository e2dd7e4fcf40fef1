// Motion of bodies without their joints: forces, and poses from velocities.
#pragma once

#include "runtime/state/world_data.hpp"

namespace cdot {

// velocity += h M^-1 f: constant forces, gravity, drag.
template <class S>
void apply_forces(WorldData<S>& world, Island<S>& island, typename S::Scalar h);

// M^-1 f of the same forces, explicitly, into Bodies::velocity_rate. free_accelerations() adds the gyroscopic torques:
// dv/dt without joints.
template <class S>
void push_free_bodies(WorldData<S>& world, Island<S>& island);
template <class S>
void free_accelerations(WorldData<S>& world, Island<S>& island);

// Immovable bodies of the island's joints stand still. Impulses add 0 to them, but infinite ones add NaN, for good.
// Call it after an attempt at a step that was given up.
template <class S>
void halt_immovable_bodies(WorldData<S>& world, const Island<S>& island);

// q += h v; bodies with a turning inertia tensor keep L = I w.
template <class S>
void integrate(WorldData<S>& world, Island<S>& island, typename S::Scalar h);

// True if all poses and velocities of an island are numbers.
template <class S>
bool finite(const WorldData<S>& world, const Island<S>& island);

// Sets the inertia tensors at the present poses, and w = I^-1 L. Call it after every change of poses, in a space with
// gyroscopes.
template <class S>
void turn_inertias(WorldData<S>& world, Island<S>& island);
// The same, but keeps w in place of L.
template <class S>
void set_inertias(WorldData<S>& world, Island<S>& island);
template <class S, class F>
void for_each_gyroscope(WorldData<S>& world, const Island<S>& island, F f) {
  for (int index : island.gyroscopes) f(world.gyroscopes[index], world.turning[index]);
}

}  // namespace cdot
