// Numbers of planned functions: K lambda = rhs, with zeros in K that fill in; defaults of parameters, in their frames.
#include <cmath>
#include <gtest/gtest.h>

#include "derive/kernel/factor.hpp"
#include "derive/kernel/plan.hpp"
#include "derive/language/specs_folder.hpp"
#include "tests/derive/expression/random_expressions.hpp"

namespace cdot::derive {
namespace {

// The lower triangle of K, diagonally dominant. Rows 2 and 3 do not meet, but each meets row 1.
const std::vector<std::vector<double>> K = {{4}, {-1, 5}, {2, 0, 6}, {0, 1, 0, 3}};
const std::vector<double> rhs = {1, -2, 0.5, 3};

double entry(std::size_t i, std::size_t j) { return j > i ? K[j][i] : K[i][j]; }

void put_outputs(const Program& program, Values& values) {
  const std::vector<double> results = run(program, values);
  for (std::size_t i = 0; i < results.size(); ++i) values[program.outputs[i].name] = results[i];
}

TEST(Values, of_the_solve_fulfil_its_equation) {
  Pool pool;
  Block block;
  Values values;
  for (std::size_t i = 0; i < K.size(); ++i) {
    block.rows.emplace_back();
    block.K.emplace_back();
    values[element("rhs", i)] = rhs[i];
    for (std::size_t j = 0; j <= i; ++j) {
      const std::string name = triangle_element("K", i, j);
      block.K[i].push_back(K[i][j] == 0 ? pool.number(0) : pool.symbol(name, Role::given));
      values[name] = K[i][j];
    }
  }
  put_outputs(assemble(factor_outputs(block)), values);
  put_outputs(assemble(solve_outputs(block)), values);
  for (std::size_t i = 0; i < K.size(); ++i) {
    double sum = 0;
    for (std::size_t j = 0; j < K.size(); ++j) sum += entry(i, j) * values.at(element("lambda", j));
    EXPECT_NEAR(sum, rhs[i], 1e-12) << "row " << i + 1;
  }
}

// pb of b is where pa of a is: R_b^T (x_a + R_a pa - x_b).
TEST(Values, of_a_default_are_those_of_its_frame) {
  const SpecsFolder folder(CDOT_SOURCE_DIR "/specs");
  const ReadResult read = folder.read(folder.find("line"));
  ASSERT_EQ(read.joint->parameters[1].name, "pb");
  const double ca = std::cos(0.7), sa = std::sin(0.7), cb = std::cos(-0.4), sb = std::sin(-0.4);
  Values values = {{"x_a_x", 2}, {"x_a_y", 3}, {"x_b_x", -1}, {"x_b_y", 5},    {"a.c", ca},
                   {"a.s", sa},  {"b.c", cb},  {"b.s", sb},   {"p.pa_x", 0.3}, {"p.pa_y", -0.8}};
  put_outputs(plan_default(*read.joint, 1).program, values);
  const double x = 2 + ca * 0.3 + sa * 0.8 + 1, y = 3 + sa * 0.3 - ca * 0.8 - 5;
  EXPECT_NEAR(values.at("p.pb_x"), cb * x + sb * y, 1e-12);
  EXPECT_NEAR(values.at("p.pb_y"), cb * y - sb * x, 1e-12);
}

}  // namespace
}  // namespace cdot::derive
