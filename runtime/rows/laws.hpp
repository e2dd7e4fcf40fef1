// The laws of a joint's own rows: inequalities, and rows as springs. Plain equalities have no law. The laws of effects
// on coordinates are in effects/.
#pragma once

#include <cmath>

#include <cdot/detail/bounded_law.hpp>

namespace cdot {

// C >= 0 for the spec's inequalities: lambda >= 0.
template <class S>
const Law<S>& unilateral_law();

// Equality rows as springs with damping. Constants: those of spring_constants().
template <class S>
const Law<S>& soft_law();

inline constexpr int spring_constants_count = 3;

// {by_frequency, frequency or stiffness, damping ratio or damping}. Throws Error.
inline void spring_constants(const Softness& softness, double* constants) {
  const double strength = softness.by_frequency ? softness.frequency : softness.stiffness;
  const double damping = softness.by_frequency ? softness.damping_ratio : softness.damping;
  if (!(strength >= 0 && damping >= 0) || !std::isfinite(strength) || !std::isfinite(damping))
    throw Error("a spring needs a frequency or stiffness and a damping that are finite and >= 0");
  if (strength == 0 && (softness.by_frequency || damping == 0))
    throw Error("a spring of zero stiffness and zero damping has no effect; remove it");
  constants[0] = softness.by_frequency ? 1 : 0;
  constants[1] = strength;
  constants[2] = damping;
}

// Stiffness k and damping d of a spring on one row. By frequency f: k = (2 pi f)^2 / K, d = 2 zeta 2 pi f / K.
template <class T>
SpringNumbers<T> spring_numbers(T K, const T* constants) {
  if (constants[0] == T(0)) return {constants[1], constants[2]};
  const T w = T(6.283185307179586476925L) * constants[1], mass = inverse(K);
  return {mass * w * w, mass * T(2) * constants[2] * w};
}

// An implicit Euler step of that spring, as bias and softness of the row: softness = 1 / (h (d + h k)), bias = C k / (d
// + h k)       (SFT-1 of the hand derivations)
template <class T>
struct SpringRow {
  T bias, softness;
};
template <class T>
SpringRow<T> spring_row(T C, T K, const T* constants, T h) {
  const auto [k, d] = spring_numbers(K, constants);
  const T divisor = inverse(d + h * k);
  return {C * k * divisor, divisor / h};
}

// -k C - d dC/dt of the same spring
template <class T>
T spring_force(T C, T rate, T K, const T* constants) {
  const auto [k, d] = spring_numbers(K, constants);
  return -k * C - d * rate;
}

// k of the same spring, for its energy k C^2 / 2.
template <class T>
double spring_stiffness(T K, const T* constants) {
  return double(spring_numbers(K, constants).k);
}

}  // namespace cdot
