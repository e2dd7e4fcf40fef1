// Forces on bodies other than the joints': gravity, constant forces, drag.
#include <cdot/spaces.hpp>

#include "runtime/motion/motion.hpp"

namespace cdot {
template <class S>
void push_free_bodies(WorldData<S>& world, Island<S>& island) {
  using T = typename S::Scalar;
  Bodies<S>& all = world.bodies;
  for (int i : island.bodies) all.velocity_rate[i] = all.acceleration[i];
  for (const Drag<S>& drag : island.drags) {
    const auto slowing = S::damped(all.velocity[drag.body], drag.linear, drag.angular);
    all.velocity_rate[drag.body] = S::sum(all.velocity_rate[drag.body], slowing, T(-1));
  }
}

template <class S>
void free_accelerations(WorldData<S>& world, Island<S>& island) {
  push_free_bodies(world, island);
  if constexpr (S::has_gyroscopes) {
    Bodies<S>& all = world.bodies;
    for_each_gyroscope(world, island, [&](const auto& gyroscope, int i) {
      S::add_gyroscopic_rate(gyroscope, all.inverse_mass[i], all.velocity_rate[i]);
    });
  }
}

template <class S>
void apply_forces(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  using T = typename S::Scalar;
  Bodies<S>& all = world.bodies;
  // dv/dt = -d v, implicitly: v / (1 + h d) never overshoots 0. Drag comes before the forces, so it does not damp the h
  // g of a body that hangs at rest.
  for (const Drag<S>& drag : island.drags)
    all.velocity[drag.body] =
        S::damped(all.velocity[drag.body], T(1) / (T(1) + h * drag.linear), T(1) / (T(1) + h * drag.angular));
  // Tension adds to the effective inertia, so torques act through effective_mass.
  for (int i : island.bodies) {
    const auto& rate = all.acceleration[i];
    all.velocity[i] =
        S::sum(all.velocity[i],
               island.stiffened ? S::weighted(all.effective_mass[i], S::force(all.inverse_mass[i], rate)) : rate, h);
  }
}

template <class S>
void halt_immovable_bodies(WorldData<S>& world, const Island<S>& island) {
  Bodies<S>& all = world.bodies;
  for (const Segment<S>& segment : island.segments) {
    const Batch<S>& batch = *segment.batch;
    const int bodies = batch.ops->bodies;
    for (int i = segment.begin * bodies; i < segment.whole_end * bodies; ++i)
      if (const int k = batch.body[i]; all.immovable(k))
        all.velocity[k] = all.velocity_rate[k] = all.displacement[k] = all.increment[k] = {};
  }
}

#define CDOT_INSTANTIATE(S)                                             \
  template void push_free_bodies(WorldData<S>&, Island<S>&);            \
  template void free_accelerations(WorldData<S>&, Island<S>&);          \
  template void halt_immovable_bodies(WorldData<S>&, const Island<S>&); \
  template void apply_forces(WorldData<S>&, Island<S>&, S::Scalar);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
