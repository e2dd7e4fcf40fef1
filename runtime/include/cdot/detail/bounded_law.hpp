// The laws of bounded rows: a coordinate between two ends, and a rate that a bounded force prescribes.
//
//   Row::bounds (C, p, t, B)   the ends, or the bounds of the force and the rate (cdot/kernel.hpp)
//   Row::of_rate               B bounds a force
//   Row::in_time               B depends on the time
//   Row::of_value              B depends on C
//   Row::load_of               the bounds grow with the force of that one of Effect::Bounded, or, if it is -1, with the
//                              resultant force of the joint's own rows; missing: they do not
//   Row::by_load (C, p, t, B)  what each newton of the load adds to the bounds
//   Row::cone_row, cone_rows   its place among consecutive rows that one force of bounded size prescribes together, and
//                              their number; missing: the row is alone
//   Row::after, Row::until (C, rate, p, t, load, D)   how far the row is from its begin and its end, as a share of what
//                              is compared; `load` is its own |force|; missing: it acts from the start, or for ever
#pragma once

#include <algorithm>
#include <cmath>
#include <tuple>

#include <cdot/detail/effect_law.hpp>

namespace cdot {

// The bias of an inequality row. For C > 0 it lets C shrink to 0 within the step, but not further. For C < 0 it feeds
// back the share of C that Drift::baumgarte removes per step.
template <class T>
T unilateral_bias(T C, T h, const Settings& settings) {
  const T share = settings.drift == Drift::baumgarte ? T(settings.baumgarte) : T(0);
  return select(C > T(0), C, share * C) / h;
}

// True if a row serves the lower end. Ends that cross in time hold the coordinate at the lower one.
template <class T>
bool nearer_to_lower(T C, const RowBounds<T>& ends) {
  return C - ends.lower < ends.upper - C || !(ends.upper > ends.lower);
}

template <class S, class Effect, class Row, ParametersAt where>
struct BoundedLaw {
  using T = typename S::Scalar;

  static RowBounds<T> bounds(const Batch<S>& batch, int slot) {
    RowBounds<T> B;
    effect_of<Row>(batch).bounds(reinterpret_cast<const T(&)[1]>(batch.C[slot]),
                                 parameters_of<S, Effect, where>(batch, slot), batch.time, B);
    if (!(B.upper > B.lower)) B.upper = B.lower;
    return B;
  }

  static bool is_driven(const Batch<S>& batch, int slot) { return batch.driven() && !batch.drives_of(slot).empty(); }

  // The bounds with their derivatives, where their parameters follow functions of time.
  [[gnu::noinline]] static RowBounds<Jet<T>> bounds_in_time(const Batch<S>& batch, int slot) {
    using Jets = typename Effect::template Parameters<Jet<T>>;
    const Jet<T> C[1] = {batch.C[slot]};
    RowBounds<Jet<T>> B;
    effect_of<Row>(batch).bounds(C, jets_of<Jets>(batch, slot, where == ParametersAt::row),
                                 Jet<T>{batch.time, T(1), T(0)}, B);
    return B;
  }
  // How the end that the row serves moves: its first and second derivative.
  static Jet<T> motion_of_end(const Batch<S>& batch, int slot) {
    if (!is_driven(batch, slot)) return T(0);
    const RowBounds<Jet<T>> B = bounds_in_time(batch, slot);
    return nearer_to_lower<T>(batch.C[slot], {B.lower.value, B.upper.value}) ? B.lower : B.upper;
  }

  static constexpr bool may_wait = requires { &Row::template after<T>; };
  static constexpr bool may_end = requires { &Row::template until<T>; };
  static constexpr bool has_events = may_wait || may_end;
  static bool waits(const Batch<S>& batch) {
    if constexpr (is_made_by_program<Row>) return effect_of<Row>(batch).waits();
    else return may_wait;
  }
  static bool acts(const Batch<S>& batch, int slot) {
    if constexpr (!has_events) return true;
    else return batch.happened[slot] == (waits(batch) ? Event::began : Event::none);
  }
  static void distance(const Batch<S>& batch, int slot, T rate, T force, T (&from)[2]) {
    from[0] = from[1] = T(unbounded);
    const T rates[1] = {rate};
    [[maybe_unused]] const auto find = [&](auto condition, T& D) {
      condition(reinterpret_cast<const T(&)[1]>(batch.C[slot]), rates, parameters_of<S, Effect, where>(batch, slot),
                batch.time, std::abs(force), D);
    };
    [[maybe_unused]] const auto row = effect_of<Row>(batch);
    if constexpr (may_wait) find([row](auto&&... numbers) { row.after(numbers...); }, from[0]);
    if constexpr (may_end) find([row](auto&&... numbers) { row.until(numbers...); }, from[1]);
  }

  static constexpr bool has_load = requires { Row::load_of; };
  static constexpr int cone_row = [] {
    if constexpr (requires { Row::cone_row; }) return Row::cone_row;
    else return 0;
  }();
  static constexpr int cone_rows = [] {
    if constexpr (requires { Row::cone_rows; }) return Row::cone_rows;
    else return 0;
  }();
  static void by_load(const Batch<S>& batch, int slot, T* lower, T* upper) {
    RowBounds<T> B{T(0), T(0)};
    if constexpr (has_load)
      if (acts(batch, slot))
        effect_of<Row>(batch).by_load(reinterpret_cast<const T(&)[1]>(batch.C[slot]),
                                      parameters_of<S, Effect, where>(batch, slot), batch.time, B);
    *lower = B.lower, *upper = B.upper;
  }

