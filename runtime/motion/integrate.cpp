// Symplectic Euler, first order: the poses advance with the new velocities. A body with a turning inertia tensor
// rotates by its mean spin of the step. That rotation is second order and conserves the angular momentum.
#include <cmath>

#include <cdot/spaces.hpp>

#include "runtime/motion/motion.hpp"

namespace cdot {

template <class S>
void turn_inertias(WorldData<S>& world, Island<S>& island) {
  Bodies<S>& all = world.bodies;
  for_each_gyroscope(world, island, [&](auto& gyroscope, int i) {
    S::turn(gyroscope, all.pose[i], all.inverse_mass[i], all.velocity[i]);
    S::turn_acceleration(gyroscope, all.inverse_mass[i], all.acceleration[i]);
    // With geometric stiffness the effective mass of the step's start stays until the next step.
    if (!island.stiffened) all.effective_mass[i] = all.inverse_mass[i];
  });
}

template <class S>
void set_inertias(WorldData<S>& world, Island<S>& island) {
  Bodies<S>& all = world.bodies;
  for_each_gyroscope(world, island, [&](auto& gyroscope, int i) {
    S::set_inertia(gyroscope, all.pose[i], all.inverse_mass[i], all.velocity[i]);
    S::turn_acceleration(gyroscope, all.inverse_mass[i], all.acceleration[i]);
    all.effective_mass[i] = all.inverse_mass[i];
  });
}

template <class S>
void integrate(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  Bodies<S>& all = world.bodies;
  if constexpr (S::has_gyroscopes)
    for_each_gyroscope(world, island,
                       [&](auto& gyroscope, int i) { S::lend_mean_spin(gyroscope, all.pose[i], all.velocity[i], h); });
  for (int i : island.bodies) all.pose[i] = S::moved(all.pose[i], S::sum({}, all.velocity[i], h));
  if constexpr (S::has_gyroscopes) {
    for_each_gyroscope(world, island, [&](auto& gyroscope, int i) { S::restore_spin(gyroscope, all.velocity[i]); });
    turn_inertias(world, island);
  }
  island.evaluated = island.factored = false;
}

template <class S>
bool finite(const WorldData<S>& world, const Island<S>& island) {
  using T = typename S::Scalar;
  T sum = 0;
  for (int i : island.bodies) {
    T numbers[S::pose_numbers + S::freedom];
    S::write(world.bodies.pose[i], numbers);
    S::write(world.bodies.velocity[i], numbers + S::pose_numbers);
    for (T number : numbers) sum += number;
  }
  return std::isfinite(sum);
}

#define CDOT_INSTANTIATE(T)                                                 \
  template void turn_inertias(WorldData<Spatial<T>>&, Island<Spatial<T>>&); \
  template void set_inertias(WorldData<Spatial<T>>&, Island<Spatial<T>>&);
CDOT_FOR_EACH_NUMBER(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE
#define CDOT_INSTANTIATE(S)                                      \
  template void integrate(WorldData<S>&, Island<S>&, S::Scalar); \
  template bool finite(const WorldData<S>&, const Island<S>&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
