// Our polynomials against GiNaC's expand(), on random expressions.
#include "derive/proof/polynomial.hpp"

#include <cstdio>
#include <gtest/gtest.h>

#include "derive/numbers/numeric.hpp"

namespace cdot::derive {
namespace {

class RandomSums {
 public:
  explicit RandomSums(std::uint64_t seed) : random_(seed) {}

  const std::vector<ex>& variables() const { return variables_; }
  std::size_t below(std::size_t n) { return random_.bits() % n; }
  // Up to six terms with fractions and powers, some of which cancel.
  ex sum() {
    ex total = 0;
    for (std::size_t terms = 1 + below(6); terms > 0; --terms) {
      ex term = (numeric(static_cast<long>(below(9))) - 4) / static_cast<long>(1 + below(3));
      for (std::size_t factors = below(4); factors > 0; --factors) {
        term *= pow(variables_[below(variables_.size())], static_cast<int>(1 + below(3)));
      }
      total += term;
    }
    return total;
  }

 private:
  Random random_;
  std::vector<ex> variables_{GiNaC::realsymbol("u"), GiNaC::realsymbol("v"), GiNaC::realsymbol("w"),
                             GiNaC::realsymbol("x")};
};

TEST(Polynomials, SumsAndProductsAreThoseOfGiNaC) {
  RandomSums random(1);
  Polynomials all;
  std::size_t terms = 0;
  for (int k = 0; k < 300; ++k) {
    const ex a = random.sum().expand(), b = random.sum().expand();
    const Polynomial p = all.of_expanded(a), q = all.of_expanded(b);
    const Polynomial product = all.product(p, q), sum = all.sum(std::vector{p, q});
    terms += product.terms.size();
    ASSERT_TRUE((all.expression(product) - (a * b).expand()).is_zero()) << a << " times " << b;
    ASSERT_TRUE((all.expression(sum) - (a + b).expand()).is_zero()) << a << " plus " << b;
    ASSERT_TRUE(all.sum(std::vector{product, all.of_expanded((-a * b).expand())}).is_zero())
        << "terms that cancel stay";
  }
  std::printf("300 sums and products, %zu terms in the products\n", terms);
  EXPECT_GT(terms, 1000u);
}

TEST(Polynomials, CoefficientsAndDegreesAreThoseOfGiNaC) {
  RandomSums random(2);
  Polynomials all;
  for (int k = 0; k < 200; ++k) {
    const ex a = (random.sum() * random.sum()).expand();
    const ex& x = random.variables()[random.below(random.variables().size())];
    const Polynomial p = all.of_expanded(a);
    ASSERT_EQ(all.degree(p, x), a.degree(x)) << a;
    const std::vector<Polynomial> coefs = all.coefficients(p, x);
    for (std::size_t i = 0; i < coefs.size(); ++i) {
      ASSERT_TRUE((all.expression(coefs[i]) - a.coeff(x, static_cast<int>(i))).is_zero()) << a << ", power " << i;
    }
  }
}

// Fractions beyond 64 bits, and a variable that is no symbol.
TEST(Polynomials, NumbersAreExactAtAnySize) {
  Polynomials all;
  const ex x = GiNaC::realsymbol("x"), root = GiNaC::sqrt(x + 1);
  const Polynomial p = all.sum(std::vector{all.power(x, 2), all.power(root, 1), all.number(numeric(1, 1000003))});
  Polynomial power = all.number(1);
  for (int k = 0; k < 5; ++k) power = all.product(power, p);
  const ex expected = pow(pow(x, 2) + GiNaC::realsymbol("root") + numeric(1, 1000003), 5).expand();
  EXPECT_EQ(power.size(), expected.nops());
  EXPECT_TRUE(ex(all.expression(power).subs(x == 0) - pow(1 + numeric(1, 1000003), 5)).is_zero());
}

TEST(Polynomials, TheWeightCountsPowersAndTerms) {
  Polynomials all;
  const ex x = GiNaC::realsymbol("x"), y = GiNaC::realsymbol("y");
  EXPECT_EQ(all.weight(all.of_expanded(ex(0))), 2u);
  EXPECT_EQ(all.weight(all.of_expanded(ex(3))), 2u);
  EXPECT_EQ(all.weight(all.of_expanded(2 * x * pow(y, 3) + x + 5)), 3u + 2 + 2);
}

// An exponent that does not fit is refused and leaves nothing behind.
TEST(Polynomials, ExponentsThatDoNotFitAreRefused) {
  Polynomials all;
  const ex x = GiNaC::realsymbol("x");
  const Polynomial high = all.sum(std::vector{all.number(1), all.power(x, 40000)});
  EXPECT_THROW(all.product(high, high), std::overflow_error);
  const Polynomial low = all.sum(std::vector{all.number(1), all.power(x, 1)});
  EXPECT_EQ(all.product(low, low).size(), 3u);
}

}  // namespace
}  // namespace cdot::derive
