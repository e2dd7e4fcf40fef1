// Passes keep the value of programs and never raise their cost; known kernels cost no more than code by hand.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include "derive/expression/components.hpp"
#include "derive/kernel/ledger.hpp"
#include "derive/kernel/plan.hpp"
#include "derive/language/specs_folder.hpp"
#include "tests/derive/expression/random_expressions.hpp"

using namespace cdot::derive;

namespace {

void expect_same_outputs(const Program& a, const Program& b, const Values& inputs) {
  const std::vector<double> x = run(a, inputs), y = run(b, inputs);
  ASSERT_EQ(x.size(), y.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_EQ(a.outputs[i].name, b.outputs[i].name);
    EXPECT_NEAR(x[i], y[i], 1e-8 * (1 + std::abs(x[i]))) << a.outputs[i].name;
  }
}

Program assembled(const std::vector<KnownScalar>& scalars, std::size_t from, std::size_t count) {
  Components components;
  std::vector<NamedExpr> outputs;
  for (std::size_t i = from; i < std::min(scalars.size(), from + count); ++i) {
    outputs.push_back({"C[" + std::to_string(i - from) + "]", components.of(scalars[i].e)});
  }
  return assemble(outputs);
}

Derivation derivation_of(const std::string& name) {
  const SpecsFolder folder(CDOT_SOURCE_DIR "/specs");
  const ReadResult read = folder.read(folder.find(name));
  if (!read.joint) throw std::runtime_error(render(*read.file, read.diagnostics));
  return derive(*read.joint);
}

Count cost(const KernelBlock& block, const std::string& function) {
  for (const KernelFunction& f : block.functions) {
    if (f.name == function) return count(f.program);
  }
  throw std::runtime_error("no function " + function);
}

}  // namespace

class Programs : public testing::TestWithParam<int> {};  // in the plane, in space

TEST_P(Programs, compute_the_expressions_that_they_are_assembled_from) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Pool pool(GetParam());
    RandomExpressions random(pool, seed);
    random.grow(60);
    const Program program = assembled(random.scalars(), 0, random.scalars().size());
    const std::vector<double> values = run(program, random.leaves());
    for (std::size_t i = 0; i < values.size(); ++i) {
      const KnownScalar& known = random.scalars()[i];
      EXPECT_NEAR(values[i], known.value, 1e-8 * (1 + std::abs(known.value))) << text_unnamed(known.e);
    }
  }
}

TEST_P(Programs, keep_their_values_through_the_passes_and_never_cost_more) {
  int cheaper = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Pool pool(GetParam());
    RandomExpressions random(pool, seed);
    random.grow(50);
    for (std::size_t from = 0; from < random.scalars().size(); from += 6) {
      const Program before = assembled(random.scalars(), from, 6), after = simplify(before);
      expect_same_outputs(before, after, random.leaves());
      EXPECT_LE(count(after).total(), count(before).total()) << "seed " << seed << ", from " << from;
      cheaper += count(after).total() < count(before).total();
    }
  }
  EXPECT_GT(cheaper, 30) << "the passes find something to do";
}

TEST_P(Programs, cost_no_less_when_simplified_again) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Pool pool(GetParam());
    RandomExpressions random(pool, seed);
    random.grow(40);
    const Program once = simplify(assembled(random.scalars(), 7, 6));
    EXPECT_LE(count(simplify(once)).total(), count(once).total());
  }
}

INSTANTIATE_TEST_SUITE_P(in, Programs, testing::Values(2, 3), testing::PrintToStringParamName());

TEST(Simplify, takes_common_factors_out) {
  Pool pool;
  const Expr a = pool.symbol("a", Role::given), b = pool.symbol("b", Role::given), c = pool.symbol("c", Role::given);
  const Program program = simplify(assemble({{"C[0]", a * b + a * c}}));
  EXPECT_EQ(count(program), (Count{1, 1, 0, 0, 0, 0})) << text(count(program));
}

TEST(Simplify, shares_sums_and_products) {
  Pool pool;
  const Expr a = pool.symbol("a", Role::given), b = pool.symbol("b", Role::given), c = pool.symbol("c", Role::given);
  const Program sums = simplify(assemble({{"C[0]", a + b}, {"C[1]", a + b + c}}));
  EXPECT_EQ(count(sums), (Count{2, 0, 0, 0, 0, 0})) << text(count(sums));
  const Program products = simplify(assemble({{"C[0]", a * b}, {"C[1]", a * b * c}}));
  EXPECT_EQ(count(products), (Count{0, 2, 0, 0, 0, 0})) << text(count(products));
}

// A cylinder: u . u - (u . t)^2 = u . (u - (u . t) t), and the gradient has these differences.
TEST(Simplify, opens_a_product_beside_squares) {
  Pool pool;
  const Expr x = pool.symbol("x", Role::given), y = pool.symbol("y", Role::given), s = pool.symbol("s", Role::given),
             t = pool.symbol("t", Role::given), h = s * x + t * y;
  const Expr value = x * x + y * y - h * h;
  const Expr along_x = Rational(2) * x - Rational(2) * s * h, along_y = Rational(2) * y - Rational(2) * t * h;
  const Program program = simplify(assemble({{"C[0]", value}, {"C[1]", along_x}, {"C[2]", along_y}}));
  EXPECT_LE(count(program).total(), 12) << text(count(program));
}

