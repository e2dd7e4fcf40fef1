#include "runtime/step/dampers.hpp"

#include <algorithm>

#include <cdot/spaces.hpp>

#include "runtime/solve/projection.hpp"

namespace cdot {

template <class S>
void weigh_springs(const WorldData<S>& world, const Island<S>& island) {
  for (const auto& [batch, begin, end, whole] : island.segments)
    if (is_force(*batch)) batch->ops->effective_mass(*batch, begin, end, world.bodies);
}

template <class S>
void find_forces_at_rest(const Batch<S>& batch, int begin, int end, typename S::Scalar* force) {
  constexpr typename S::Scalar at_rest[most_rows] = {};
  for (int slot = begin; slot < end; ++slot) batch.law->force(batch, slot, at_rest, force + slot * batch.ops->rows);
}

// t R(r) at the start of a step of h: half of it, or less where the effect is stiff for the step.
template <class S>
static void push_effects(Batch<S>& batch, int begin, int end, typename S::Scalar h) {
  for (int slot = begin; slot < end; ++slot) {
    const EffectAtRates<S> now(batch, slot);
    for (int r = 0; r < batch.ops->rows; ++r) {
      const auto K = batch.factor[slot * batch.triangle() + r * (r + 1) / 2 + r];
      batch.lambda[slot * batch.ops->rows + r] = now.time_at_start(r, K, h) * now.R[r];
    }
  }
}

template <class S>
void push_dampers(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  using T = typename S::Scalar;
  auto* const v = world.bodies.velocity.data();
  for (const auto& [segment, begin, end, whole] : island.segments) {
    Batch<S>& batch = *segment;
    if (!batch.law || !batch.law->spring) continue;
    batch.ops->velocity(batch, begin, end, v, batch.rate.data());
    if (batch.law->is_of_effect()) {
      push_effects(batch, begin, end, h);
      continue;
    }
    find_forces_at_rest(batch, begin, end, batch.impulse.data());
    each_spring(batch, begin, end, [&](int i, const SpringNumbers<T>& spring, T K) {
      const T damping = -dampers(spring, K, h, false).start * (batch.rate[i] + batch.bias[i]);
      batch.lambda[i] = pulls_only(batch, i) ? std::max(damping, -(h / 2 * batch.impulse[i])) : damping;
    });
  }
  for (const auto& [batch, begin, end, whole] : island.segments)
    if (batch->law && batch->law->spring) batch->ops->apply(*batch, begin, end, world.bodies, batch->lambda.data(), v);
}

template <class S>
void find_rates_of_effects(WorldData<S>& world, const Island<S>& island) {
  for (const auto& [batch, begin, end, whole] : island.segments)
    if (batch->law && batch->law->is_of_effect())
      batch->ops->velocity(*batch, begin, end, world.bodies.velocity.data(), batch->rate.data());
}

template <class S>
void look_at_effects(WorldData<S>& world, const Island<S>& island, typename S::Scalar time) {
  for (const auto& [batch, begin, end, whole] : island.segments)
    if (is_force(*batch) && (batch->explicit_time() || batch->law->is_of_effect()))
      batch->ops->position(*batch, begin, end, world.bodies, time);
}

template <class S>
void forget_dampers(WorldData<S>& world, const Island<S>& island) {
  for (const Segment<S>& segment : island.segments)
    if (segment.batch->law && segment.batch->law->is_of_effect()) restore_drift(world, island, segment);
}

#define CDOT_INSTANTIATE(S)                                                  \
  template void weigh_springs(const WorldData<S>&, const Island<S>&);        \
  template void find_forces_at_rest(const Batch<S>&, int, int, S::Scalar*);  \
  template void push_dampers(WorldData<S>&, Island<S>&, S::Scalar);          \
  template void find_rates_of_effects(WorldData<S>&, const Island<S>&);      \
  template void look_at_effects(WorldData<S>&, const Island<S>&, S::Scalar); \
  template void forget_dampers(WorldData<S>&, const Island<S>&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
