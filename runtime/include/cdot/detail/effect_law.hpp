// The law of a generated effect, as a World calls it. The effect's own functions are, over C, its rate, the parameters
// and the time:
//
//   E::energy   (C, p, E)            the stored energy; may be missing
//   E::force    (C, rate, p, t, F)   the force along each row                                   [rows]
//   E::unstored (C, rate, p, t, F)   its part without an energy; missing: all of it, or nothing beside an energy
//   E::slopes   (C, rate, p, t, k, d)   k = -dF/dC, d = -dF/d(rate)                            [rows][rows]
//   E::limits   (C, p, t, lower, upper)   of the force, on some rows; missing: none           [rows]
//   E::acts     false for rows that only tell where a direction points                         [rows]
//   E::law_in_time   the force depends on the time
//   E::stores   whether it has an energy; missing: it has one if there is E::energy
//
// Of an effect on the coordinate of any joint:
//
//   E::reads_mass    the functions take the effective mass 1/K too, after the other numbers
//   E::linear        k and d read neither C nor its rate nor the time, and are not negative
//   E::slopes_vanish   k = d = 0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include <cdot/detail/block_slots.hpp>
#include <cdot/detail/drives.hpp>

namespace cdot {

// Where a law finds its parameters: those of its own joint, or the constants of a row on the coordinate of another.
enum class ParametersAt { joint, row };

// A generated effect is a struct of static functions. One that a program makes while it runs has an object behind it.
template <class Effect, class S>
Effect effect_of(const Batch<S>& batch) {
  if constexpr (is_made_by_program<Effect>) return Effect(batch.law->context);
  else return {};
}

template <class S, class Effect, ParametersAt where>
const auto& parameters_of(const Batch<S>& batch, int slot) {
  using Numbers = typename Effect::template Parameters<typename S::Scalar>;
  constexpr bool of_joint = where == ParametersAt::joint;
  const auto* const numbers = of_joint ? batch.parameters.data() : batch.constants.data();
  if constexpr (is_made_by_program<Effect>) {
    const int stride = of_joint ? batch.ops->parameter_size : batch.law->constants;
    return *reinterpret_cast<const Numbers*>(numbers + slot * stride);
  } else return reinterpret_cast<const Numbers*>(numbers)[slot];
}
template <class S, class Effect, ParametersAt where>
inline constexpr int constants_of_row =
    where == ParametersAt::joint ? 0
                                 : static_cast<int>(sizeof(typename Effect::template Parameters<typename S::Scalar>) /
                                                    sizeof(typename S::Scalar));

template <class S, class Effect, ParametersAt where = ParametersAt::joint>
struct EffectLaw {
  using T = typename S::Scalar;
  static constexpr int rows = Effect::rows;
  static constexpr bool reads_mass = requires { requires Effect::reads_mass; };
  using Row = const T (&)[rows];

  static const auto& parameters(const Batch<S>& batch, int slot) {
    return parameters_of<S, Effect, where>(batch, slot);
  }
  // f(numbers..., mass) or f(numbers...)
  template <class Number = T, class F, class... Numbers>
  static void with_mass(const Batch<S>& batch, int slot, F f, const Numbers&... numbers) {
    if constexpr (reads_mass) f(numbers..., Number(inverse(batch.factor[slot])));
    else f(numbers...);
  }
  static Row C(const Batch<S>& batch, int slot) { return reinterpret_cast<Row>(batch.C[slot * rows]); }

  static void force_without_limits(const Batch<S>& batch, int slot, const T* rate, T* force) {
    const auto effect = effect_of<Effect>(batch);
    const auto f = [&](const auto&... numbers) { effect.force(numbers..., reinterpret_cast<T(&)[rows]>(*force)); };
    with_mass(batch, slot, f, C(batch, slot), reinterpret_cast<Row>(*rate), parameters(batch, slot), batch.time);
  }

  static void slopes(const Batch<S>& batch, int slot, const T (&rate)[rows], T (&k)[rows][rows], T (&d)[rows][rows]) {
    const auto effect = effect_of<Effect>(batch);
    const auto f = [&](const auto&... numbers) { effect.slopes(numbers..., k, d); };
    with_mass(batch, slot, f, C(batch, slot), rate, parameters(batch, slot), batch.time);
  }

