#include "derive/expression/unit.hpp"

#include <array>
#include <utility>

namespace cdot::derive {
namespace {

Unit without_hidden_radians(Unit u) {
  if (!u.m.is_zero() || !u.kg.is_zero()) u.rad = 0;
  return u;
}

std::string power_text(std::string_view name, Rational exponent) {
  std::string out(name);
  if (exponent == Rational(1)) return out;
  return out + "^" + (exponent.is_integer() ? exponent.text() : "(" + exponent.text() + ")");
}

}  // namespace

Unit operator*(const Unit& a, const Unit& b) {
  return without_hidden_radians({a.m + b.m, a.rad + b.rad, a.s + b.s, a.kg + b.kg, a.any + b.any});
}

Unit operator/(const Unit& a, const Unit& b) { return a * pow(b, -1); }

Unit pow(const Unit& u, Rational exponent) {
  return without_hidden_radians({u.m * exponent, u.rad * exponent, u.s * exponent, u.kg * exponent, u.any * exponent});
}

std::string text(const Unit& u) {
  const std::array<std::pair<const char*, Rational>, 5> parts = {
      {{"kg", u.kg}, {"m", u.m}, {"rad", u.rad}, {"any", u.any}, {"s", u.s}}};
  std::string over, under;
  for (const auto& [name, exponent] : parts) {
    if (exponent.sign() > 0) over += (over.empty() ? "" : "*") + power_text(name, exponent);
    if (exponent.sign() < 0) under += "/" + power_text(name, -exponent);
  }
  return (over.empty() ? "1" : over) + under;
}

std::string spoken(const Unit& u) {
  static const std::array<std::pair<Unit, const char*>, 13> words = {{
      {{}, "a pure number"},
      {{.m = 1}, "metres"},
      {{.rad = 1}, "radians"},
      {{.any = 1}, "the unit of the coordinate"},
      {{.s = 1}, "seconds"},
      {{.kg = 1}, "kilograms"},
      {{.m = 2}, "square metres"},
      {{.m = 1, .s = -1}, "metres per second"},
      {{.rad = 1, .s = -1}, "radians per second"},
      {{.m = 1, .s = -2}, "metres per second squared"},
      {{.s = -1}, "1/s"},
      {{.m = 1, .s = -2, .kg = 1}, "newtons"},
      {{.m = 2, .s = -2, .kg = 1}, "joules"},
  }};
  for (const auto& [unit, word] : words)
    if (unit == u) return word;
  return text(u);
}

}  // namespace cdot::derive
