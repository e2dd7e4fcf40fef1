#include "runtime/step/dampers.hpp"

#include <algorithm>

#include <cdot/spaces.hpp>

namespace cdot {

template <class S>
void weigh_springs(const WorldData<S>& world, const Island<S>& island) {
  for (const auto& [batch, begin, end, whole] : island.segments)
    if (is_force(*batch)) batch->ops->effective_mass(*batch, begin, end, world.bodies);
}

template <class S>
void find_spring_impulses(Batch<S>& batch, int begin, int end, typename S::Scalar h) {
  constexpr typename S::Scalar at_rest[most_rows] = {};
  const int rows = batch.ops->rows;
  for (int slot = begin; slot < end; ++slot) batch.law->force(batch, slot, at_rest, batch.impulse.data() + slot * rows);
  for (int i = begin * rows; i < end * rows; ++i) batch.impulse[i] *= h;
}

template <class S>
void push_dampers(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  using T = typename S::Scalar;
  auto* const v = world.bodies.velocity.data();
  for (const auto& [segment, begin, end, whole] : island.segments) {
    Batch<S>& batch = *segment;
    if (!batch.law || !batch.law->spring) continue;
    batch.ops->velocity(batch, begin, end, v, batch.rate.data());
    find_spring_impulses(batch, begin, end, h / 2);
    each_spring(batch, begin, end, [&](int i, const SpringNumbers<T>& spring, T K) {
      const T damping = -dampers(spring, K, h, false).start * (batch.rate[i] + batch.bias[i]);
      batch.lambda[i] = pulls_only(batch, i) ? std::max(damping, -batch.impulse[i]) : damping;
    });
  }
  for (const auto& [batch, begin, end, whole] : island.segments)
    if (batch->law && batch->law->spring) batch->ops->apply(*batch, begin, end, world.bodies, batch->lambda.data(), v);
}

#define CDOT_INSTANTIATE(S)                                           \
  template void weigh_springs(const WorldData<S>&, const Island<S>&); \
  template void find_spring_impulses(Batch<S>&, int, int, S::Scalar); \
  template void push_dampers(WorldData<S>&, Island<S>&, S::Scalar);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
