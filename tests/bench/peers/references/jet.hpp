// A number with its first and second derivative: a mechanism is defined by positions, without derivatives by hand.
#pragma once

#include <array>
#include <cmath>

namespace cdot::peers {

struct Jet {
  long double value = 0, first = 0, second = 0;
  Jet() = default;
  Jet(long double v) : value(v) {}  // a constant
  Jet(long double v, long double d, long double dd) : value(v), first(d), second(dd) {}
};

inline Jet operator+(const Jet& a, const Jet& b) { return {a.value + b.value, a.first + b.first, a.second + b.second}; }
inline Jet operator-(const Jet& a, const Jet& b) { return {a.value - b.value, a.first - b.first, a.second - b.second}; }
inline Jet operator*(const Jet& a, const Jet& b) {
  return {a.value * b.value, a.first * b.value + a.value * b.first,
          a.second * b.value + 2 * a.first * b.first + a.value * b.second};
}
// f(a) from f and its derivatives at a.
inline Jet chain(const Jet& a, long double f, long double df, long double ddf) {
  return {f, df * a.first, df * a.second + ddf * a.first * a.first};
}
inline Jet inverse(const Jet& a) {
  const long double i = 1 / a.value;
  return chain(a, i, -i * i, 2 * i * i * i);
}
inline Jet operator/(const Jet& a, const Jet& b) { return a * inverse(b); }
inline Jet sqrt(const Jet& a) {
  const long double r = std::sqrt(a.value);
  return chain(a, r, 1 / (2 * r), -1 / (4 * r * a.value));
}
inline Jet sin(const Jet& a) {
  const long double s = std::sin(a.value), c = std::cos(a.value);
  return chain(a, s, c, -s);
}
inline Jet cos(const Jet& a) {
  const long double s = std::sin(a.value), c = std::cos(a.value);
  return chain(a, c, -s, -c);
}
inline Jet atan(const Jet& a) {
  const long double d = 1 / (1 + a.value * a.value);
  return chain(a, std::atan(a.value), d, -2 * a.value * d * d);
}
// The angle of (x, y) by the half angle: smooth except at y = 0, x < 0.
inline Jet atan2(const Jet& y, const Jet& x) { return 2 * atan(y / (sqrt(x * x + y * y) + x)); }

using Jet3 = std::array<Jet, 3>;
inline Jet3 operator+(const Jet3& a, const Jet3& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Jet3 operator-(const Jet3& a, const Jet3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Jet dot(const Jet3& a, const Jet3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

}  // namespace cdot::peers
