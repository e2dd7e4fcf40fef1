// The elementary functions at one random point modulo the prime: random values that obey the laws on which formulas
// rely. Our own expressions and GiNaC's are both evaluated by it.
#pragma once

#include <cstdlib>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "derive/numbers/modular.hpp"
#include "derive/numbers/numeric.hpp"

namespace cdot::derive {

inline constexpr std::uint64_t attempts_at_poses = 1 << 15;  // of one test with our own expressions

// Thrown for the root of a non-square and for a division by zero: the caller tries another point.
struct UndefinedHere {};

// A point in the making: each leaf has a value by its name. Half of all numbers have no root, so one point in 2^n has n
// independent roots. A leaf of a root without a value is drawn again; the other leaves keep theirs.
class Draws {
 public:
  explicit Draws(std::uint64_t seed) : seed_(seed) {}
  std::uint64_t seed() const { return seed_; }
  std::uint64_t seed_of(std::string_view leaf) const;

  using Leaves = std::set<std::string, std::less<>>;
  // The leaf to draw again, of a root without a value: one that no other root has, if there is one.
  const std::string& choice(const Leaves& of_root, const Leaves& of_others) const;
  void again(const std::string& leaf) { ++draws_[leaf]; }
  // No leaf helps: a divisor is zero, or the root is of a number.
  void give_up() { given_up_ = true; }
  bool given_up() const { return given_up_; }

 private:
  std::uint64_t seed_;
  std::map<std::string, std::uint64_t, std::less<>> draws_;  // of each leaf drawn again
  bool given_up_ = false;
};

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

  // The next draw is the same for the same seed, whatever was drawn before.
  void draw_by(std::uint64_t seed) { random_ = Random(seed); }
  Modular any() { return Modular::of_bits(random_.bits()); }
  std::int64_t small() { return step * static_cast<std::int64_t>(random_.bits() >> 48); }
  Modular pi() const { return pi_; }
  Rotation any_rotation();
  Rotation turn_by(std::int64_t angle) const { return pow(unit_turn_, angle); }

  Modular inverse(Modular x) const;
  Modular root(Modular x) const;
  Modular call(Fn fn, std::span<const Modular> args);
  // True while every value was a quotient of polynomials in the point's coordinates. Otherwise a nonzero value proves
  // nothing about the reals, where a sum of squares is positive, log(x y) = log x + log y, and so on.
  bool holds_for_reals() const { return holds_for_reals_; }
  void begin_anew() { holds_for_reals_ = true; }
  Modular any_for(int kind, Modular x, Modular y) const;  // the same for the same arguments

 private:
  static constexpr std::int64_t step = 720720;                        // divisible by 1..16, so that halves stay whole
  static constexpr std::int64_t small_bound = std::int64_t{1} << 42;  // of sums; so few others pass for small

  static bool is_small(Modular x) { return std::abs(x.centred()) < small_bound; }
  Modular sign(Modular x) const;
  Rotation turn(Modular x);
  Modular exponential(Modular x);
  Modular arbitrary(int kind, Modular x, Modular y);

  Random random_;
  std::uint64_t salt_;
  Rotation unit_turn_;
  Modular base_, pi_;
  bool holds_for_reals_ = true;
};

// The zero-test of a formula at these points. `value_at(point)` returns its value and whether that holds for the reals.
// Where it is undefined, it returns none, and draws leaves again or gives up.
template <class Point, class ValueAt>
Nullity nullity(std::span<Point> points, ValueAt value_at, std::uint64_t attempts = attempts_at_poses) {
  const std::uint64_t hopeless = 1 + attempts / 64;
  for (Point& point : points) {
    std::optional<std::pair<Modular, bool>> found;
    while (!(found = value_at(point))) {
      const std::uint64_t spent = point.given_up() ? hopeless : 1;
      if (attempts <= spent) return Nullity::unknown;
      attempts -= spent;
      if (point.given_up()) point = Point(point.seed() + points.size());
    }
    const auto [value, holds_for_reals] = *found;
    if (!value.is_zero()) return holds_for_reals ? Nullity::differs : Nullity::unknown;
  }
  return Nullity::zero;
}
template <class Point = Draws>
std::vector<Point> points_for_zero_test() {
  std::vector<Point> points;
  for (std::uint64_t seed = 1; seed <= exact_points; ++seed) points.emplace_back(seed);
  return points;
}

}  // namespace cdot::derive
