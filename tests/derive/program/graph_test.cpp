// Programs that are rewritten in place come out as those that are copied for every rewriting: the same operations in
// the same order, with the same names.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include "derive/expression/components.hpp"
#include "derive/kernel/plan.hpp"
#include "derive/language/specs_folder.hpp"
#include "tests/derive/expression/random_expressions.hpp"
#include "tests/derive/program/full_rebuild.hpp"

using namespace cdot::derive;

namespace {

constexpr std::int64_t plenty = 1'000'000'000;

using InPlace = Passed (*)(const Program&, Effort&);
using Plainly = Program (*)(Program);
struct PassPair {
  const char* name;
  InPlace in_place;
  Plainly plainly;

  Program after(const Program& program, Effort& effort) const { return in_place(program, effort).value_or(program); }
};
constexpr PassPair passes[] = {{"terms", share_terms, plainly_shared_terms},
                               {"factors", share_factors, plainly_shared_factors},
                               {"take out", take_out_factors, plainly_taken_out}};

std::string described(const Program& program) {
  std::string s;
  for (std::size_t i = 0; i < program.ops.size(); ++i) {
    const Operation& op = program.ops[i];
    s += std::to_string(i) + ": " + std::to_string(static_cast<int>(op.kind)) + " " + op.input.text() + " '" +
         op.name.text() + "'";
    for (std::size_t k = 0; k < op.args.size(); ++k) {
      s += " " + (op.coefs.empty() ? "" : op.coefs[k].text() + "*") + std::to_string(op.args[k]);
      if (!op.exponents.empty()) s += "^" + std::to_string(op.exponents[k]);
    }
    s += "\n";
  }
  return s;
}

// One pass after another, so that each meets what the others leave.
void expect_alike(Program program, const std::string& what) {
  for (int round = 0; round < 2; ++round) {
    for (const PassPair& pass : passes) {
      Effort effort{plenty};
      const Passed passed = pass.in_place(program, effort);
      const Program in_place = passed.value_or(program), plainly = needed(pass.plainly(program));
      EXPECT_FALSE(effort.spent());
      ASSERT_EQ(described(in_place), described(plainly)) << what << ", " << pass.name;
      ASSERT_EQ(in_place, plainly) << what << ", " << pass.name;
      ASSERT_EQ(passed.has_value(), plainly != program) << what << ", " << pass.name;
      program = in_place;
    }
  }
}

// Random scalars, some of them with names, as a spec gives them.
Program random_program(int dimension, std::uint64_t seed) {
  Pool pool(dimension);
  RandomExpressions random(pool, seed);
  random.grow(45);
  Components components;
  std::vector<NamedExpr> outputs;
  for (std::size_t i = 0; i < random.scalars().size(); i += 2) {
    const Expr e = components.of(random.scalars()[i].e);
    if (i % 3 == 0 && e->kind == Kind::sum && e->name.empty()) pool.name(e, "n" + std::to_string(i), true);
    outputs.push_back({"C[" + std::to_string(i) + "]", e});
  }
  return assemble(outputs);
}

// Sums and products of few operands, so that many of them meet: equal ones, negatives, later ones.
Program dense_program(std::uint64_t seed) {
  ProgramBuilder builder;
  Random random(seed);
  const auto pick = [&](std::size_t size) { return static_cast<int>(random.bits() % size); };
  std::vector<int> made;
  for (int i = 0; i < 5; ++i) {
    Operation input;
    input.kind = OpKind::input;
    input.input = std::string("abcde").substr(static_cast<std::size_t>(i), 1);
    input.is_position = i < 2;
    made.push_back(builder.leaf(input));
  }
  for (int i = 0; i < 40; ++i) {
    const int n = 2 + pick(4);
    const std::string name = pick(3) == 0 ? "n" + std::to_string(i) : "";
    std::vector<int> args, exponents;
    Summands terms;
    for (int k = 0; k < n; ++k) {
      args.push_back(made[static_cast<std::size_t>(pick(pick(2) == 0 ? 5 : made.size()))]);
      exponents.push_back(1 + pick(2));
      terms.add(Rational(pick(2) == 0 ? 1 : pick(3) - 1), args.back());
    }
    const int kind = pick(8);
    made.push_back(kind < 4   ? builder.sum(std::move(terms), name)
                   : kind < 7 ? builder.product(std::move(args), std::move(exponents), name)
                              : builder.function(Fn::inverse, {args[0]}, name));
  }
  for (std::size_t i = 20; i < made.size(); i += 2) builder.output("C[" + std::to_string(i) + "]", made[i]);
  return builder.finish();
}

}  // namespace

TEST(Graph, rewrites_random_programs_as_copies_do) {
  for (std::uint64_t seed = 1; seed <= 25; ++seed) {
    for (const int dimension : {2, 3}) expect_alike(random_program(dimension, seed), "seed " + std::to_string(seed));
  }
}

