// The elementary functions at one random point modulo the prime: random values that obey the laws on which formulas
// rely. Our own expressions and GiNaC's are both evaluated by it.
#pragma once

#include <optional>
#include <span>
#include <utility>

#include "derive/numbers/modular.hpp"
#include "derive/numbers/numeric.hpp"

namespace cdot::derive {

inline constexpr std::uint64_t attempts_at_points = 16384;  // of one zero-test, most of them undefined

// Thrown for the root of a non-square and for a division by zero: the caller tries another point.
struct UndefinedHere {};

struct Rotation {
  Modular c{1}, s{0};
};
Rotation operator*(Rotation a, Rotation b);
Rotation pow(Rotation r, std::int64_t exponent);

// Sines of small whole numbers and their sums obey the addition theorems, exponentials theirs; other arguments get a
// random value each.
class ModularPoint {
 public:
  explicit ModularPoint(std::uint64_t seed);

  Modular any() { return Modular::of_bits(random_.bits()); }
  std::int64_t small() { return step * static_cast<std::int64_t>(random_.bits() >> 36); }
  Modular pi() const { return pi_; }
  Rotation any_rotation();
  Rotation turn_by(std::int64_t angle) const { return pow(unit_turn_, angle); }

  Modular inverse(Modular x) const;
  Modular root(Modular x) const;
  Modular call(Fn fn, std::span<const Modular> args);
  // True while every value was a quotient of polynomials in the point's coordinates. Otherwise a nonzero value proves
  // nothing about the reals, where a sum of squares is positive, log(x y) = log x + log y, and so on.
  bool holds_for_reals() const { return holds_for_reals_; }
  Modular any_for(int kind, Modular x, Modular y) const;  // the same for the same arguments

 private:
  static constexpr std::int64_t step = 720720;  // divisible by 1..16, so that halves stay whole
  static constexpr std::int64_t small_bound = std::int64_t{1} << 56;

  Modular sign(Modular x) const;
  Rotation turn(Modular x);
  Modular exponential(Modular x);
  Modular arbitrary(int kind, Modular x, Modular y);

  Random random_;
  std::uint64_t salt_;
  Rotation unit_turn_, eighth_turn_;
  Modular base_, pi_;
  bool holds_for_reals_ = true;
};

// The zero-test of a formula. `value_at(seed)` returns its value at a point, and whether that holds for the reals; none
// where it is undefined. With n roots, one point in 2^n is defined.
template <class ValueAt>
Nullity nullity(ValueAt value_at, std::uint64_t attempts = attempts_at_points) {
  int points = 0;
  for (std::uint64_t seed = 1; seed <= attempts && points < exact_points; ++seed) {
    const std::optional<std::pair<Modular, bool>> found = value_at(seed);
    if (!found) continue;
    const auto [value, holds_for_reals] = *found;
    if (!value.is_zero()) return holds_for_reals ? Nullity::differs : Nullity::unknown;
    ++points;
  }
  return points == exact_points ? Nullity::zero : Nullity::unknown;
}

}  // namespace cdot::derive
