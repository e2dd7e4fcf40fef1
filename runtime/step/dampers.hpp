// Damped springs in steps of kicks and drifts. The kicks have the springs' forces; dampers act at both ends of the
// step, implicitly at the second, so that a step of any length is stable. The force of an effect parts in the same way:
// into that at rest, F(0), and what its rate r changes, R(r) = F(r) - F(0), which for a damper is -d r.
#pragma once

#include <algorithm>
#include <limits>

#include "runtime/state/world_data.hpp"

namespace cdot {

// Springs and constant forces on coordinates: their force follows from C and its rate.
template <class S>
bool is_force(const Batch<S>& batch) {
  return batch.law && batch.law->force;
}
// Limits, motors and friction: they act at the ends of the step.
template <class S>
bool is_bounded(const Batch<S>& batch) {
  return batch.law && !batch.law->force;
}

// Rows of ropes.
template <class S>
bool pulls_only(const Batch<S>& batch, int i) {
  return batch.kinds[static_cast<size_t>(i % batch.ops->rows)] == RowKind::inequality;
}

// f(i, spring, K) for all rows of a batch that are springs. C and K must be present.
template <class S, class F>
void each_spring(const Batch<S>& batch, int begin, int end, F f) {
  if (!batch.law || !batch.law->spring) return;
  const int rows = batch.ops->rows;
  SpringNumbers<typename S::Scalar> springs[most_rows];
  for (int slot = begin; slot < end; ++slot) {
    batch.law->spring(batch, slot, springs);
    for (int r = 0; r < rows; ++r)
      f(slot * rows + r, springs[r], batch.factor[slot * batch.triangle() + r * (r + 1) / 2 + r]);
  }
}

// The force of an effect at rates, less that at rest. C must be present.
template <class S>
void find_force_of_rates(const Batch<S>& batch, int slot, const typename S::Scalar* rate, typename S::Scalar* R) {
  constexpr typename S::Scalar at_rest[most_rows] = {};
  typename S::Scalar resting[most_rows];
  batch.law->force(batch, slot, rate, R);
  batch.law->force(batch, slot, at_rest, resting);
  for (int r = 0; r < batch.ops->rows; ++r) R[r] -= resting[r];
}

// The rows of an effect at its rates r = J v + dC/dt of Batch::rate.
template <class S>
struct EffectAtRates {
  using T = typename S::Scalar;
  T rate[most_rows], R[most_rows];
  SpringNumbers<T> bound[most_rows];  // of the slopes

