// Exact ranks: a Jacobian evaluated at random poses modulo the prime p = 2^61 - 1. Full rank there is full rank over
// the rationals. Modulo this p, -1 is no square and half of all numbers are, so roots and signs can be chosen as among
// the reals (the root that is a square itself), and the rotations form a group in which angles add.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "derive/expression/expr.hpp"

namespace cdot::derive {

// A number modulo 2^61 - 1.
class Modular {
 public:
  static constexpr std::uint64_t prime = (std::uint64_t{1} << 61) - 1;

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
  std::uint64_t value_ = 0;
};
Modular pow(Modular base, std::uint64_t exponent);
Modular inverse(Modular x);  // x must not be zero

// At so many random points a formula has to vanish that counts as zero without a proof.
inline constexpr int exact_points = 8;

// The answer to every question whether a formula is zero, by exact arithmetic at random points modulo the prime. A
// nonzero formula of degree d passes for zero with a probability of about d/2^61 at each point.
enum class Nullity {
  zero,     // at all of exact_points
  differs,  // a quotient of polynomials that is not zero at a point, so that it is not zero among the reals either
  unknown   // not zero at a point, but there a root or a logarithm has a value of its own; or it is defined nowhere
};
Nullity difference_modulo_prime(Expr a, Expr b);

// How many of the rows are independent at generic poses.
struct GenericRank {
  int rank = 0;
  int poses = 0;  // that were tried; 0: no pose was found at which everything is defined
  // For each superfluous row: coefficients, one per row, of a combination of the rows of J that vanishes at every pose;
  // empty if the coefficients depend on the pose. In order of the rows; the last nonzero coefficient is 1.
  struct Dependence {
    int row = 0;          // that depends on earlier ones
    std::vector<int> on;  // the earlier rows with a nonzero coefficient
    std::vector<Rational> coefs;
  };
  std::vector<Dependence> dependences;
};
GenericRank generic_rank(std::span<const std::vector<Expr>> J);  // entries row by row

}  // namespace cdot::derive
