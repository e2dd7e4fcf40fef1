// What acts on bodies without a joint: gravity, constant forces, springs between points, drag.
#include "runtime/spaces.hpp"
#include "runtime/stages.hpp"

namespace cdot {

template <class S>
void apply_forces(WorldState<S>& world, Island<S>& island, typename S::Scalar h) {
  using T = typename S::Scalar;
  Bodies<S>& all = world.bodies;
  // dv/dt = -d v, implicitly: v / (1 + h d) never overshoots 0. Before the forces, so that it does
  // not dampen the h g of a body that hangs at rest.
  for (const Drag<S>& drag : island.drags)
    all.velocity[drag.body] = S::damped(all.velocity[drag.body], T(1) / (T(1) + h * drag.linear),
                                        T(1) / (T(1) + h * drag.angular));
  for (const auto& spring : island.springs) {
    const auto a = static_cast<size_t>(spring.body_a), b = static_cast<size_t>(spring.body_b);
    const auto stretch = S::stretch(spring, all.pose[a], all.pose[b]);
    const T impulse = h * S::tension(spring, stretch, all.velocity[a], all.velocity[b]);
    const auto on_a = S::weighted(all.effective_mass[a], S::pull_on_a(stretch, impulse));
    const auto on_b = S::weighted(all.effective_mass[b], S::pull_on_b(stretch, impulse));
    all.velocity[a] = S::sum(all.velocity[a], on_a, T(1));
    all.velocity[b] = S::sum(all.velocity[b], on_b, T(1));
  }
  for (int i : island.bodies) all.velocity[i] = S::sum(all.velocity[i], all.acceleration[i], h);
}

#define CDOT_INSTANTIATE(S) template void apply_forces(WorldState<S>&, Island<S>&, S::Scalar);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