  EffectAtRates(const Batch<S>& batch, int slot) {
    const int first = slot * batch.ops->rows;
    for (int r = 0; r < batch.ops->rows; ++r) rate[r] = batch.rate[first + r] + batch.bias[first + r];
    batch.law->spring(batch, slot, bound);
    find_force_of_rates(batch, slot, rate, R);
  }
};

template <class S>
bool has_effects(const Island<S>& island) {
  return std::any_of(island.segments.begin(), island.segments.end(),
                     [](const Segment<S>& s) { return s.batch->law && s.batch->law->is_of_effect(); });
}
// J v of effects, into Batch::rate.
template <class S>
void find_rates_of_effects(WorldData<S>& world, const Island<S>& island);
// C of effects at the present poses.
template <class S>
void look_at_effects(WorldData<S>& world, const Island<S>& island, typename S::Scalar time);

// K of the rows under a law, which the numbers of springs need.
template <class S>
void weigh_springs(const WorldData<S>& world, const Island<S>& island);

// The force of springs at rest and of constant forces, times h, into Batch::impulse.
template <class S>
void find_spring_impulses(Batch<S>& batch, int begin, int end, typename S::Scalar h);

// The impulses of dampers at the start of a step of h, into `lambda` and the velocities. C, J and K must be present.
template <class S>
void push_dampers(WorldData<S>& world, Island<S>& island, typename S::Scalar h);

// Makes the rows of springs those of the dampers at the end of a step of h, for the solver. calm: springs too stiff for
// the step are damped as well. pulled(batch, i): the impulse of the row before, which a rope must not exceed by
// pushing. Effects need find_rates_of_effects() at velocities that lack no more than this impulse; their bias changes
// until forget_dampers().
template <class S, class F>
void bound_dampers(Batch<S>& batch, int begin, int end, typename S::Scalar h, bool calm, F pulled);
// Restores dC/dt in the bias of effects.
template <class S>
void forget_dampers(WorldData<S>& world, const Island<S>& island);

// As impulse per rate. With z = h d K and u = h^2 k K:
//   start = h d min(1/2, 1/z),   end = h d - start + h^2 k max(0, 1 - 1/u)
// Below z = 2 this is the trapezoidal rule. Above, it stops the motion, which the rule would reverse. The
// last term, of `calm`, ends oscillations too fast for the step, u > 1.
template <class T>
struct Dampers {
  T start, end;
  T time_at_start;  // start / d, the share of h in which the damper acts at the start
};
template <class T>
Dampers<T> dampers(const SpringNumbers<T>& spring, T K, T h, bool calm) {
  const T mass = inverse(K), half = T(0.5) * h * spring.d, start = std::min(half, mass);
  return {start, h * spring.d - start + (calm ? std::max(T(0), h * h * spring.k - mass) : T(0)),
          start < half ? start / spring.d : T(0.5) * h};
}

// An effect's impulse at the end, t R(r') over the rest t of h, with R linear about a prediction p of r':
//   lambda = t (R(p) + d (p - r')) - (end - t d) r'   gives   r' = t (R(p) + d p) / end - lambda / end,
//   p = r + K t R(r), less where the effect is stiff for the step.
template <class S>
void bound_effect(Batch<S>& batch, int slot, typename S::Scalar h, bool calm) {
  using T = typename S::Scalar;
  const int rows = batch.ops->rows;
  const T* const K = batch.factor.data() + slot * batch.triangle();
  const EffectAtRates<S> now(batch, slot);
  T end[most_rows], rest[most_rows], predicted[most_rows], R[most_rows];
  std::copy_n(now.rate, rows, predicted);
  for (int r = 0; r < rows; ++r) {
    const T own = K[r * (r + 1) / 2 + r];
    const Dampers<T> damper = dampers(now.bound[r], own, h, calm);
    end[r] = damper.end, rest[r] = h - damper.time_at_start;
    const T lambda = rest[r] * now.R[r] / (T(1) + end[r] * own);
    for (int c = 0; c < rows; ++c) predicted[c] += lambda * K[c < r ? r * (r + 1) / 2 + c : c * (c + 1) / 2 + r];
  }
  find_force_of_rates(batch, slot, predicted, R);
  for (int r = 0; r < rows; ++r) {
    const int i = slot * rows + r;
    const bool soft = end[r] > T(0);
    batch.softness[i] = soft ? inverse(end[r]) : T(0);
    batch.lower[i] = soft ? -std::numeric_limits<T>::infinity() : rest[r] * R[r];
    batch.upper[i] = soft ? std::numeric_limits<T>::infinity() : rest[r] * R[r];
    if (soft) batch.bias[i] -= rest[r] * (R[r] + now.bound[r].d * predicted[r]) / end[r];
  }
}

template <class S, class F>
void bound_dampers(Batch<S>& batch, int begin, int end, typename S::Scalar h, bool calm, F pulled) {
  using T = typename S::Scalar;
  for (int slot = begin; batch.law->is_of_effect() && slot < end; ++slot) bound_effect(batch, slot, h, calm);
  if (batch.law->is_of_effect()) return;
  const int rows = batch.ops->rows;
  for (int i = begin * rows; i < end * rows; ++i) {
    batch.softness[i] = 0;
    batch.lower[i] = batch.upper[i] = pulls_only(batch, i) ? std::max(T(0), -pulled(batch, i)) : T(0);
  }
  each_spring(batch, begin, end, [&](int i, const SpringNumbers<T>& spring, T K) {
    const T damper = dampers(spring, K, h, calm).end;
    if (!(damper > T(0))) return;
    batch.softness[i] = inverse(damper);
    batch.lower[i] = pulls_only(batch, i) ? -pulled(batch, i) : -std::numeric_limits<T>::infinity();
    batch.upper[i] = std::numeric_limits<T>::infinity();
  });
}

}  // namespace cdot
