// Sensors beside closed forms: a motor turns a rod at constant speed, a body flies in space.
#include <cmath>
#include <gtest/gtest.h>

#include "runtime/tool/run/output.hpp"
#include "tests/runtime/tool/support.hpp"

namespace cdot::test {
namespace {

// The torque is m g l / 2 cos(angle), the pull on the pin -m (l / 2 w^2 - g sin(angle)) along the rod.
const std::string turning_rod = R"toml(duration = 1
[[body]]
name     = "rod"
mass     = 2
shape    = { rod = 1 }
position = [0.5, 0]
[[joint]]
name   = "pin"
type   = "revolute"
bodies = ["world", "rod"]
at     = [0, 0]
start_rate = { angle = 2 }
angle.motor  = { speed = 2 }
angle.damper = 1e-9
[[sensor]]
name  = "torque"
value = "force(pin.angle)"
[[sensor]]
name  = "power"
value = "power(pin.angle)"
[[sensor]]
name  = "pull"
value = "dot(force(pin), rod.x)"
[[sensor]]
name  = "speed"
value = "rate(pin.angle) + w(rod) + dot(v(rod), perp(rod.x)) / 0.5 [m]"
[[sensor]]
name  = "kinetic"
value = "kinetic"
[[sensor]]
name  = "late"
value = "time + angle(rod) / 1 [rad/s] + x(rod).x / 1 [m/s]"
)toml";

struct MeasuringMethod {
  const char* keys;
  double tolerance;
  double first = 0.255;  // [s], inside a step; sweeps interpolate there
};

class MeasuredBy : public testing::TestWithParam<MeasuringMethod> {};

TEST_P(MeasuredBy, SensorsAgreeWithClosedForms) {
  std::string text = turning_rod;
  // A point of the world has no components: x(rod).x is written as a difference.
  const std::string wrong = "x(rod).x", right = "dot(x(rod) - x(rod), rod.x)";
  text.replace(text.find(wrong), wrong.size(), right);
  const Scene scene = read_scene(std::string_view(GetParam().keys + text), "test.toml");
  RunOptions options;
  int rows = 0;
  options.row_times = {GetParam().first, 0.5};
  options.row = [&](const Frame& frame) {
    const double angle = 2 * frame.time, tolerance = GetParam().tolerance;
    ASSERT_EQ(frame.sensors.size(), 6u);
    EXPECT_NEAR(frame.sensors[0], 9.81 * std::cos(angle), tolerance);
    EXPECT_NEAR(frame.sensors[2], -2 * (0.5 * 4 - 9.81 * std::sin(angle)), tolerance);
    // These are functions of the state alone, so they have its bits but for round-off.
    const BodyState& rod = frame.bodies[0];
    const double across = rod.vy * std::cos(rod.angle) - rod.vx * std::sin(rod.angle);
    EXPECT_NEAR(frame.sensors[1], rod.w * frame.sensors[0], 1e-12);
    EXPECT_NEAR(frame.sensors[3], 2 * rod.w + 2 * across, 1e-12);
    EXPECT_NEAR(frame.sensors[4], rod.vx * rod.vx + rod.vy * rod.vy + rod.w * rod.w / 12, 1e-12);
    EXPECT_NEAR(frame.sensors[5], frame.time + rod.angle, 1e-12);
    ++rows;
  };
  std::string warnings;
  const RunResult result = simulate(scene, options, warnings);
  EXPECT_EQ(rows, 2);
  ASSERT_EQ(result.sensors.size(), 6u);
  EXPECT_NEAR(result.sensors[3].most, 6, 0.01);
}

INSTANTIATE_TEST_SUITE_P(Sensors, MeasuredBy,
                         testing::Values(MeasuringMethod{"integrator = \"euler\"\nstep = 0.01\n", 0.25},
                                         MeasuringMethod{"integrator = \"rattle\"\nstep = 0.01\n", 0.25},
                                         MeasuringMethod{"integrator = \"implicit\"\nstep = 0.01\n", 0.25},
                                         MeasuringMethod{"solver = \"iterative\"\nstep = 0.01\n", 0.25, 0.25},
                                         MeasuringMethod{"integrator = \"rk4\"\nstep = 0.01\n", 1e-6},
                                         MeasuringMethod{"integrator = \"dop853\"\nstep = 0.01\n", 1e-6},
                                         MeasuringMethod{"integrator = \"radau5\"\nstep = 0.01\n", 1e-6},
                                         MeasuringMethod{"", 1e-3}));

const std::string ball_in_space = R"toml(dimension = 3
[[body]]
name     = "ball"
mass     = 2
shape    = { ball = 0.1 }
velocity = [3, 0, 4]
axis     = [0, 0, 1]
angle    = "90 deg"
[[sensor]]
name  = "speed"
value = "norm(v(ball))"
[[sensor]]
name  = "across"
value = "dot(v(ball), ball.y)"
)toml";

TEST(Sensors, ColumnsFollowTheBodies) {
  const Scene scene = read_scene(std::string_view(ball_in_space), "test.toml");
  EXPECT_TRUE(csv_head(scene).ends_with(",ball.wz,speed,across\n"));
  std::string row, warnings;
  RunOptions options;
  options.row_times = {0};
  options.row = [&](const Frame& frame) { row = csv_row(scene, frame); };
  simulate(scene, options, warnings);
  const std::size_t last = row.rfind(','), before = row.rfind(',', last - 1);
  EXPECT_EQ(row.substr(before + 1, last - before - 1), "5") << row;
  EXPECT_NEAR(std::stod(row.substr(last + 1)), -3, 1e-14);  // its y axis points along -x
}

TEST(Sensors, MistakesStandUnderTheirWords) {
  std::string text = turning_rod;
  text.replace(text.find("force(pin)"), 10, "force(pni)");
  text.replace(text.find("x(rod).x"), 8, "2 [m/s");
  try {
    read_scene(std::string_view(text), "test.toml");
    FAIL();
  } catch (const SceneError& error) {
    const std::string report = error.what();
    EXPECT_NE(report.find(R"text(error: there is no `force(pni)`
   23 | value = "dot(force(pni), rod.x)"
      |              ^^^^^^^^^^
  fix: did you mean `force(pin)`?)text"),
              std::string::npos)
        << report;
    EXPECT_EQ(error.mistakes, 2) << report;
  }
}

}  // namespace
}  // namespace cdot::test
