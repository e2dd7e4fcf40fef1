// Sensors beside closed forms: a motor turns a rod at constant speed, a body flies in space.
#include <cmath>
#include <gtest/gtest.h>
#include <regex>

#include "runtime/tool/run/output.hpp"
#include "runtime/tool/viewer/plots.hpp"
#include "runtime/tool/watch/record.hpp"
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

// The rod without the sensors of its file, and then some.
Scene recorded(const std::vector<std::string>& groups) {
  const std::string text = "integrator = \"dop853\"\nstep = 0.001\n" + turning_rod;
  Scene scene = read_scene(std::string_view(text.substr(0, text.find("[[sensor]]"))), "test.toml");
  record(scene, groups);
  return scene;
}

TEST(Recorded, GroupsHaveTheirNamesAndUnits) {
  const auto heads = [](const std::vector<std::string>& groups) {
    std::string all;
    for (const Sensor& sensor : recorded(groups).sensors) all += sensor.name + " [" + sensor.unit + "] ";
    return all;
  };
  EXPECT_EQ(heads({}), "");
  EXPECT_EQ(heads({"coordinates"}), "pin.angle [rad] rate(pin.angle) [rad/s] ");
  EXPECT_EQ(heads({"drives", "energies"}), "force(pin.angle) [N*m] power(pin.angle) [W] energy [J] kinetic [J] ");
  EXPECT_EQ(heads({"reactions"}), "force(pin).x [N] force(pin).y [N] torque(pin) [N*m] ");
  EXPECT_EQ(heads({"accelerations"}),
            "acceleration(rod).x [m/s^2] acceleration(rod).y [m/s^2] angular_acceleration(rod) [rad/s^2] ");
  EXPECT_EQ(heads({"all"}), heads({"coordinates"}) + heads({"reactions"}) + heads({"drives"}) +
                                heads({"accelerations"}) + heads({"energies"}));
  const Scene twice = read_scene(
      std::string_view("integrator = \"rk4\"\n" + turning_rod.substr(0, turning_rod.find("name  = \"late\"") - 11)),
      "test.toml");
  EXPECT_EQ(twice.sensors[0].unit, "N*m");
  EXPECT_EQ(twice.sensors[1].unit, "W");
  EXPECT_EQ(twice.sensors[2].unit, "N");
  EXPECT_EQ(twice.sensors[4].unit, "J");
}

// On a circle of 0.5 m at 2 rad/s, by steps and, at 0.2505 s, inside one.
TEST(Recorded, ValuesAgreeWithClosedForms) {
  const Scene scene = recorded({"all"});
  RunOptions options;
  options.row_times = {0.2505, 0.8};
  options.row = [&](const Frame& frame) {
    const double angle = 2 * frame.time;
    const double ax = -2 * std::cos(angle), ay = -2 * std::sin(angle), torque = 9.81 * std::cos(angle);
    const double exact[] = {
        angle, 2,  2 * ax, 2 * ay + 19.62, std::sin(angle) * ax - std::cos(angle) * (ay + 9.81), torque, 2 * torque,
        ax,    ay, 0};
    for (std::size_t k = 0; k < std::size(exact); ++k)
      EXPECT_NEAR(frame.sensors[k], exact[k], 0.003) << scene.sensors[k].name << " at " << frame.time;
    EXPECT_NEAR(frame.sensors[11], 2. / 3 * 2, 1e-6) << "kinetic";
  };
  std::string warnings;
  simulate(scene, options, warnings);
}

TEST(Recorded, BodiesInSpaceHaveThreeOfEach) {
  Scene scene = read_scene(std::string_view(ball_in_space), "test.toml");
  record(scene, {"accelerations"});
  ASSERT_EQ(scene.sensors.size(), 8u);
  EXPECT_EQ(scene.sensors[7].name, "angular_acceleration(ball).z");
  RunOptions options;
  options.row_times = {0.5};
  options.row = [&](const Frame& frame) { EXPECT_NEAR(frame.sensors[4], -9.81, 1e-9); };
  std::string warnings;
  simulate(scene, options, warnings);
}

// The ticks say where a curve runs: the angle is 1 rad at 0.5 s, in the middle of the panel.
TEST(Plots, AxesBelongToTheirCurves) {
  Scene scene = recorded({"coordinates", "drives"});
  RunOptions options;
  options.film_times = every(0.01, scene.duration);
  std::string warnings;
  const std::string svg = plots_svg(scene, simulate(scene, options, warnings).film);
  for (const char* text :
       {">[rad]<", ">[rad/s]<", ">[N*m]<", ">[W]<", ">time [s]<", ">pin.angle</text>", ">0.2</text>"})
    EXPECT_NE(svg.find(text), std::string::npos) << text;
  std::smatch tick, curve;
  ASSERT_TRUE(std::regex_search(svg, tick, std::regex("x=\"78.0\" y=\"([0-9.]+)\" text-anchor=\"end\">1</text>")));
  ASSERT_TRUE(std::regex_search(svg, curve, std::regex("[ML]396.0 ([0-9.]+)L")));
  EXPECT_NEAR(std::stod(curve[1]), std::stod(tick[1]) - 4, 0.2);
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
