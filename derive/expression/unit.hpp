// Units as products of metres, radians, seconds and kilograms with rational exponents (roots halve them), and of `any`:
// the unit of the coordinate that an effect acts on.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "derive/expression/rational.hpp"

namespace cdot::derive {

// Radians are kept only where nothing but seconds stands beside them: an arc, radius times angle, is in metres.
struct Unit {
  Rational m{}, rad{}, s{}, kg{}, any{};

  friend bool operator==(const Unit&, const Unit&) = default;
};

Unit operator*(const Unit& a, const Unit& b);
Unit operator/(const Unit& a, const Unit& b);
Unit pow(const Unit& u, Rational exponent);
// The unit of what an operator gives, from those of its arguments.
enum class UnitNeed { any, angle, number, equal };  // equal: all arguments have one unit
enum class UnitGiven { product, same, root, number, radians, metres, speed, spin, mass, inertia };
struct UnitRule {
  UnitNeed needs = UnitNeed::any;
  UnitGiven gives = UnitGiven::number;
};

std::string text(const Unit& u);    // "m", "rad/s", "kg*m^2", "1"
std::string spoken(const Unit& u);  // "metres", "radians", "metres per second", "a pure number", else text

}  // namespace cdot::derive
