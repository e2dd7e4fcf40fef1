// All six packs side by side in one scalar type, so every kernel is compiled once for all. An operation applies to each
// pack separately.
#pragma once

#include <cstddef>
#include <type_traits>

#include <cdot/pack.hpp>

namespace packs {

struct Packs {
  cdot::Pack<float, 4> f4;
  cdot::Pack<float, 8> f8;
  cdot::Pack<float, 16> f16;
  cdot::Pack<double, 4> d4;
  cdot::Pack<double, 8> d8;
  cdot::Pack<double, 16> d16;

  Packs() = default;
  Packs(cdot::Pack<float, 4> a, cdot::Pack<float, 8> b, cdot::Pack<float, 16> c, cdot::Pack<double, 4> d,
        cdot::Pack<double, 8> e, cdot::Pack<double, 16> f)
      : f4(a), f8(b), f16(c), d4(d), d8(e), d16(f) {}
  template <class Number>
  requires(std::is_arithmetic_v<Number>) Packs(Number x) : Packs(x, x, x, x, x, x) {}
};

struct Masks {
  cdot::Mask<float, 4> f4;
  cdot::Mask<float, 8> f8;
  cdot::Mask<float, 16> f16;
  cdot::Mask<double, 4> d4;
  cdot::Mask<double, 8> d8;
  cdot::Mask<double, 16> d16;
};

// Applies f to the operands' parts of each pack.
template <class Result, class F, class... Operands>
Result each(F f, const Operands&... x) {
  return {f(x.f4...), f(x.f8...), f(x.f16...), f(x.d4...), f(x.d8...), f(x.d16...)};
}

// clang-format off
inline Packs operator+(const Packs& a, const Packs& b) { return each<Packs>([](auto x, auto y) { return x + y; }, a, b); }
inline Packs operator-(const Packs& a, const Packs& b) { return each<Packs>([](auto x, auto y) { return x - y; }, a, b); }
inline Packs operator*(const Packs& a, const Packs& b) { return each<Packs>([](auto x, auto y) { return x * y; }, a, b); }
inline Packs operator/(const Packs& a, const Packs& b) { return each<Packs>([](auto x, auto y) { return x / y; }, a, b); }
inline Masks operator<(const Packs& a, const Packs& b) { return each<Masks>([](auto x, auto y) { return x < y; }, a, b); }
inline Masks operator>(const Packs& a, const Packs& b) { return each<Masks>([](auto x, auto y) { return x > y; }, a, b); }
inline Masks operator<=(const Packs& a, const Packs& b) { return each<Masks>([](auto x, auto y) { return x <= y; }, a, b); }
inline Masks operator>=(const Packs& a, const Packs& b) { return each<Masks>([](auto x, auto y) { return x >= y; }, a, b); }
inline Packs operator-(const Packs& a) { return each<Packs>([](auto x) { return -x; }, a); }
inline Packs abs(const Packs& a) { return each<Packs>([](auto x) { return abs(x); }, a); }
inline Packs sqrt(const Packs& a) { return each<Packs>([](auto x) { return sqrt(x); }, a); }
inline Packs sin(const Packs& a) { return each<Packs>([](auto x) { return sin(x); }, a); }
inline Packs cos(const Packs& a) { return each<Packs>([](auto x) { return cos(x); }, a); }
inline Packs tan(const Packs& a) { return each<Packs>([](auto x) { return tan(x); }, a); }
inline Packs exp(const Packs& a) { return each<Packs>([](auto x) { return exp(x); }, a); }
inline Packs log(const Packs& a) { return each<Packs>([](auto x) { return log(x); }, a); }
inline Packs atan2(const Packs& a, const Packs& b) { return each<Packs>([](auto y, auto x) { return atan2(y, x); }, a, b); }
inline Packs sign(const Packs& a) { return each<Packs>([](auto x) { return cdot::sign(x); }, a); }
inline Packs inverse(const Packs& a) { return each<Packs>([](auto x) { return cdot::inverse(x); }, a); }
inline Packs pivot(const Packs& d, const Packs& k) { return each<Packs>([](auto x, auto y) { return cdot::pivot(x, y); }, d, k); }
// clang-format on
inline Packs select(const Masks& condition, const Packs& a, const Packs& b) {
  return each<Packs>([](auto c, auto x, auto y) { return select(c, x, y); }, condition, a, b);
}

// The lanes of all packs in a row; f(pack, its lane).
inline constexpr std::size_t lanes = 4 + 8 + 16 + 4 + 8 + 16;
template <class F>
auto at_lane(Packs& p, std::size_t lane, F f) {
  int i = static_cast<int>(lane);
  if (i < 4) return f(p.f4, i);
  if ((i -= 4) < 8) return f(p.f8, i);
  if ((i -= 8) < 16) return f(p.f16, i);
  if ((i -= 16) < 4) return f(p.d4, i);
  if ((i -= 4) < 8) return f(p.d8, i);
  return f(p.d16, i - 8);
}

// The first lane of a pack among all lanes.
template <class Pack>
inline constexpr std::size_t first_lane = 0;
template <>
inline constexpr std::size_t first_lane<cdot::Pack<float, 8>> = 4;
template <>
inline constexpr std::size_t first_lane<cdot::Pack<float, 16>> = 12;
template <>
inline constexpr std::size_t first_lane<cdot::Pack<double, 4>> = 28;
template <>
inline constexpr std::size_t first_lane<cdot::Pack<double, 8>> = 32;
template <>
inline constexpr std::size_t first_lane<cdot::Pack<double, 16>> = 40;

}  // namespace packs

namespace cdot {

template <>
inline packs::Packs smallest<packs::Packs>() {
  return packs::each<packs::Packs>([](auto x) { return smallest<decltype(x)>(); }, packs::Packs(0));
}

}  // namespace cdot
