// A user's own scalar type: a double that counts its operations by the ledger's rules. A negation is an addition; a
// guarded inverse is a division and a comparison; a guarded pivot is the same plus a product.
#pragma once

#include <cmath>
#include <type_traits>

#include "tests/kernels/any_block.hpp"

namespace counting {

struct Counted {
  double value;
  static inline cdot::Operations taken;

  Counted() = default;
  template <class Number>
  requires(std::is_arithmetic_v<Number>) Counted(Number x) : value(static_cast<double>(x)) {}
  explicit operator double() const { return value; }

  friend Counted operator+(Counted a, Counted b) { return ++taken.add, a.value + b.value; }
  friend Counted operator-(Counted a, Counted b) { return ++taken.add, a.value - b.value; }
  friend Counted operator-(Counted a) { return ++taken.add, -a.value; }
  friend Counted operator*(Counted a, Counted b) { return ++taken.multiply, a.value * b.value; }
  friend Counted operator/(Counted a, Counted b) { return ++taken.divide, a.value / b.value; }
  friend bool operator<(Counted a, Counted b) { return ++taken.compare, a.value < b.value; }
  friend bool operator>(Counted a, Counted b) { return ++taken.compare, a.value > b.value; }
  friend bool operator<=(Counted a, Counted b) { return ++taken.compare, a.value <= b.value; }
  friend bool operator>=(Counted a, Counted b) { return ++taken.compare, a.value >= b.value; }
};

inline Counted abs(Counted a) { return ++Counted::taken.compare, std::fabs(a.value); }
inline Counted sign(Counted a) { return ++Counted::taken.compare, cdot::sign(a.value); }
inline Counted sqrt(Counted a) { return ++Counted::taken.root, std::sqrt(a.value); }
inline Counted sin(Counted a) { return ++Counted::taken.call, std::sin(a.value); }
inline Counted cos(Counted a) { return ++Counted::taken.call, std::cos(a.value); }
inline Counted tan(Counted a) { return ++Counted::taken.call, std::tan(a.value); }
inline Counted exp(Counted a) { return ++Counted::taken.call, std::exp(a.value); }
inline Counted log(Counted a) { return ++Counted::taken.call, std::log(a.value); }
inline Counted atan2(Counted y, Counted x) { return ++Counted::taken.call, std::atan2(y.value, x.value); }
inline Counted inverse(Counted a) { return ++Counted::taken.divide, ++Counted::taken.compare, cdot::inverse(a.value); }
inline Counted pivot(Counted d, Counted k) {
  return ++Counted::taken.divide, ++Counted::taken.compare, ++Counted::taken.multiply, cdot::pivot(d.value, k.value);
}

}  // namespace counting

template <>
struct cdot::ScalarOf<counting::Counted> {
  using type = double;
};