  static constexpr bool has_limits = requires { &Effect::template limits<T>; };
  struct Limits {
    T lower[rows], upper[rows];
  };
  static Limits limits(const Batch<S>& batch, int slot) {
    Limits limits;
    std::fill_n(limits.lower, rows, T(-unbounded)), std::fill_n(limits.upper, rows, T(unbounded));
    if constexpr (has_limits)
      effect_of<Effect>(batch).limits(C(batch, slot), parameters(batch, slot), batch.time, limits.lower, limits.upper);
    return limits;
  }

  static void force(const Batch<S>& batch, int slot, const T* rate, T* force) {
    force_without_limits(batch, slot, rate, force);
    if constexpr (has_limits) {
      const Limits most = limits(batch, slot);
      for (int r = 0; r < rows; ++r) force[r] = std::max(most.lower[r], std::min(force[r], most.upper[r]));
    }
  }

  static bool stores(const Batch<S>& batch) {
    if constexpr (requires { &Effect::stores; }) return effect_of<Effect>(batch).stores();
    else return has_energy;
  }
  static void unstored(const Batch<S>& batch, int slot, const T* rate, T* force) {
    if (!stores(batch)) return EffectLaw::force(batch, slot, rate, force);
    if constexpr (requires { &Effect::template unstored<T>; }) {
      const auto effect = effect_of<Effect>(batch);
      const auto f = [&](const auto&... numbers) { effect.unstored(numbers..., reinterpret_cast<T(&)[rows]>(*force)); };
      with_mass(batch, slot, f, C(batch, slot), reinterpret_cast<Row>(*rate), parameters(batch, slot), batch.time);
    } else std::fill_n(force, rows, T(0));
  }

  static constexpr bool has_energy = requires { &Effect::template energy<T>; };
  static constexpr bool stores_part = has_energy && requires { &Effect::template unstored<T>; };
  static double energy(const Batch<S>& batch, int slot) {
    T E = 0;
    if constexpr (has_energy)
      with_mass(
          batch, slot, [&](const auto&... n) { effect_of<Effect>(batch).energy(n..., E); }, C(batch, slot),
          parameters(batch, slot));
    return double(E);
  }

  // True if the energy changes with the mass, at the present C.
  static bool by_mass(const Batch<S>& batch, int slot) {
    T E[2] = {};
    if constexpr (has_energy && reads_mass)
      for (int mass : {0, 1})
        effect_of<Effect>(batch).energy(C(batch, slot), parameters(batch, slot), T(1 + mass), E[mass]);
    return E[0] != E[1];
  }

  // Power that the parameters add as they follow functions of time.
  static double power(const Batch<S>& batch, int slot) {
    Jet<T> E = 0;
    if constexpr (has_energy) {
      if (batch.drives_of(slot).empty()) return 0;
      using Jets = typename Effect::template Parameters<Jet<T>>;
      Jet<T> at[rows];
      for (int r = 0; r < rows; ++r) at[r] = batch.C[slot * rows + r];
      const auto f = [&](const auto&... n) { effect_of<Effect>(batch).energy(n..., E); };
      with_mass<Jet<T>>(batch, slot, f, at, jets_of<Jets>(batch, slot, where == ParametersAt::row));
    }
    return double(E.first);
  }

  // J v + dC/dt, from Batch::rate and the bias before a law adds to it.
  static void rate_of(const Batch<S>& batch, int slot, T (&rate)[rows]) {
    for (int r = 0; r < rows; ++r) rate[r] = batch.rate[slot * rows + r] + batch.bias[slot * rows + r];
  }

  // Bounds of k and d by row: k_rr + sum |k_rc| over the other columns that act, so that the diagonal matrix of these
  // is at least as stiff as the whole one. Never negative: a force that drives a body away is taken as it is.
  static void bounds(const Batch<S>& batch, int slot, const T (&rate)[rows], SpringNumbers<T> (&bound)[rows]) {
    T k[rows][rows], d[rows][rows];
    slopes(batch, slot, rate, k, d);
    const auto effect = effect_of<Effect>(batch);
    for (int r = 0; r < rows; ++r) {
      bound[r] = {k[r][r], d[r][r]};
      for (int c = 0; c < rows; ++c)
        if (c != r && effect.acts[c]) bound[r].k += std::abs(k[r][c]), bound[r].d += std::abs(d[r][c]);
      bound[r] = {std::max(bound[r].k, T(0)), std::max(bound[r].d, T(0))};
    }
  }