TEST(Simplify, takes_minus_signs_out_where_that_costs_nothing) {
  Pool pool;
  const Expr a = pool.symbol("a", Role::given), b = pool.symbol("b", Role::given), c = pool.symbol("c", Role::given),
             d = pool.symbol("d", Role::given);
  // a + b (-2 c - b d) costs the same as a - b (2 c + b d).
  const Expr e = a - Rational(2) * b * c - b * b * d;
  const Program program = simplify(assemble({{"C[0]", e}}));
  EXPECT_EQ(count(program), (Count{2, 3, 0, 0, 0, 0})) << text(count(program));
  for (const Operation& op : program.ops) {
    if (op.kind != OpKind::sum) continue;
    EXPECT_TRUE(std::any_of(op.coefs.begin(), op.coefs.end(), [](Rational coef) { return coef.sign() > 0; }));
  }
}

TEST(Simplify, subtracts_positions_first) {
  // (x_a + ra) - (x_b + rb): far from the origin x_a + ra would round ra away.
  const Derivation derivation = derivation_of("revolute");
  const Kernel kernel = simplified(plan(derivation));
  const Program& C = kernel.rows.functions.front().program;
  for (const Operation& op : C.ops) {
    if (op.kind != OpKind::sum) continue;
    int positions = 0;
    for (const int arg : op.args) positions += C.ops[static_cast<std::size_t>(arg)].is_position;
    EXPECT_NE(positions, 1) << "a position alone in a sum";
  }
}

TEST(Simplify, has_positions_first_in_every_sum) {
  // ra + x_a - x_b, taken from the left, would round ra away.
  for (const char* const name : {"line", "prismatic", "rolling", "pulley"}) {
    const Derivation derivation = derivation_of(name);
    const Kernel kernel = simplified(plan(derivation));
    for (const KernelFunction& f : kernel.rows.functions) {
      for (const Operation& op : f.program.ops) {
        if (op.kind != OpKind::sum) continue;
        const auto is_position = [&](int arg) { return f.program.ops[static_cast<std::size_t>(arg)].is_position; };
        EXPECT_TRUE(std::is_partitioned(op.args.begin(), op.args.end(), is_position)) << name << ' ' << f.name;
      }
    }
  }
}

TEST(Simplify, cancels_what_is_taken_away_and_added_again) {
  Pool pool;
  const Expr x = pool.symbol("x", Role::given), r = pool.symbol("r", Role::given), c = pool.symbol("c", Role::given),
             u = x - r;
  pool.name(u, "u", true);
  const Program program = simplify(assemble({{"C[0]", c * u}, {"C[1]", c * (u + r)}}));
  EXPECT_EQ(count(program), (Count{1, 2, 0, 0, 0, 0})) << text(count(program));
}

TEST(Cost, of_gamma_is_that_of_the_rates_of_J) {
  // (w_a - w_b) . d(na x nb)/dt, not na and nb differentiated twice (84 operations).
  const Derivation derivation = derivation_of("n1");
  EXPECT_LE(cost(simplified(plan(derivation)).rows, "gamma").total(), 78);
}

TEST(Cost, of_the_point_joint_is_that_of_a_careful_person) {
  const Derivation derivation = derivation_of("revolute");
  const Kernel kernel = simplified(plan(derivation));
  // Per body: I ra_y ra_y, I ra_x ra_x, and one product shared by K21 = -I ra_x ra_y.
  EXPECT_EQ(cost(kernel.rows, "effective_mass").multiply, 2 * 5);
  EXPECT_EQ(cost(kernel.rows, "velocity").multiply, 2 * 2);
  EXPECT_EQ(cost(kernel.rows, "jacobian").multiply, 2 * 4) << "two rotated arms, nothing else";
  for (const KernelBlock& variant : kernel.rows.variants) {
    EXPECT_EQ(cost(variant, "effective_mass").multiply, 5) << variant.name;
  }
}

TEST(Cost, of_a_negative_in_J_is_left_to_whoever_uses_it) {
  const Derivation derivation = derivation_of("revolute");
  const Expr ra = derivation.joint.parameters.front().symbol, square = dot(ra, ra);
  const auto cost_of = [&](const char* quantity, Expr e) {
    return cost_from_poses(derivation.joint, quantity, {e}).add;
  };
  EXPECT_EQ(cost_of("J", -square), cost_of("J", square));
  EXPECT_EQ(cost_of("C", -square), cost_of("C", square) + 1);
  EXPECT_EQ(cost_of("K", -square), cost_of("K", square) + 1);
}

TEST(Cost, counts_powers_negations_and_guards) {
  Pool pool;
  const Expr a = pool.symbol("a", Role::given);
  const auto cost_of = [&](Expr e) { return count(assemble({{"C[0]", e}})); };
  EXPECT_EQ(cost_of(pow(a, 4)), (Count{0, 3, 0, 0, 0, 0}));
  EXPECT_EQ(cost_of(-a), (Count{1, 0, 0, 0, 0, 0}));
  EXPECT_EQ(cost_of(Rational(2) * a), (Count{0, 1, 0, 0, 0, 0}));
  EXPECT_EQ(cost_of(Rational(-2) * a), (Count{0, 1, 0, 0, 0, 0}));
  EXPECT_EQ(cost_of(a + pool.number(2)), (Count{1, 0, 0, 0, 0, 0})) << "nothing is multiplied";
  EXPECT_EQ(cost_of(call(Fn::inverse, a)), (Count{0, 0, 1, 0, 1, 0}));
  EXPECT_EQ(cost_of(call(Fn::sin, a)), (Count{0, 0, 0, 0, 0, 1}));
  EXPECT_EQ(cost_of(call(Fn::sqrt, a)), (Count{0, 0, 0, 1, 0, 0}));
  EXPECT_EQ(cost_of(a), Count{});
}
