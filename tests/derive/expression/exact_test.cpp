// Arithmetic modulo the prime agrees with the reals where it is said to: small positive fractions have roots, turns by
// twelfths of pi are known, and points are found however many roots a formula has.
#include <array>
#include <gtest/gtest.h>
#include <string>

#include "derive/expression/functions.hpp"
#include "derive/numbers/modular.hpp"

namespace cdot::derive {
namespace {

Expr root(Expr x) { return call(Fn::sqrt, x); }
bool equal(Expr a, Expr b) { return difference_modulo_prime(a, b) == Nullity::zero; }

TEST(Exact, SmallPositiveFractionsHaveRoots) {
  Pool pool;
  const Expr x = pool.symbol("x", Role::parameter);
  for (int n = 2; n <= 60; ++n) {
    const Expr number = pool.number(Rational(n)), scaled = Rational(n, n + 1) * x;
    EXPECT_TRUE(equal(pow(root(number), 2) * x, Rational(n) * x)) << n;
    if (n == 60) continue;
    EXPECT_TRUE(equal(root(pow(scaled, 2)), Rational(n, n + 1) * root(pow(x, 2)))) << n;
    EXPECT_FALSE(equal(root(pow(scaled, 2)), Rational(n, n + 2) * root(pow(x, 2)))) << n;
  }
}

// cos(x + pi/6) = cos(x) sqrt(3)/2 - sin(x)/2, and so on
TEST(Exact, TurnsByTwelfthsOfPiAreKnown) {
  Pool pool;
  const Expr x = pool.symbol("x", Role::parameter), pi = pool.symbol("pi", Role::constant);
  const Expr c = call(Fn::cos, x), s = call(Fn::sin, x), half = pool.number(Rational(1, 2));
  const auto turned = [&](Rational by) { return call(Fn::cos, x + by * pi); };
  EXPECT_TRUE(equal(turned(Rational(1, 6)), half * root(pool.number(3)) * c - half * s));
  EXPECT_TRUE(equal(turned(Rational(1, 4)), half * root(pool.number(2)) * (c - s)));
  EXPECT_TRUE(equal(turned(Rational(1, 3)), half * c - half * root(pool.number(3)) * s));
  EXPECT_TRUE(equal(turned(Rational(1, 2)), -s));
  EXPECT_TRUE(equal(turned(Rational(-2, 3)), half * root(pool.number(3)) * s - half * c));
  EXPECT_FALSE(equal(turned(Rational(1, 6)), half * root(pool.number(3)) * c + half * s));
}

// One point in 2^24 has all of these roots.
TEST(Exact, PointsAreFoundForManyRoots) {
  Pool pool;
  Expr sum = pool.number(0), squares = pool.number(0), products = pool.number(0);
  std::vector<std::vector<Expr>> J(2);
  for (int i = 0; i < 24; ++i) {
    const Expr x = pool.symbol("x" + std::to_string(i), Role::parameter), r = root(x);
    products = products + sum * r;
    sum = sum + r;
    squares = squares + x;
    J[0].push_back(r);
    J[1].push_back(Rational(i % 2 + 1) * r);
  }
  EXPECT_TRUE(equal(pow(sum, 2), squares + Rational(2) * products));
  EXPECT_FALSE(equal(pow(sum, 2), squares + products));
  const GenericRank independent = generic_rank(J);
  EXPECT_EQ(independent.rank, 2);
  EXPECT_GE(independent.poses, 1);
  J[1] = J[0];
  EXPECT_EQ(generic_rank(J).rank, 1);
}

}  // namespace
}  // namespace cdot::derive