  // A force at a limit has no slope.
  static void bounds_within_limits(const Batch<S>& batch, int slot, const T (&rate)[rows],
                                   SpringNumbers<T> (&bound)[rows]) {
    bounds(batch, slot, rate, bound);
    if constexpr (has_limits) {
      T F[rows];
      force_without_limits(batch, slot, rate, F);
      const Limits most = limits(batch, slot);
      for (int r = 0; r < rows; ++r)
        if (!(most.lower[r] < F[r] && F[r] < most.upper[r])) bound[r] = {T(0), T(0)};
    }
  }

  // A step of h that is implicit as far as k and d say: with F at the start and D = d + h k,
  //   lambda = h (F + d (rate - rate') - h k rate')   gives   rate' = (F + d rate) / D - lambda / (h D).
  // Limits of the force are bounds of lambda.
  static void fill(Batch<S>& batch, int begin, int end, T h, const Settings&) {
    for (int slot = begin; slot < end; ++slot) {
      T rate[rows], F[rows];
      SpringNumbers<T> bound[rows];
      rate_of(batch, slot, rate);
      force_without_limits(batch, slot, rate, F);
      bounds(batch, slot, rate, bound);
      const Limits most = limits(batch, slot);
      for (int r = 0; r < rows; ++r) {
        const int i = slot * rows + r;
        const T D = bound[r].d + h * bound[r].k, K = batch.factor[slot * batch.triangle() + r * (r + 1) / 2 + r];
        const bool soft = h * D * K > std::numeric_limits<T>::epsilon();
        batch.softness[i] = soft ? T(1) / (h * D) : T(0);
        const T known = h * std::max(most.lower[r], std::min(F[r], most.upper[r]));
        batch.lower[i] = soft ? h * most.lower[r] : known;
        batch.upper[i] = soft ? h * most.upper[r] : known;
        if (soft) batch.bias[i] -= (F[r] + bound[r].d * rate[r]) / D;
      }
    }
  }

  static void within_limits(const Batch<S>& batch, int slot, SpringNumbers<T>* numbers) {
    T rate[rows];
    rate_of(batch, slot, rate);
    bounds(batch, slot, rate, reinterpret_cast<SpringNumbers<T>(&)[rows]>(*numbers));
  }

  // Stiffness and damping as bounded.
  static void spring(const Batch<S>& batch, int slot, SpringNumbers<T>* numbers) {
    T rate[rows];
    rate_of(batch, slot, rate);
    bounds_within_limits(batch, slot, rate, reinterpret_cast<SpringNumbers<T>(&)[rows]>(*numbers));
  }
};

template <class S, class Effect, ParametersAt where = ParametersAt::joint>
inline constexpr Law<S> effect_law{
    .constants = constants_of_row<S, Effect, where>,
    .reported = false,
    .fill = EffectLaw<S, Effect, where>::fill,
    .error = nullptr,
    .energy = EffectLaw<S, Effect, where>::has_energy ? EffectLaw<S, Effect, where>::energy : nullptr,
    .force = EffectLaw<S, Effect, where>::force,
    .guard = nullptr,
    .spring = EffectLaw<S, Effect, where>::spring,
    .unstored = EffectLaw<S, Effect, where>::unstored,
    .stores_part = EffectLaw<S, Effect, where>::stores_part,
    .in_time = Effect::law_in_time,
    .within_limits = EffectLaw<S, Effect, where>::has_limits ? EffectLaw<S, Effect, where>::within_limits : nullptr,
    .by_mass = EffectLaw<S, Effect, where>::reads_mass ? EffectLaw<S, Effect, where>::by_mass : nullptr,
    .power = EffectLaw<S, Effect, where>::has_energy ? EffectLaw<S, Effect, where>::power : nullptr};

}  // namespace cdot
