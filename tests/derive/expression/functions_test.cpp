// Every row of the table of functions equals the <cmath> function of that name. Differences confirm its derivative, and
// exact arithmetic agrees with both.
#include "derive/expression/functions.hpp"

#include <gtest/gtest.h>

#include "derive/numbers/modular.hpp"
#include "derive/numbers/numeric.hpp"

namespace cdot::derive {
namespace {

// All functions are smooth here, far from the pole of tan: the central difference has an error of h^2 f'''/6.
constexpr double places[] = {0.2, 0.7, 1.1};

TEST(Functions, HaveTheDerivativeOfTheirValues) {
  for (const Function& f : functions) {
    if (f.derivative == nullptr || f.fn == Fn::sign) continue;
    EXPECT_FALSE(f.rule.empty()) << f.name << " has no sentence for its derivative";
    Pool pool;
    const Expr slope = f.derivative(call(f.fn, pool.symbol("x", Role::parameter)));
    for (const double x : places) {
      const double h = 1e-5, before = x - h, after = x + h;
      EXPECT_NEAR(evaluate(slope, {{"x", x}}), (f.value(&after) - f.value(&before)) / (2 * h), 1e-8) << f.name;
    }
  }
}

TEST(Functions, AreTheSameByOthers) {
  for (const Function& f : functions) {
    if (f.by_others == nullptr) continue;
    Pool pool;
    const Expr by_others = f.by_others(pool.symbol("x", Role::parameter));
    for (const double x : places) EXPECT_NEAR(evaluate(by_others, {{"x", x}}), f.value(&x), 1e-14) << f.name;
  }
}

TEST(Functions, KnowTheirExactValues) {
  for (const Function& f : functions) {
    for (const Rational x : {Rational(0), Rational(1), Rational(-3, 2)}) {
      const std::optional<Rational> exact = f.of_number ? f.of_number(x) : std::nullopt;
      const double place = x.value();
      if (!exact) continue;
      EXPECT_EQ(exact->value(), f.value(&place)) << f.name << " of " << x.text();
    }
  }
}

// cosh^2 - sinh^2 = 1, sinh 2x = 2 sinh x cosh x and cosh 2x = cosh^2 + sinh^2 hold modulo the prime; neighbouring
// values do not satisfy them.
TEST(Functions, ObeyTheLawsOfTheHyperbola) {
  Pool pool;
  const Expr x = pool.symbol("x", Role::parameter), s = call(Fn::sinh, x), c = call(Fn::cosh, x);
  const Expr twice = Rational(2) * x;
  const auto equal = [](Expr a, Expr b) { return difference_modulo_prime(a, b) == Nullity::zero; };
  EXPECT_TRUE(equal(pow(c, 2) - pow(s, 2), pool.number(1)));
  EXPECT_TRUE(equal(call(Fn::sinh, twice), Rational(2) * (s * c)));
  EXPECT_TRUE(equal(call(Fn::cosh, twice), pow(c, 2) + pow(s, 2)));
  EXPECT_FALSE(equal(pow(c, 2) + pow(s, 2), pool.number(1)));
}

}  // namespace
}  // namespace cdot::derive