  // J v = rate, its impulse within h times the bounds. The solver adds those of the load.
  static void fill_rate(Batch<S>& batch, int begin, int end, T h, const Settings&) {
    for (int i = begin; i < end; ++i) {
      if (!acts(batch, i)) {
        batch.lower[i] = batch.upper[i] = T(0);
        continue;
      }
      const RowBounds<T> B = bounds(batch, i);
      batch.bias[i] -= B.rate;
      batch.lower[i] = h * B.lower;
      batch.upper[i] = h * B.upper;
    }
  }

  static void guard_rate(const Batch<S>& batch, int slot, Guard<T>* guard) {
    if (!acts(batch, slot)) {
      *guard = {.off_by = T(0), .rate = T(0), .lower = T(0), .upper = T(0), .acceleration = T(0), .of_rate = true};
      return;
    }
    RowBounds<T> B = bounds(batch, slot);
    if (is_driven(batch, slot)) B.acceleration = bounds_in_time(batch, slot).rate.first;
    if (has_load && batch.law->by_load) {
      T lower, upper;
      by_load(batch, slot, &lower, &upper);
      B.lower += lower * batch.load[slot], B.upper += upper * batch.load[slot];
    }
    *guard = {T(0), B.rate, B.lower, B.upper, B.acceleration, true};
  }

  // One row serves the nearer end. Equal ends hold the coordinate.
  static void fill_ends(Batch<S>& batch, int begin, int end, T h, const Settings& settings) {
    for (int i = begin; i < end; ++i) {
      if (!acts(batch, i)) {
        batch.lower[i] = batch.upper[i] = T(0);
        continue;
      }
      const RowBounds<T> B = bounds(batch, i);
      const bool held = B.lower == B.upper, low = nearer_to_lower(batch.C[i], B);
      batch.lower[i] = low && !held ? T(0) : T(-unbounded);
      batch.upper[i] = low ? T(unbounded) : T(0);
      if (held) {
        const T share = settings.drift == Drift::baumgarte ? T(settings.baumgarte) / h : T(0);
        batch.bias[i] += share * (batch.C[i] - B.lower);
      } else if (low) batch.bias[i] += unilateral_bias(batch.C[i] - B.lower, h, settings);
      else batch.bias[i] -= unilateral_bias(B.upper - batch.C[i], h, settings);
      if (is_driven(batch, i)) batch.bias[i] -= motion_of_end(batch, i).first;
    }
  }

  static void error_ends(const Batch<S>& batch, int slot, T* error) {
    const RowBounds<T> B = bounds(batch, slot);
    const T C = batch.C[slot];
    if (!acts(batch, slot)) *error = T(0);
    else if (B.lower == B.upper) *error = C - B.lower;
    else *error = nearer_to_lower(C, B) ? std::fmin(C - B.lower, T(0)) : std::fmax(C - B.upper, T(0));
  }

  static void guard_ends(const Batch<S>& batch, int slot, Guard<T>* guard) {
    const RowBounds<T> B = bounds(batch, slot);
    const T C = batch.C[slot];
    if (!acts(batch, slot)) *guard = {T(0), T(0), T(0), T(0)};
    else if (B.lower == B.upper) *guard = {C - B.lower, T(0), T(-unbounded), T(unbounded)};
    else if (nearer_to_lower(C, B)) *guard = {C - B.lower, T(0), T(0), T(unbounded)};
    else *guard = {C - B.upper, T(0), T(-unbounded), T(0)};
    if (!is_driven(batch, slot) || !acts(batch, slot)) return;
    const Jet<T> end = motion_of_end(batch, slot);
    guard->rate = end.first, guard->acceleration = end.second;
  }
};

// The law of the row that carries the load of Row. Null: the joint's own rows, or none.
template <class S, class Effect, class Row, ParametersAt where>
constexpr const Law<S>* law_of_load();

template <class S, class Effect, class Row, ParametersAt where = ParametersAt::joint>
inline constexpr Law<S> bounded_law{
    .constants = constants_of_row<S, Effect, where> + (BoundedLaw<S, Effect, Row, where>::cone_rows > 0),
    .reported = false,
    .fill = Row::of_rate ? BoundedLaw<S, Effect, Row, where>::fill_rate : BoundedLaw<S, Effect, Row, where>::fill_ends,
    .error = Row::of_rate ? nullptr : BoundedLaw<S, Effect, Row, where>::error_ends,
    .energy = nullptr,
    .force = nullptr,
    .guard =
        Row::of_rate ? BoundedLaw<S, Effect, Row, where>::guard_rate : BoundedLaw<S, Effect, Row, where>::guard_ends,
    .in_time = Row::in_time,
    .moving = Row::in_time || Row::of_value || BoundedLaw<S, Effect, Row, where>::has_load ||
              BoundedLaw<S, Effect, Row, where>::cone_rows > 0,
    .by_load = BoundedLaw<S, Effect, Row, where>::has_load ? BoundedLaw<S, Effect, Row, where>::by_load : nullptr,
    .load_of = law_of_load<S, Effect, Row, where>(),
    .cone_row = BoundedLaw<S, Effect, Row, where>::cone_row,
    .cone_rows = BoundedLaw<S, Effect, Row, where>::cone_rows,
    .distance = BoundedLaw<S, Effect, Row, where>::has_events ? BoundedLaw<S, Effect, Row, where>::distance : nullptr};

template <class S, class Effect, class Row, ParametersAt where>
constexpr const Law<S>* law_of_load() {
  if constexpr (requires { requires Row::load_of >= 0; })
    return &bounded_law<S, Effect, std::tuple_element_t<Row::load_of, typename Effect::Bounded>, where>;
  else return nullptr;
}

}  // namespace cdot
