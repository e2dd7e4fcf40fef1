// Damped springs in steps of kicks and drifts. The kicks have the springs' forces; dampers act at both ends of the
// step, implicitly at the second, so that a step of any length is stable. The force of an effect parts in the same way:
// into that at rest, F(0), and what its rate r changes, R(r) = F(r) - F(0), which for a damper is -d r.
#pragma once

#include <algorithm>
#include <cmath>
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

// As impulse per rate. With z = h d K and u = h^2 k K:
//   start = h d min(1/2, 1/z),   end = h d - start + h^2 k max(0, 1 - 1/u)
// Below z = 2 this is the trapezoidal rule. Above, it stops the motion, which the rule would reverse. The
// last term, of `calm`, ends oscillations too fast for the step, u > 1.
template <class T>
struct Dampers {
  T start, end;
};
template <class T>
T calming(const SpringNumbers<T>& spring, T K, T h) {
  return std::max(T(0), h * h * spring.k - inverse(K));
}
template <class T>
Dampers<T> dampers(const SpringNumbers<T>& spring, T K, T h, bool calm) {
  const T start = std::min(T(0.5) * h * spring.d, inverse(K));
  return {start, h * spring.d - start + (calm ? calming(spring, K, h) : T(0))};
}

// The rows of an effect at its rates r = J v + dC/dt of Batch::rate. K must be present.
template <class S>
struct EffectAtRates {
  using T = typename S::Scalar;
  T rate[most_rows], R[most_rows];
  SpringNumbers<T> bound[most_rows];  // of the slopes
  T secant;                           // [1/s] |R| / |r|, by the energies of the rows; of a damper d K. 0 at rest

  EffectAtRates(const Batch<S>& batch, int slot) {
    const int rows = batch.ops->rows, first = slot * rows;
    for (int r = 0; r < rows; ++r) rate[r] = batch.rate[first + r] + batch.bias[first + r];
    batch.law->spring(batch, slot, bound);
    find_force_of_rates(batch, slot, rate, R);
    T push = 0, motion = 0;
    for (int r = 0; r < rows; ++r) {
      const T K = batch.factor[slot * batch.triangle() + r * (r + 1) / 2 + r];
      push += R[r] * R[r] * K, motion += K > T(0) ? rate[r] * rate[r] / K : T(0);
    }
    secant = motion > T(0) ? std::sqrt(push / motion) : T(0);
  }

