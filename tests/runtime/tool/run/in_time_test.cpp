// Scenes whose numbers follow the time: expressions and tables, by closed forms; sensors of one effect.
#include <cmath>
#include <fstream>
#include <gtest/gtest.h>

#include "runtime/tool/run/output.hpp"
#include "tests/runtime/tool/support.hpp"

namespace cdot::test {
namespace {

const std::string settings_in_time = "integrator = \"dop853\"\nstep = 0.01\nduration = 1\ngravity = [0, 0]\n";
const std::string wheel_in_time = R"(
[[body]]
name = "wheel"
mass = 1
inertia = 0.5

[[joint]]
name = "axle"
type = "revolute"
bodies = ["world", "wheel"]
at = [0, 0]
)";

// The rows of the output at some times.
std::vector<Frame> frames_of(const Scene& scene) {
  std::vector<Frame> frames;
  RunOptions options;
  options.row_times = {0.25, 0.5, 0.75, 1};
  options.row = [&](const Frame& frame) { frames.push_back(frame); };
  std::string warnings;
  simulate(scene, options, warnings);
  EXPECT_EQ(frames.size(), 4u);
  return frames;
}
std::vector<Frame> frames_of(const std::string& text) {
  return frames_of(read_scene(std::string_view(text), "in_time.toml"));
}

TEST(ScenesInTime, AMotorSwings) {
  const auto frames = frames_of(settings_in_time + wheel_in_time +
                                "angle.motor = { speed = \"2 [rad/s] * sin(3 [rad/s] * time)\", max = 50 }\n");
  for (const Frame& frame : frames)
    EXPECT_NEAR(frame.bodies[0].angle, 2.0 / 3 * (1 - std::cos(3 * frame.time)), 1e-10) << frame.time;
}

TEST(ScenesInTime, ALoadGrows) {
  const auto frames = frames_of(settings_in_time + wheel_in_time + "angle.load = \"6 [N*m/s] * time\"\n");
  for (const Frame& frame : frames) EXPECT_NEAR(frame.bodies[0].angle, 2 * std::pow(frame.time, 3), 1e-10);
}

// A force of a body by a table beside its scene, in columns with units.
TEST(ScenesInTime, ATablePushesABody) {
  const TemporaryFolder folder;
  std::ofstream(folder / "push.csv") << "# measured\ntime [s]; turn [deg]; push [N]\n0; 0; 4\n0.4; 90; -2\n";
  std::ofstream(folder / "scene.toml") << settings_in_time << R"(
[[body]]
name = "puck"
mass = 2
inertia = 0.5
force = [{ table = "push.csv", column = "push", interpolate = "step" }, "3 [N]"]
torque = "0.5 [N*m/s] * time"
)";
  const auto frames = frames_of(read_scene((folder / "scene.toml").string()));
  for (const Frame& frame : frames) {
    const double t = frame.time, late = std::max(t - 0.4, 0.0);
    EXPECT_NEAR(frame.bodies[0].vx, 2 * std::min(t, 0.4) - late, 1e-12) << t;
    EXPECT_NEAR(frame.bodies[0].vy, 1.5 * t, 1e-12) << t;
    EXPECT_NEAR(frame.bodies[0].w, 0.5 * t * t, 1e-12) << t;
  }
}

// A scalar parameter of a joint, by a table as well: 3 N m/s * t for a second, on 0.5 kg m^2.
TEST(ScenesInTime, ATableTurnsABody) {
  const TemporaryFolder folder;
  std::ofstream(folder / "turn.csv") << "time, M\n0, 0\n1, 3\n";
  std::ofstream(folder / "scene.toml") << settings_in_time << wheel_in_time << R"(
[[joint]]
type = "couple"
bodies = ["wheel"]
M = { table = "turn.csv", column = "M" }
)";
  const auto frames = frames_of(read_scene((folder / "scene.toml").string()));
  for (const Frame& frame : frames) EXPECT_NEAR(frame.bodies[0].w, 3 * frame.time * frame.time, 1e-12) << frame.time;
}

// A column in degrees is one in radians.
TEST(ScenesInTime, AColumnHasAUnit) {
  const TemporaryFolder folder;
  std::ofstream(folder / "speed.csv") << "time [s], speed [deg/s]\n0, 0\n10, 3600\n";
  std::ofstream(folder / "scene.toml") << settings_in_time << wheel_in_time
                                       << "angle.motor = { speed = { table = \"speed.csv\", column = \"speed\" }, "
                                          "max = 1e3 }\n";
  const auto frames = frames_of(read_scene((folder / "scene.toml").string()));
  EXPECT_NEAR(frames.back().bodies[0].w, 2 * std::acos(-1.0), 1e-9);
}

TEST(ScenesInTime, SensorsOfOneEffect) {
  const auto frames = frames_of(settings_in_time + wheel_in_time + R"toml(
angle.servo = { k = 8, d = 2, most = 100, target = "1 [rad] * time / 1 [s]" }
angle.load = 3
[[sensor]]
name = "all"
value = "force(axle.angle)"
[[sensor]]
name = "servo"
value = "force(axle.angle.servo)"
[[sensor]]
name = "watts"
value = "power(axle.angle.servo) - force(axle.angle.servo) * rate(axle.angle)"
)toml");
  for (const Frame& frame : frames) {
    if (frame.time == 0) continue;
    EXPECT_NEAR(frame.sensors[0] - frame.sensors[1], 3, 1e-9);
    EXPECT_NEAR(frame.sensors[2], 0, 1e-12);
    const double angle = frame.bodies[0].angle, pull = 8 * (angle - frame.time);
    EXPECT_NEAR(frame.sensors[1], -pull / std::sqrt(1 + pull * pull / 1e4) - 2 * frame.bodies[0].w, 1e-6);
  }
}

// The power of a thruster is force times velocity.
TEST(ScenesInTime, ThePowerOfAnEffect) {
  const auto frames = frames_of(settings_in_time + R"toml(
[[body]]
name = "puck"
mass = 2
inertia = 0.5
[[joint]]
name = "jet"
type = "push"
bodies = ["puck"]
pa = [0, 0]
F = ["4 [N/s] * time", 0]
[[sensor]]
name = "watts"
value = "power(jet)"
)toml");
  for (const Frame& frame : frames) EXPECT_NEAR(frame.sensors[0], 4 * frame.time * frame.bodies[0].vx, 1e-9);
}

}  // namespace
}  // namespace cdot::test
