// Linear and angular momentum of an island. A rule whose joints act at poses that miss C = 0 by a little exerts a small
// wrench on a mechanism that is free in space; restore_momentum() takes it back as a rigid motion.
#pragma once

#include <algorithm>

#include <cdot/precision.hpp>

#include "runtime/motion/vectors.hpp"
#include "runtime/state/world_data.hpp"

namespace cdot {

// In world axes, the angular one about the centre of mass. In the plane only z of rotations differs from 0.
template <class T>
struct Momentum {
  T mass = 0;                                     // [kg]
  spatial::Vector<T> centre{}, linear{}, spin{};  // [m], [N s], [N m s]
  T linear_size = 0, spin_size = 0;               // sums of the bodies' magnitudes
  spatial::Vector<T> force{}, torque{};           // sums of constant ones [N], [N m]
  spatial::Symmetric<T> inertia{};                // about the centre of mass [kg m^2]
};
template <class S>
using MomentumOf = Momentum<ExactNumber<typename S::Scalar>>;

// True if constant forces act on its bodies: at moving places they have a torque that is not constant.
template <class S>
bool pushed(const WorldData<S>& world, const Island<S>& island) {
  return std::any_of(island.bodies.begin(), island.bodies.end(),
                     [&](int i) { return norm(twist<double>(world.bodies.force[i]).linear) > 0; });
}

template <class S>
MomentumOf<S> momentum_of(const WorldData<S>& world, const Island<S>& island);

// Adds the rigid motion that gives a free island the momentum of `start`, plus that of constant forces over h. The
// poses of the start are those in Flow::pose.
template <class S>
void restore_momentum(WorldData<S>& world, const Island<S>& island, const MomentumOf<S>& start, typename S::Scalar h);

// The motion of an island's bodies against each other into Bodies::increment; its energy [J].
template <class S>
double find_own_motion(WorldData<S>& world, const Island<S>& island);
// Leaves this share of that motion. The island's momentum stays where nothing holds it.
template <class S>
void keep_own_motion(WorldData<S>& world, const Island<S>& island, double share);
// Moves the bodies over h: against each other by q += h v, in axes that move with the island as one rigid body. That
// motion is of second order and changes no distances, so fast turning loads no springs.
template <class S>
void move_in_own_axes(WorldData<S>& world, const Island<S>& island, typename S::Scalar h);
// Moves them along with the island's linear momentum alone: their orientations keep each bit.
template <class S>
void move_along(WorldData<S>& world, const Island<S>& island, typename S::Scalar h);

}  // namespace cdot
