// The laws of bounded rows: a coordinate between two ends, and a rate that a bounded force prescribes.
//
//   Row::bounds (C, p, t, B)   the ends, or the bounds of the force and the rate (cdot/kernel.hpp)
//   Row::of_rate               B bounds a force
//   Row::in_time               B depends on the time
#pragma once

#include <algorithm>
#include <cmath>

#include <cdot/detail/effect_law.hpp>

namespace cdot {

// The bias of an inequality row. For C > 0 it lets C shrink to 0 within the step, but not further. For C < 0 it feeds
// back the share of C that Drift::baumgarte removes per step.
template <class T>
T unilateral_bias(T C, T h, const Settings& settings) {
  const T share = settings.drift == Drift::baumgarte ? T(settings.baumgarte) : T(0);
  return select(C > T(0), C, share * C) / h;
}

template <class T>
bool nearer_to_lower(T C, const RowBounds<T>& ends) {
  return C - ends.lower < ends.upper - C;
}

template <class S, class Effect, class Row, ParametersAt where>
struct BoundedLaw {
  using T = typename S::Scalar;

  static RowBounds<T> bounds(const Batch<S>& batch, int slot) {
    RowBounds<T> B;
    Row::bounds(reinterpret_cast<const T(&)[1]>(batch.C[slot]), parameters_of<S, Effect, where>(batch, slot),
                batch.time, B);
    if (!(B.upper > B.lower)) B.upper = B.lower;
    if (batch.driven() && !batch.drives_of(slot).empty()) B.acceleration = acceleration_in_time(batch, slot);
    return B;
  }

  // The derivative of the prescribed rate where its parameters follow functions of time.
  [[gnu::noinline]] static T acceleration_in_time(const Batch<S>& batch, int slot) {
    using Jets = typename Effect::template Parameters<Jet<T>>;
    const Jet<T> C[1] = {batch.C[slot]};
    RowBounds<Jet<T>> B;
    Row::bounds(C, jets_of<Jets>(batch, slot, where == ParametersAt::row), Jet<T>{batch.time, T(1), T(0)}, B);
    return B.rate.first;
  }

  // J v = rate, its impulse within h times the bounds.
  static void fill_rate(Batch<S>& batch, int begin, int end, T h, const Settings&) {
    for (int i = begin; i < end; ++i) {
      const RowBounds<T> B = bounds(batch, i);
      batch.bias[i] -= B.rate;
      batch.lower[i] = h * B.lower;
      batch.upper[i] = h * B.upper;
    }
  }

  static void guard_rate(const Batch<S>& batch, int slot, Guard<T>* guard) {
    const RowBounds<T> B = bounds(batch, slot);
    *guard = {T(0), B.rate, B.lower, B.upper, B.acceleration, true};
  }

  // One row serves the nearer end. Equal ends hold the coordinate.
  static void fill_ends(Batch<S>& batch, int begin, int end, T h, const Settings& settings) {
    for (int i = begin; i < end; ++i) {
      const RowBounds<T> B = bounds(batch, i);
      const bool held = B.lower == B.upper, low = nearer_to_lower(batch.C[i], B);
      batch.lower[i] = low && !held ? T(0) : T(-unbounded);
      batch.upper[i] = low || held ? T(unbounded) : T(0);
      if (held) {
        const T share = settings.drift == Drift::baumgarte ? T(settings.baumgarte) / h : T(0);
        batch.bias[i] += share * (batch.C[i] - B.lower);
      } else if (low) batch.bias[i] += unilateral_bias(batch.C[i] - B.lower, h, settings);
      else batch.bias[i] -= unilateral_bias(B.upper - batch.C[i], h, settings);
    }
  }

  static void error_ends(const Batch<S>& batch, int slot, T* error) {
    const RowBounds<T> B = bounds(batch, slot);
    const T C = batch.C[slot];
    if (B.lower == B.upper) *error = C - B.lower;
    else *error = nearer_to_lower(C, B) ? std::fmin(C - B.lower, T(0)) : std::fmax(C - B.upper, T(0));
  }

  static void guard_ends(const Batch<S>& batch, int slot, Guard<T>* guard) {
    const RowBounds<T> B = bounds(batch, slot);
    const T C = batch.C[slot];
    if (B.lower == B.upper) *guard = {C - B.lower, T(0), T(-unbounded), T(unbounded)};
    else if (nearer_to_lower(C, B)) *guard = {C - B.lower, T(0), T(0), T(unbounded)};
    else *guard = {C - B.upper, T(0), T(-unbounded), T(0)};
  }
};

template <class S, class Effect, class Row, ParametersAt where = ParametersAt::joint>
inline constexpr Law<S> bounded_law{
    .constants = constants_of_row<S, Effect, where>,
    .reported = false,
    .fill = Row::of_rate ? BoundedLaw<S, Effect, Row, where>::fill_rate : BoundedLaw<S, Effect, Row, where>::fill_ends,
    .error = Row::of_rate ? nullptr : BoundedLaw<S, Effect, Row, where>::error_ends,
    .energy = nullptr,
    .force = nullptr,
    .guard =
        Row::of_rate ? BoundedLaw<S, Effect, Row, where>::guard_rate : BoundedLaw<S, Effect, Row, where>::guard_ends,
    .in_time = Row::in_time,
    .of_spec = true};

}  // namespace cdot
