// A long double with its derivative by one input, as a scalar of the kernels: gives the sensitivity of a function to
// each input.
#pragma once

#include <cmath>

#include <cdot/kernel.hpp>

namespace dual {

struct Dual {
  long double value = 0, slope = 0;

  Dual() = default;
  template <class Number>
  requires(std::is_arithmetic_v<Number>) Dual(Number x) : value(static_cast<long double>(x)) {}
  Dual(long double v, long double s) : value(v), slope(s) {}

  friend Dual operator+(Dual a, Dual b) { return {a.value + b.value, a.slope + b.slope}; }
  friend Dual operator-(Dual a, Dual b) { return {a.value - b.value, a.slope - b.slope}; }
  friend Dual operator-(Dual a) { return {-a.value, -a.slope}; }
  friend Dual operator*(Dual a, Dual b) { return {a.value * b.value, a.slope * b.value + a.value * b.slope}; }
  friend Dual operator/(Dual a, Dual b) {
    const long double q = a.value / b.value;
    return {q, (a.slope - q * b.slope) / b.value};
  }
  friend bool operator<(Dual a, Dual b) { return a.value < b.value; }
  friend bool operator>(Dual a, Dual b) { return a.value > b.value; }
  friend bool operator<=(Dual a, Dual b) { return a.value <= b.value; }
  friend bool operator>=(Dual a, Dual b) { return a.value >= b.value; }
};

inline Dual abs(Dual a) { return a.value < 0 ? -a : a; }
inline Dual sqrt(Dual a) {
  const long double root = std::sqrt(a.value);
  return {root, root > 0 ? a.slope / (2 * root) : 0};
}
inline Dual sin(Dual a) { return {std::sin(a.value), a.slope * std::cos(a.value)}; }
inline Dual cos(Dual a) { return {std::cos(a.value), -a.slope * std::sin(a.value)}; }
inline Dual tan(Dual a) {
  const long double t = std::tan(a.value);
  return {t, a.slope * (1 + t * t)};
}
inline Dual exp(Dual a) { return {std::exp(a.value), a.slope * std::exp(a.value)}; }
inline Dual log(Dual a) { return {std::log(a.value), a.slope / a.value}; }
inline Dual atan2(Dual y, Dual x) {
  const long double square = x.value * x.value + y.value * y.value;
  return {std::atan2(y.value, x.value), square > 0 ? (y.slope * x.value - x.slope * y.value) / square : 0};
}
inline Dual asin(Dual a) { return {std::asin(a.value), a.slope / std::sqrt(1 - a.value * a.value)}; }
inline Dual inverse(Dual a) { return a.value == 0 ? Dual(0) : Dual(1) / a; }
inline Dual pivot(Dual d, Dual k) { return d.value > 1e-17L * std::fabs(k.value) ? Dual(1) / d : Dual(0); }

}  // namespace dual

template <>
struct cdot::ScalarOf<dual::Dual> {
  using type = double;
};
