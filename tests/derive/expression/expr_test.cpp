// Builders keep values, equal expressions share one node, and rationals throw on overflow.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "derive/expression/components.hpp"
#include "tests/derive/expression/random_expressions.hpp"

using namespace cdot::derive;

namespace {

constexpr int pools = 150, steps = 120;

void expect_close(double actual, double expected, Expr e) {
  EXPECT_NEAR(actual, expected, 1e-8 * (1 + std::abs(expected))) << text_unnamed(e);
}

struct Plane {
  Pool pool;
  Expr u = pool.vector_symbol("u", Role::body_vector, 0), v = pool.vector_symbol("v", Role::body_vector, 1);
  Expr t = pool.vector_symbol("t", Role::body_vector, 1, true);
  Expr s = pool.symbol("s", Role::parameter), w = pool.symbol("w_a", Role::spin, 0);
  Expr number(std::int64_t n, std::int64_t d = 1) { return pool.number(Rational(n, d)); }
};

}  // namespace

class Expressions : public testing::TestWithParam<int> {};  // in the plane, in space

TEST_P(Expressions, keep_their_values_whatever_the_builders_rewrite) {
  std::size_t compared = 0;
  for (std::uint64_t seed = 1; seed <= pools; ++seed) {
    Pool pool(GetParam());
    RandomExpressions random(pool, seed);
    random.grow(steps);
    Numbers numbers(random.leaves());
    for (const auto& [e, value] : random.scalars()) expect_close(numbers.scalar(e), value, e);
    for (const auto& [e, value] : random.vectors()) {
      for (std::size_t k = 0; k < 3; ++k) expect_close(numbers.vector(e)[k], value[k], e);
    }
    compared += random.scalars().size() + random.vectors().size();
  }
  EXPECT_GT(compared, 8000u);
}

