// Linear and angular momentum of an island. A rule whose joints act at poses that miss C = 0 by a little exerts a small
// wrench on a mechanism that is free in space; restore_momentum() takes it back as a rigid motion.
#pragma once

#include <cdot/rotation.hpp>

#include "runtime/state/world_data.hpp"

namespace cdot {

// In world axes, the angular one about the centre of mass. In the plane only z of rotations differs from 0.
template <class T>
struct Momentum {
  T mass = 0;                                     // [kg]
  spatial::Vector<T> centre{}, linear{}, spin{};  // [m], [N s], [N m s]
  spatial::Symmetric<T> inertia{};                // about the centre of mass [kg m^2]
};
template <class S>
Momentum<typename S::Scalar> momentum_of(const WorldData<S>& world, const Island<S>& island);

// Adds the rigid motion that gives a free island the momentum of `start`, plus that of constant forces over h. The
// poses of the start are those in Flow::pose.
template <class S>
void restore_momentum(WorldData<S>& world, const Island<S>& island, const Momentum<typename S::Scalar>& start,
                      typename S::Scalar h);

}  // namespace cdot
