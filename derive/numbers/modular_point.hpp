// The elementary functions at one random point modulo the prime: random values that obey the laws
// which formulas rely on. Apart from what is evaluated there: our own expressions, or GiNaC's.
#pragma once

#include <span>

#include "derive/numbers/modular.hpp"
#include "derive/numbers/numeric.hpp"

namespace cdot::derive {

// A root of no square, a division by zero: another point has to be tried.
struct UndefinedHere {};

struct Rotation {
  Modular c{1}, s{0};
};
Rotation operator*(Rotation a, Rotation b);
Rotation pow(Rotation r, std::int64_t exponent);

// Sines of small whole numbers and their sums obey the addition theorems, exponentials theirs;
// other arguments get a random value each.
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
  Modular call(Fn fn, std::span<const Modular> args) const;
  Modular any_for(int kind, Modular x, Modular y) const;  // the same for the same arguments

 private:
  static constexpr std::int64_t step = 720720;  // divisible by 1..16, so that halves stay whole
  static constexpr std::int64_t small_bound = std::int64_t{1} << 56;

  Modular sign(Modular x) const;
  Rotation turn(Modular x) const;
  Modular exponential(Modular x) const;

  Random random_;
  std::uint64_t salt_;
  Rotation unit_turn_, eighth_turn_;
  Modular base_, pi_;
};

}  // namespace cdot::derive