TEST(Graph, rewrites_programs_whose_operations_meet_as_copies_do) {
  for (std::uint64_t seed = 1; seed <= 1500; ++seed) {
    try {
      expect_alike(dense_program(seed), "seed " + std::to_string(seed));
    } catch (const NumberTooLarge&) {
    }
    if (HasFatalFailure()) return;
  }
}

TEST(Graph, rewrites_kernels_as_copies_do) {
  const SpecsFolder folder(CDOT_SOURCE_DIR "/specs");
  for (const char* name : {"revolute", "cone", "universal"}) {
    const ReadResult read = folder.read(folder.find(name));
    ASSERT_TRUE(read.joint) << name;
    const Derivation derivation = derive(*read.joint);
    for (const KernelFunction& f : plan(derivation).rows.functions) {
      expect_alike(f.program, std::string(name) + " " + f.name);
    }
  }
}

// The rest of the first sum without c is known, but comes later: c (a + b), then d (a + b).
class LaterSum : public testing::Test {
 protected:
  static Program program(Rational of_a, Rational of_b) {
    ProgramBuilder builder;
    std::vector<int> made;
    for (const char* name : {"a", "b", "c", "d"}) {
      Operation input;
      input.kind = OpKind::input;
      input.input = name;
      made.push_back(builder.leaf(input));
    }
    const int a = made[0], b = made[1], c = made[2], d = made[3];
    const int ca = builder.product({c, a}, {1, 1}), cb = builder.product({c, b}, {1, 1});
    builder.output("C[0]", builder.sum({{ca, cb}, {Rational(1), Rational(1)}}));
    const int later = builder.sum({{a, b}, {of_a, of_b}}, "later");
    builder.output("C[1]", builder.product({later, d}, {1, 1}));
    return builder.finish();
  }
};

TEST_F(LaterSum, moves_to_the_front_and_keeps_its_name) {
  const Program later = program(1, 1);
  expect_alike(later, "a + b");
  Effort effort{plenty};
  const Program moved = take_out_factors(later, effort).value();
  EXPECT_EQ(count(moved), (Count{1, 2, 0, 0, 0, 0})) << text(count(moved));
  EXPECT_EQ(std::ranges::count(moved.ops, "later", &Operation::name), 1) << described(moved);
}

TEST_F(LaterSum, becomes_the_negative_of_what_is_known_now) {
  const Program later = program(-1, -1);
  expect_alike(later, "-a - b");
  Effort effort{plenty};
  const Program merged = take_out_factors(later, effort).value();
  EXPECT_EQ(count(merged).multiply, 2) << text(count(merged));
  EXPECT_EQ(count(merged).add, 2) << "a + b, and one negative: " << described(merged);
}

TEST(Effort, once_spent_changes_nothing) {
  Pool pool;
  const Expr a = pool.symbol("a", Role::given), b = pool.symbol("b", Role::given), c = pool.symbol("c", Role::given),
             d = pool.symbol("d", Role::given);
  const Program before = assemble(
      {{"C[0]", a + b + c}, {"C[1]", a + b + d}, {"C[2]", a * b * c}, {"C[3]", a * b * d}, {"C[4]", a * c + a * d}});
  for (const PassPair& pass : passes) {
    Effort nothing{0}, enough{plenty};
    EXPECT_EQ(described(pass.after(before, nothing)), described(needed(before))) << pass.name;
    EXPECT_NE(described(pass.after(before, enough)), described(needed(before))) << pass.name;
  }
}

TEST(Effort, ends_every_pass_with_a_right_program) {
  for (const PassPair& pass : passes) {
    bool spent = false;
    for (std::int64_t left = 1; left < 40'000; left = 2 * left + 1) {
      Pool pool(3);
      RandomExpressions random(pool, 7);
      random.grow(45);
      Components components;
      std::vector<NamedExpr> outputs;
      for (const KnownScalar& known : random.scalars()) outputs.push_back({"C[0]", components.of(known.e)});
      const Program before = assemble(outputs);
      Effort effort{left};
      const std::vector<double> x = run(before, random.leaves()), y = run(pass.after(before, effort), random.leaves());
      for (std::size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(x[i], y[i], 1e-8 * (1 + std::abs(x[i]))) << pass.name;
      spent = spent || effort.spent();
    }
    EXPECT_TRUE(spent) << pass.name;
  }
}

TEST(Effort, bounds_the_search_and_decides_alone_what_it_finds) {
  const Program program = dense_program(11);
  Effort plenty_left{plenty}, little{1'000}, again{1'000};
  const Program best = simplify(program, plenty_left), first = simplify(program, little);
  EXPECT_FALSE(plenty_left.spent());
  EXPECT_TRUE(little.spent());
  EXPECT_EQ(first, simplify(program, again));
  EXPECT_LT(count(best).total(), count(first).total());
  EXPECT_LE(count(first).total(), count(program).total());
}
