// A number with its first and second derivative by time. Kernels are templates on the number type: C over jets of the
// poses and of the parameters gives dC/dt and its derivative where parameters are functions of time. Operators are
// calls, because a kernel over jets runs only for such parameters, and would be a tenth of the library inline.
#pragma once

#include <cmath>
#include <type_traits>

#include <cdot/kernel.hpp>

namespace cdot {

template <class T>
struct Jet {
  T value, first, second;

  Jet() = default;
  template <class Number>
  requires(std::is_arithmetic_v<Number>) Jet(Number x) : value(T(x)), first(0), second(0) {}
  Jet(T value, T first, T second) : value(value), first(first), second(second) {}

  // f of this number, for f and its derivatives there.
  Jet through(T f, T df, T ddf) const { return {f, df * first, ddf * first * first + df * second}; }

  friend bool operator<(const Jet& a, const Jet& b) { return a.value < b.value; }
  friend bool operator>(const Jet& a, const Jet& b) { return a.value > b.value; }
  friend bool operator<=(const Jet& a, const Jet& b) { return a.value <= b.value; }
  friend bool operator>=(const Jet& a, const Jet& b) { return a.value >= b.value; }

  [[gnu::noinline]] friend Jet operator+(const Jet& a, const Jet& b) {
    return {a.value + b.value, a.first + b.first, a.second + b.second};
  }
  [[gnu::noinline]] friend Jet operator-(const Jet& a, const Jet& b) {
    return {a.value - b.value, a.first - b.first, a.second - b.second};
  }
  [[gnu::noinline]] friend Jet operator-(const Jet& a) { return {-a.value, -a.first, -a.second}; }
  [[gnu::noinline]] friend Jet operator*(const Jet& a, const Jet& b) {
    return {a.value * b.value, a.first * b.value + a.value * b.first,
            a.second * b.value + T(2) * a.first * b.first + a.value * b.second};
  }
  // q = a/b from a = q b, differentiated.
  [[gnu::noinline]] friend Jet operator/(const Jet& a, const Jet& b) {
    const T q = a.value / b.value, dq = (a.first - q * b.first) / b.value;
    return {q, dq, (a.second - T(2) * dq * b.first - q * b.second) / b.value};
  }
};

template <class T>
struct ScalarOf<Jet<T>> {
  using type = T;
};

template <class T>
Jet<T> abs(const Jet<T>& a) {
  return a.value < T(0) ? -a : a;
}
template <class T>
[[gnu::noinline]] Jet<T> sqrt(const Jet<T>& a) {
  const T root = std::sqrt(a.value);
  return a.through(root, T(0.5) / root, T(-0.25) / (root * a.value));
}
template <class T>
[[gnu::noinline]] Jet<T> sin(const Jet<T>& a) {
  const T s = std::sin(a.value), c = std::cos(a.value);
  return a.through(s, c, -s);
}
template <class T>
[[gnu::noinline]] Jet<T> cos(const Jet<T>& a) {
  const T s = std::sin(a.value), c = std::cos(a.value);
  return a.through(c, -s, -c);
}
template <class T>
Jet<T> tan(const Jet<T>& a) {
  return sin(a) / cos(a);
}
template <class T>
[[gnu::noinline]] Jet<T> sinh(const Jet<T>& a) {
  const T s = std::sinh(a.value), c = std::cosh(a.value);
  return a.through(s, c, s);
}
template <class T>
[[gnu::noinline]] Jet<T> cosh(const Jet<T>& a) {
  const T s = std::sinh(a.value), c = std::cosh(a.value);
  return a.through(c, s, c);
}
template <class T>
[[gnu::noinline]] Jet<T> exp(const Jet<T>& a) {
  const T e = std::exp(a.value);
  return a.through(e, e, e);
}
template <class T>
[[gnu::noinline]] Jet<T> log(const Jet<T>& a) {
  return a.through(std::log(a.value), T(1) / a.value, T(-1) / (a.value * a.value));
}
// d atan2(y, x) = (x dy - y dx) / r^2
template <class T>
[[gnu::noinline]] Jet<T> atan2(const Jet<T>& y, const Jet<T>& x) {
  const T square = x.value * x.value + y.value * y.value;
  const T turn = x.value * y.first - y.value * x.first, growth = T(2) * (x.value * x.first + y.value * y.first);
  const T first = turn / square;
  return {std::atan2(y.value, x.value), first,
          (x.value * y.second - y.value * x.second) / square - first * growth / square};
}

}  // namespace cdot
