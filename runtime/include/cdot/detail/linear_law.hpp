// The law of a generated effect on a coordinate whose force is linear in the coordinate and in its rate: springs,
// dampers and loads. An implicit Euler step of it is exact.
#pragma once

#include <cdot/detail/effect_law.hpp>

namespace cdot {

template <class S, class Effect>
struct LinearLaw {
  using T = typename S::Scalar;
  using Force = EffectLaw<S, Effect, ParametersAt::row>;

  static T at_rest(const Batch<S>& batch, int slot) {
    constexpr T rate[1] = {};
    T F[1];
    Force::force_without_limits(batch, slot, rate, F);
    return F[0];
  }

  static void spring(const Batch<S>& batch, int slot, SpringNumbers<T>* numbers) {
    constexpr T rate[1] = {};
    T k[1][1], d[1][1];
    Force::slopes(batch, slot, rate, k, d);
    *numbers = {k[0][0], d[0][0]};
  }

  // bias = -F(C, 0) / D, softness = 1 / (h D), D = d + h k. Without slopes equal bounds fix the impulse at h F.
  static void fill(Batch<S>& batch, int begin, int end, T h, const Settings&) {
    for (int i = begin; i < end; ++i) {
      const T F = at_rest(batch, i);
      SpringNumbers<T> numbers{T(0), T(0)};
      if constexpr (!Effect::slopes_vanish) spring(batch, i, &numbers);
      const T D = numbers.d + h * numbers.k, divisor = inverse(D);
      batch.lower[i] = D > T(0) ? T(-unbounded) : h * F;
      batch.upper[i] = D > T(0) ? T(unbounded) : h * F;
      batch.bias[i] -= F * divisor;
      batch.softness[i] = divisor / h;
    }
  }

  static void force(const Batch<S>& batch, int slot, const T* rate, T* force) {
    Force::force_without_limits(batch, slot, rate, force);
  }

  // True if k changes with the mass.
  static bool by_mass(const Batch<S>& batch, int slot) {
    if constexpr (Effect::reads_mass) {
      constexpr T rate[1] = {};
      T k[2][1][1], d[1][1];
      for (int mass : {0, 1})
        effect_of<Effect>(batch).slopes(Force::C(batch, slot), rate, Force::parameters(batch, slot), batch.time,
                                        T(mass), k[mass], d);
      return k[0][0][0] != k[1][0][0];
    } else return false;
  }
};

template <class S, class Effect>
inline constexpr Law<S> linear_law{
    .constants = constants_of_row<S, Effect, ParametersAt::row>,
    .reported = false,
    .fill = LinearLaw<S, Effect>::fill,
    .error = nullptr,
    .energy = LinearLaw<S, Effect>::Force::has_energy ? LinearLaw<S, Effect>::Force::energy : nullptr,
    .force = LinearLaw<S, Effect>::force,
    .guard = nullptr,
    .spring = Effect::slopes_vanish ? nullptr : LinearLaw<S, Effect>::spring,
    .by_mass = Effect::reads_mass ? LinearLaw<S, Effect>::by_mass : nullptr,
    .power = LinearLaw<S, Effect>::Force::has_energy ? LinearLaw<S, Effect>::Force::power : nullptr};

}  // namespace cdot