TEST_P(Expressions, in_components_keep_their_values) {
  for (std::uint64_t seed = 1; seed <= pools; ++seed) {
    Pool pool(GetParam());
    RandomExpressions random(pool, seed);
    random.grow(steps);
    Components components;
    Numbers numbers(random.leaves());
    for (const auto& [e, value] : random.scalars()) expect_close(numbers.scalar(components.of(e)), value, e);
    for (const auto& [e, value] : random.vectors()) {
      const std::vector<Expr> parts = components.of_vector(e);
      ASSERT_EQ(static_cast<int>(parts.size()), GetParam());
      for (std::size_t k = 0; k < parts.size(); ++k) {
        expect_close(numbers.scalar(parts[k]), value[k], e);
      }
      for (const Expr part : topological(parts)) EXPECT_FALSE(part->vector) << text_unnamed(e);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(in, Expressions, testing::Values(2, 3), testing::PrintToStringParamName());

TEST(Identities, hold_in_the_plane) {
  Plane p;
  const auto& [pool, u, v, t, s, w] = p;
  EXPECT_TRUE(is_one(dot(t, t)));
  EXPECT_TRUE(is_zero(cross(u, u)));
  EXPECT_TRUE(is_zero(dot(u, perp(u))));
  EXPECT_TRUE(is_zero(u - u));
  EXPECT_EQ(dot(perp(u), v), cross(u, v));
  EXPECT_EQ(dot(perp(u), perp(v)), dot(u, v));
  EXPECT_EQ(perp(perp(u)), -u);
  EXPECT_EQ(cross(w, u), w * perp(u));
  EXPECT_EQ(cross(u, v), -cross(v, u));
  EXPECT_EQ(dot(s * u, v), s * dot(u, v));
  EXPECT_EQ(dot(u, unit(u)), norm(u));
  EXPECT_EQ(norm(perp(u)), norm(u));
  EXPECT_EQ(norm(p.number(-2) * u), Rational(2) * norm(u));
  EXPECT_EQ(u / norm(u), unit(u));
  EXPECT_EQ(call(Fn::sqrt, dot(u, u)), norm(u));
  EXPECT_EQ(s * s, pow(s, 2));
  EXPECT_EQ(s / s * v, v);
}

TEST(Identities, hold_in_space) {
  Pool pool(3);
  const Expr u = pool.vector_symbol("u", Role::body_vector, 0), v = pool.vector_symbol("v", Role::body_vector, 1),
             t = pool.vector_symbol("t", Role::body_vector, 1, true);
  const Expr s = pool.symbol("s", Role::parameter);
  EXPECT_TRUE(is_one(dot(t, t)));
  EXPECT_TRUE(is_zero(cross(u, u)));
  EXPECT_EQ(cross(u, v), -cross(v, u));
  EXPECT_EQ(cross(s * u, v), s * cross(u, v));
  EXPECT_TRUE(is_zero(dot(u, cross(u, v))));
  const std::vector<Expr> world = world_axes(pool);
  ASSERT_EQ(world.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(cross(world[i], world[(i + 1) % 3]), world[(i + 2) % 3]);
    EXPECT_TRUE(is_zero(dot(world[i], world[(i + 1) % 3])));
  }
}

TEST(Nodes, that_are_equal_are_one) {
  Plane p;
  const auto& [pool, u, v, t, s, w] = p;
  EXPECT_EQ(u + v, v + u);
  EXPECT_EQ((u + v) + t, u + (v + t));
  EXPECT_EQ(s * w, w * s);
  EXPECT_EQ(Rational(1, 2) * (s + s), s);
  EXPECT_EQ(s + w - s, w);
}

TEST(Nodes, do_not_flatten_through_a_name) {
  Plane p;
  const auto& [pool, u, v, t, s, w] = p;
  const Expr d = u - v;
  p.pool.name(d, "d", true);
  const Expr sum = d + t;
  ASSERT_EQ(sum->args.size(), 2u);
  EXPECT_EQ(text(sum), "t + d");
  EXPECT_NE(text_unnamed(sum).find("u"), std::string::npos) << text_unnamed(sum);
}

TEST(Nodes, are_ordered_by_name_not_by_creation) {
  const auto built = [](bool backwards) {
    Pool pool;
    std::vector<std::string> names = {"alpha", "beta", "gamma", "delta"};
    if (backwards) std::reverse(names.begin(), names.end());
    for (const std::string& name : names) pool.symbol(name, Role::parameter);
    const auto s = [&](const char* name) { return pool.find(name); };
    return text(s("beta") * s("alpha") + s("delta") - s("gamma") * s("gamma"));
  };
  EXPECT_EQ(built(false), built(true));
}

TEST(Nodes, substitute_leaves_and_rebuild) {
  Plane p;
  const auto& [pool, u, v, t, s, w] = p;
  const Expr e = dot(u + s * v, t);
  const std::map<const Node*, Expr> replaced = {{&*u, v}, {&*s, p.number(-1)}};
  EXPECT_TRUE(is_zero(substitute(e, replaced)));
}

TEST(Rationals, are_exact) {
  EXPECT_EQ(Rational(1, 3) + Rational(1, 6), Rational(1, 2));
  EXPECT_EQ(Rational(2, -4), Rational(-1, 2));
  EXPECT_EQ(Rational(3, 7) / Rational(-9, 14), Rational(-2, 3));
  EXPECT_EQ(pow(Rational(-2, 3), -3), Rational(-27, 8));
  EXPECT_LT(Rational(1, 3), Rational(34, 100));
  EXPECT_EQ(Rational(-1, 2).text(), "-1/2");
}

TEST(Rationals, are_rounded_where_they_may_be) {
  const auto off = [](Rational a, long double value) {
    return std::abs((static_cast<long double>(a.num()) / static_cast<long double>(a.den())) / value - 1);
  };
  const Rational pi(3141592653589793238, 1000000000000000000), small(123456789012345678, 1000000000000000000);
  EXPECT_THROW(pi * pi, NumberTooLarge);
  {
    const RoundedNumbers rounded;
    constexpr long double exact_pi = 3.141592653589793238L, exact_small = 0.123456789012345678L;
    EXPECT_LT(off(pi * pi, exact_pi * exact_pi), 1e-18L);
    EXPECT_LT(off(-pi * pi * pi, -exact_pi * exact_pi * exact_pi), 1e-18L);
    EXPECT_LT(off(pow(small, 15), std::pow(exact_small, 15)), 1e-16L);
    EXPECT_LT(off(pow(pi, 30), std::pow(exact_pi, 30)), 1e-16L);
    EXPECT_EQ(Rational(1, 3) + Rational(1, 6), Rational(1, 2));
    EXPECT_THROW(pow(Rational(10), 19), NumberTooLarge);
    EXPECT_THROW(pow(small, 30), NumberTooLarge);
  }
  EXPECT_THROW(pi * pi, NumberTooLarge);
}

TEST(Rationals, refuse_to_overflow) {
  constexpr std::int64_t most = std::numeric_limits<std::int64_t>::max();
  EXPECT_THROW(Rational(most) + Rational(1), NumberTooLarge);
  EXPECT_THROW(Rational(most) * Rational(2), NumberTooLarge);
  EXPECT_THROW(Rational(1, most) * Rational(1, 2), NumberTooLarge);
  EXPECT_THROW(pow(Rational(10), 19), NumberTooLarge);
  EXPECT_THROW(Rational(1) / Rational(0), NumberTooLarge);
  EXPECT_THROW(Rational(1, 0), NumberTooLarge);
  EXPECT_THROW(Rational(std::numeric_limits<std::int64_t>::min(), 3), NumberTooLarge);
  EXPECT_EQ(Rational(most) * Rational(2, most), Rational(2));
  EXPECT_EQ(Rational(most, 2) - Rational(most, 2), Rational(0));
}
