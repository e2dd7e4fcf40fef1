// Exact arithmetic at random poses modulo a prime p: ranks and the zero-test. Full rank modulo p is full rank over the
// rationals. Modulo this p, -1 is no square, half of all numbers are squares, and all primes up to 59 are. So roots and
// signs can be chosen as among the reals (the root that is itself a square), small positive fractions are positive, and
// the rotations form a group in which angles add.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "derive/expression/expr.hpp"

namespace cdot::derive {

// A number modulo the largest prime below 2^61 with these properties.
class Modular {
 public:
  static constexpr int bits = 61;
  static constexpr std::uint64_t below_power = 636873, prime = (std::uint64_t{1} << bits) - below_power;

  Modular() = default;
  explicit Modular(std::int64_t whole);
  static Modular of_bits(std::uint64_t bits);

  std::uint64_t value() const { return value_; }
  bool is_zero() const { return value_ == 0; }
  bool is_square() const;
  // The representative nearest to zero.
  std::int64_t centred() const;

  friend Modular operator+(Modular a, Modular b);
  friend Modular operator-(Modular a, Modular b);
  friend Modular operator*(Modular a, Modular b);
  friend bool operator==(Modular a, Modular b) = default;

 private:
  static Modular of_twice(std::uint64_t below_2p);

  std::uint64_t value_ = 0;
};
Modular pow(Modular base, std::uint64_t exponent);
Modular inverse(Modular x);  // x must not be zero

// Number of random points at which a formula must vanish to count as zero without a proof.
inline constexpr int exact_points = 8;

// Result of the zero-test: exact arithmetic at random points modulo the prime. A nonzero formula of degree d passes for
// zero at a point with a probability of about d/2^61.
enum class Nullity {
  zero,     // at all of exact_points
  differs,  // a quotient of polynomials, nonzero at a point, hence nonzero among the reals
  unknown   // nonzero at a point, but with a root or logarithm chosen at random; or defined nowhere
};
Nullity difference_modulo_prime(Expr a, Expr b);

// Number of independent rows at generic poses.
struct GenericRank {
  int rank = 0;
  int poses = 0;  // poses tried; 0: every pose left something undefined
  // One for each redundant row, in order of the rows. The coefficients, one per row, combine the rows of J to zero at
  // every pose; the last nonzero one is 1. They are empty if they depend on the pose.
  struct Dependence {
    int row = 0;          // the redundant one
    std::vector<int> on;  // the earlier rows with a nonzero coefficient
    std::vector<Rational> coefs;
  };
  std::vector<Dependence> dependences;
};
GenericRank generic_rank(std::span<const std::vector<Expr>> J);  // entries row by row

}  // namespace cdot::derive