  // The share of h in which R acts at the start. A force that saturates would reverse the motion if its slope alone
  // set the time.
  T time_at_start(int r, T K, T h) const {
    const T fastest = std::max(bound[r].d * K, secant), half = T(0.5) * h;
    return half * fastest > T(1) ? T(1) / fastest : half;
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
// C at the present poses of what is_force(), if it is of an effect or in time.
template <class S>
void look_at_effects(WorldData<S>& world, const Island<S>& island, typename S::Scalar time);

// K of the rows under a law, which the numbers of springs need.
template <class S>
void weigh_springs(const WorldData<S>& world, const Island<S>& island);

// The force of springs at rest and of constant forces, laid out like the batch's rows.
template <class S>
void find_forces_at_rest(const Batch<S>& batch, int begin, int end, typename S::Scalar* force);

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
// Calls f while Batch::lambda lacks what calms springs, but for the share of their energy that their dampers take in h,
// 1 - exp(-h d K): the method loses the rest.
template <class S, class F>
void without_calming(WorldData<S>& world, const Island<S>& island, typename S::Scalar h, F f);

// The end of a step of h for the rows of an effect, were they alone: rates p = r + K t R(p), by Newton's method with
// the diagonal of K and of the slopes. t is the rest of h that the start left, end the impulse per rate.
template <class S>
struct EffectAtEnd {
  using T = typename S::Scalar;
  Batch<S>& batch;
  const int slot, rows = batch.ops->rows;
  const T h;
  const bool calm;
  T r[most_rows], p[most_rows], R[most_rows], d[most_rows], end[most_rows], t[most_rows];
  T g[most_rows];  // p - r - K t R(p)

  EffectAtEnd(Batch<S>& batch, int slot, T h, bool calm) : batch(batch), slot(slot), h(h), calm(calm) {
    const EffectAtRates<S> now(batch, slot);
    std::copy_n(now.rate, rows, r);
    std::copy_n(now.rate, rows, p);
    look(now);
  }

  // A force that saturates can throw Newton's method back and forth across its steep part. Of one row, g grows with p:
  // the sides found so far bracket the rate.
  void find_rates() {
    if (rows > 1) return find_rates_of_rows();
    constexpr int most_rounds = 60;
    T low = -std::numeric_limits<T>::infinity(), high = -low, before = high, best = p[0], least = high;
    for (int round = 0; round < most_rounds && misses(size_of(g)); ++round) {
      const T size = std::abs(g[0]);
      if (size < least) least = size, best = p[0];
      (g[0] > T(0) ? high : low) = p[0];
      T next = p[0] - g[0] / (T(1) + end[0] * own(0));
      const bool inside = low < next && next < high, bracketed = std::isfinite(high - low);
      if (bracketed && !(inside && T(2) * size < before)) next = T(0.5) * (low + high);
      before = size;
      p[0] = next;
      look_at(p);
    }
    if (!(std::abs(g[0]) > least)) return;
    p[0] = best;
    look_at(p);
  }

 private:
  bool misses(T miss) const {
    constexpr T enough = T(by_precision<T>(1e-4, 1e-6));  // the solver's own step squares it
    return miss > enough * (size_of(r) + size_of(p));
  }

  // Steps that do not bring the rates nearer are halved.
  void find_rates_of_rows() {
    constexpr int most_rounds = 30, most_halvings = 20;
    T miss = size_of(g);
    for (int round = 0; round < most_rounds && misses(miss); ++round) {
      T from[most_rows], step[most_rows];
      std::copy_n(p, rows, from);
      for (int c = 0; c < rows; ++c) step[c] = -g[c] / (T(1) + end[c] * own(c));
      const T before = miss;
      for (int k = 0; k < most_halvings && (k == 0 || !(miss < before)); ++k) {
        for (int c = 0; c < rows; ++c) p[c] = from[c] + step[c] / T(1 << k);
        look_at(p);
        miss = size_of(g);
      }
      if (!(miss < before)) {
        std::copy_n(from, rows, p);
        look_at(p);
        return;
      }
    }
  }

  T own(int r) const { return batch.factor[slot * batch.triangle() + r * (r + 1) / 2 + r]; }

  // By the energies of the rows.
  T size_of(const T* rates) const {
    T sum = 0;
    for (int c = 0; c < rows; ++c) sum += rates[c] * rates[c] * (own(c) > T(0) ? inverse(own(c)) : T(1));
    return std::sqrt(sum);
  }

  void look_at(const T* rates) {
    T* const rate = batch.rate.data() + slot * rows;
    T kept[most_rows];
    std::copy_n(rate, rows, kept);
    for (int c = 0; c < rows; ++c) rate[c] = rates[c] - batch.bias[slot * rows + c];
    look(EffectAtRates<S>(batch, slot));
    std::copy_n(kept, rows, rate);
  }

  void look(const EffectAtRates<S>& at) {
    const T* const K = batch.factor.data() + slot * batch.triangle();
    for (int c = 0; c < rows; ++c) {
      const SpringNumbers<T>& bound = at.bound[c];
      R[c] = at.R[c], d[c] = bound.d, t[c] = h - at.time_at_start(c, own(c), h);
      end[c] = t[c] * d[c] + (calm ? calming(bound, own(c), h) : T(0));
      g[c] = p[c] - r[c];
    }
    for (int c = 0; c < rows; ++c)
      for (int k = 0; k < rows; ++k) g[c] -= K[k < c ? c * (c + 1) / 2 + k : k * (k + 1) / 2 + c] * t[k] * R[k];
  }
};

// An effect's impulse at the end, t R(r') over the rest t of h, with R linear about a prediction p of r':
//   lambda = t (R(p) + d (p - r')) - (end - t d) r'   gives   r' = t (R(p) + d p) / end - lambda / end.
template <class S>
void bound_effect(Batch<S>& batch, int slot, typename S::Scalar h, bool calm) {
  using T = typename S::Scalar;
  EffectAtEnd<S> last(batch, slot, h, calm);
  last.find_rates();
  for (int r = 0; r < last.rows; ++r) {
    const int i = slot * last.rows + r;
    const T end = last.end[r], impulse = last.t[r] * last.R[r];
    const bool soft = end > T(0);
    batch.softness[i] = soft ? inverse(end) : T(0);
    batch.lower[i] = soft ? -std::numeric_limits<T>::infinity() : impulse;
    batch.upper[i] = soft ? std::numeric_limits<T>::infinity() : impulse;
    if (soft) batch.bias[i] -= (impulse + last.t[r] * last.d[r] * last.p[r]) / end;
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

template <class S, class F>
void without_calming(WorldData<S>& world, const Island<S>& island, typename S::Scalar h, F f) {
  using T = typename S::Scalar;
  for (const auto& [segment, begin, end, whole] : island.segments) {
    Batch<S>& batch = *segment;
    if (!batch.law || !batch.law->spring) continue;
    batch.ops->velocity(batch, begin, end, world.bodies.velocity.data(), batch.rate.data());
    each_spring(batch, begin, end, [&](int i, const SpringNumbers<T>& spring, T K) {
      const T whole_impulse = batch.error[i] = batch.lambda[i];
      const T lost = calming(spring, K, h) * std::exp(-h * spring.d * K);
      const T left = whole_impulse + lost * (batch.rate[i] + batch.bias[i]);
      batch.lambda[i] = std::clamp(left, std::min(whole_impulse, T(0)), std::max(whole_impulse, T(0)));
    });
  }
  f();
  for (const auto& [segment, begin, end, whole] : island.segments)
    if (Batch<S>& batch = *segment; batch.law && batch.law->spring)
      each_row(batch, begin, end, [&](int i) { batch.lambda[i] = batch.error[i]; });
}

}  // namespace cdot
