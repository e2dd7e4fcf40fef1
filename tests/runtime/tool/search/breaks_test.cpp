// Scenes whose numbers follow tables of many rows: each step ends at the next row, whatever the local error.
#include <array>
#include <cmath>
#include <fstream>
#include <gtest/gtest.h>

#include "tests/runtime/tool/support.hpp"

namespace cdot::test::breaks_test {
namespace {

constexpr int rows = 2000;  // of a table, 1 ms apart
constexpr double duration = 2;

double torque_at_row(int k) { return 2 * std::sin(0.003 * k) + std::cos(0.017 * k); }

// (angle, w) of a rod of 1 kg and 1 m about its end, I = 1/3 kg m^2, by RK4 with ten steps from row to row.
std::array<double, 2> reference() {
  using State = std::array<double, 2>;
  State y{0, 0};
  constexpr int parts = 10;
  constexpr double h = duration / rows / parts;
  for (int k = 0; k < rows * parts; ++k) {
    const int row = k / parts;
    const auto torque = [&](double in_step) {
      const double share = (k % parts + in_step) / parts;
      return torque_at_row(row) + share * (torque_at_row(row + 1) - torque_at_row(row));
    };
    const auto rate = [&](const State& s, double in_step) {
      return State{s[1], 3 * (torque(in_step) - 9.81 / 2 * std::cos(s[0]))};
    };
    const auto moved = [](const State& s, const State& by, double t) {
      return State{s[0] + t * by[0], s[1] + t * by[1]};
    };
    const State a = rate(y, 0), b = rate(moved(y, a, h / 2), 0.5), c = rate(moved(y, b, h / 2), 0.5),
                d = rate(moved(y, c, h), 1);
    for (int i = 0; i < 2; ++i) y[i] += h / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]);
  }
  return y;
}

// Two runs by the same steps say nothing about their error, so the search asks another method.
TEST(Breaks, ASceneOfManyRowsIsJudgedByAnotherMethod) {
  const TemporaryFolder folder;
  std::ofstream table(folder / "torque.csv");
  table.precision(17);
  table << "time, M\n";
  for (int k = 0; k <= rows; ++k) table << k / 1000.0 << ", " << torque_at_row(k) << "\n";
  table.close();
  std::ofstream(folder / "scene.toml") << R"(
duration = 2
[[body]]
name = "rod"
mass = 1
shape = { rod = 1 }
position = [0.5, 0]
[[joint]]
type = "revolute"
bodies = ["world", "rod"]
at = [0, 0]
[[joint]]
type = "couple"
bodies = ["rod"]
M = { table = "torque.csv", column = "M" }
)";
  RunOptions options;
  Frame last;
  options.row_times = {duration};
  options.row = [&](const Frame& frame) { last = frame; };
  std::string warnings;
  const RunResult result = simulate(read_scene((folder / "scene.toml").string()), options, warnings);
  ASSERT_TRUE(result.choice);
  EXPECT_TRUE(result.choice->reached);
  EXPECT_LE(result.choice->achieved, 1e-4);
  EXPECT_LE(result.choice->runs_before, 3);
  const auto [angle, w] = reference();
  EXPECT_NEAR(last.bodies[0].angle, angle, 1e-9);
  EXPECT_NEAR(last.bodies[0].w, w, 1e-9);
}

}  // namespace
}  // namespace cdot::test::breaks_test
