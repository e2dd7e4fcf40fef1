// Joints that start by their coordinates: from the written poses far away, closed forms, and starts out of reach.
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "tests/runtime/tool/support.hpp"

namespace cdot::test {
namespace {

constexpr double degree = std::numbers::pi / 180;

// The scene of specs/scenes with keys added to its joint of that name.
Scene started(const std::string& scene, const std::string& joint, const std::string& keys) {
  std::string text = read_text(scenes_dir() / (scene + ".toml"));
  const std::size_t name = text.find("\"" + joint + "\"\n", text.find("[[joint]]"));
  if (name == std::string::npos) throw Error("no joint " + joint);
  text.insert(text.find('\n', name) + 1, keys + "\n");
  return read_scene(std::string_view(text), "test.toml");
}

template <class S>
BasicWorld<S> world_of(const Scene& scene) {
  std::string warnings;
  BasicWorld<S> world = world_at_start<S>(scene, warnings);
  EXPECT_EQ(warnings, "");
  EXPECT_LT(world.worst_position_error().value, 1e-13);
  EXPECT_LT(world.worst_velocity_error().value, 1e-11);
  return world;
}

int joint_called(const Scene& scene, const std::string& name) {
  for (std::size_t k = 0; k < scene.joints.size(); ++k)
    if (scene.joints[k].name == name) return static_cast<int>(k);
  throw Error("no joint " + name);
}

// The report of a scene that is refused.
std::string refused(const std::string& scene, const std::string& joint, const std::string& keys) {
  try {
    started(scene, joint, keys);
  } catch (const SceneError& error) {
    return error.what();
  }
  return "read without a mistake";
}

// A four-bar of equal rods is a rhombus: the coupler stays level and its centre is on the circle of the cranks. The
// written pose stands at 90 degrees, relative angle 0.
TEST(Start, FourBarFollowsItsCrank) {
  for (const double turn : {30.0, 60.0, -80.0}) {
    const Scene scene = started(
        "four_bar", "A0", "start = { angle = \"" + std::to_string(turn + 90) + " deg\" }\nstart_rate = { angle = -3 }");
    World<double> world = world_of<Planar<double>>(scene);
    const double angle = (turn + 90) * degree;
    EXPECT_NEAR(world.coordinate(joint_called(scene, "A0"), "angle"), angle, 1e-13) << turn;
    EXPECT_NEAR(world.place(0).x, 0.5 * std::cos(angle), 1e-13);
    EXPECT_NEAR(world.place(1).x, 0.5 + std::cos(angle), 1e-12);
    EXPECT_NEAR(world.place(1).y, std::sin(angle), 1e-12);
    EXPECT_NEAR(world.place(1).angle, 0, 1e-12);
    EXPECT_NEAR(world.velocity(1).x, 3 * std::sin(angle), 1e-11);
    EXPECT_NEAR(world.velocity(1).y, -3 * std::cos(angle), 1e-11);
    EXPECT_NEAR(world.velocity(2).w, -3, 1e-11);
  }
}

// The rhombus folds flat at 180 degrees: 170 degrees is near a pose that loses rank.
TEST(Start, FourBarStartsAt170Degrees) {
  const Scene scene = started("four_bar", "A0", "start = { angle = \"170 deg\" }");
  World<double> world = world_of<Planar<double>>(scene);
  EXPECT_NEAR(world.place(1).x, 0.5 + std::cos(170 * degree), 1e-12);
  EXPECT_NEAR(world.place(1).y, std::sin(170 * degree), 1e-12);
}

// The slider of a crank r with rod l stands at r cos(phi) + sqrt(l^2 - (r sin(phi))^2).
TEST(Start, SliderCrankStartsAt170Degrees) {
  const Scene scene =
      started("slider_crank", "O", "start = { angle = \"170 deg\" }\nstart_rate = { angle = \"1000 deg\" }");
  World<double> world = world_of<Planar<double>>(scene);
  const double phi = 170 * degree, w = 1000 * degree, r = 0.153, l = 0.306, s = r * std::sin(phi),
               c = r * std::cos(phi);
  EXPECT_NEAR(world.place(2).x, c + std::sqrt(l * l - s * s), 1e-13);
  EXPECT_NEAR(world.place(2).y, 0, 1e-14);
  EXPECT_NEAR(world.velocity(0).w, w, 1e-11);
  EXPECT_NEAR(world.velocity(2).x, -s * w - s * c * w / std::sqrt(l * l - s * s), 1e-11);
}

// Every link 170 degrees from the one before: the angles of the bodies count on beyond a turn.
TEST(Start, ChainStartsWithEveryHingeAt170Degrees) {
  std::string text = read_text(scenes_dir() / "chain_10.toml");
  const std::string keys = "start = { angle = \"170 deg\" }\nstart_rate = { angle = 1 }\n";
  for (std::size_t at = 0; (at = text.find("type ", at)) != std::string::npos; at += keys.size() + 1)
    text.insert(at, keys);
  const Scene scene = read_scene(std::string_view(text), "test.toml");
  World<double> world = world_of<Planar<double>>(scene);
  for (int joint = 0; joint < world.joint_count(); ++joint) {
    EXPECT_NEAR(world.coordinate(joint, "angle"), 170 * degree, 1e-12) << joint;
    EXPECT_NEAR(world.coordinate_rate(joint, "angle"), 1, 1e-11) << joint;
  }
  EXPECT_EQ(world.joint_count(), 10);
}

const std::string door = R"(dimension = 3
[[body]]
name     = "door"
mass     = 20
shape    = { box = [0.9, 0.04, 2] }
position = [0.45, 0, 1]
[[joint]]
type   = "hinge"
bodies = ["world", "door"]
at     = [0, 0, 1]
fa     = { world = [0, 0, 1] }
start_rate = { angle = "-1/2" }
angle.spring = { stiffness = 5, damping = 0 }
)";

TEST(Start, HingeInSpaceStartsAt170Degrees) {
  const Scene scene = read_scene(std::string_view(door + "start = { angle = \"170 deg\" }\n"), "test.toml");
  SpatialWorld<double> world = world_of<Spatial<double>>(scene);
  const double angle = 170 * degree;
  EXPECT_NEAR(world.coordinate(0, "angle"), angle, 1e-13);
  EXPECT_NEAR(world.place(0).x, 0.45 * std::cos(angle), 1e-13);
  EXPECT_NEAR(world.place(0).y, 0.45 * std::sin(angle), 1e-13);
  EXPECT_NEAR(world.velocity(0).wz, -0.5, 1e-13);
  EXPECT_NEAR(world.velocity(0).x, 0.225 * std::sin(angle), 1e-13);
  // The rest of the spring is the written angle, 0: its energy is k phi^2 / 2.
  const double moving = 0.5 * 20 * 0.225 * 0.225 + 0.5 * 20 * (0.81 + 0.0016) / 12 * 0.25;
  EXPECT_NEAR(world.energy(), moving + 0.5 * 5 * angle * angle, 1e-10);
}

TEST(Start, OtherMechanismsStayAsWritten) {
  const std::string free = "[[body]]\nname = \"other\"\nmass = 1\ninertia = 1\nposition = [7.1, 3.3]\nspin = 0.7\n";
  std::string text = read_text(scenes_dir() / "four_bar.toml") + free;
  text.insert(text.find("type", text.find("\"A0\"")), "start = { angle = 1 }\n");
  const Scene scene = read_scene(std::string_view(text), "test.toml");
  EXPECT_TRUE(scene.bodies[0].started);
  EXPECT_FALSE(scene.bodies[3].started);
}

// rolling has a parameter `start`: s + radius q = start. A number is that parameter, a table the coordinate s.
TEST(Start, ANumberIsTheParameterOfThatName) {
  const std::string wheel =
      "[[body]]\nname = \"wheel\"\nmass = 1\nposition = [0, 0.5]\nangle = -2\nshape = { disc = 0.5 }\n"
      "[[joint]]\ntype = \"rolling\"\nbodies = [\"wheel\", \"world\"]\nradius = 0.5\nn = [0, 1]\npb = [-1, 0]\n";
  const auto read = [&](const std::string& keys) { return read_scene(std::string_view(wheel + keys), "test.toml"); };
  const BasicWorld<Planar<double>> kept = world_of<Planar<double>>(read("start = 0\n"));
  EXPECT_NEAR(kept.coordinate(0, "slide"), 1, 1e-15);
  // From s = 1 and q = -2, start = 0 by default, to s = 1.2: q = -2.4.
  const BasicWorld<Planar<double>> moved = world_of<Planar<double>>(read("start = { slide = 1.2 }\n"));
  EXPECT_NEAR(moved.coordinate(0, "slide"), 1.2, 1e-13);
  EXPECT_NEAR(moved.place(0).angle, -2.4, 1e-13);
  try {  // the parameter follows a table, which this scene lacks
    read("start = { table = \"none.csv\", column = \"s\" }\n");
    FAIL();
  } catch (const SceneError& error) {
    EXPECT_NE(std::string(error.what()).find("table \"none.csv\" of `start`"), std::string::npos) << error.what();
  }
}

TEST(Start, AnUnknownCoordinateIsNamed) {
  const std::string report = refused("four_bar", "A0", "start = { agle = 1 }");
  EXPECT_NE(report.find("did you mean `angle`?"), std::string::npos) << report;
}

TEST(Start, AJointWithoutCoordinatesIsNamed) {
  const std::string report = refused("spatial/double_pendulum", "j1", "start = { angle = 1 }");
  EXPECT_NE(report.find("`revolute` has no coordinate"), std::string::npos) << report;
}

// A crank of 0.153 m before a rod of 0.306 m: the rod's angle stays within 30 degrees.
TEST(Start, ALoopThatClosesElsewhereTellsTheDistance) {
  const std::string report = refused("slider_crank", "B", "start = { angle = \"50 deg\" }");
  EXPECT_NE(report.find("`angle` of joint \"B\" cannot start at 50 deg: from the written"), std::string::npos)
      << report;
  EXPECT_NE(report.find("20 deg are left"), std::string::npos) << report;
}

TEST(Start, TwoStartsThatContradictEachOtherAreNamed) {
  std::string text = read_text(scenes_dir() / "four_bar.toml");
  text.insert(text.find("type", text.find("\"A1\"")), "start = { angle = \"100 deg\" }\n");
  text.insert(text.find("type", text.find("\"A0\"")), "start = { angle = \"120 deg\" }\n");
  try {
    read_scene(std::string_view(text), "test.toml");
    FAIL();
  } catch (const SceneError& error) {
    const std::string report = error.what();
    EXPECT_NE(report.find("starts that agree"), std::string::npos) << report;
    EXPECT_EQ(error.mistakes, 2) << report;
  }
}

// At its dead centre the slider cannot move without the crank leaving it: J of the slide is dependent there.
TEST(Start, ADeadCentreIsNamed) {
  const std::string report = refused("slider_crank", "guide", "start = { slide = -0.1 }");
  EXPECT_NE(report.find("dead centre"), std::string::npos) << report;
}

TEST(Start, RatesThatTheJointsFixAreRefused) {
  const std::string report = refused("slider_crank", "guide", "start_rate = { slide = 2 }");
  EXPECT_NE(report.find("fix it 2 m/s away from that"), std::string::npos) << report;
}

TEST(Start, LimitsAndHalfTurnsAreChecked) {
  const std::string beyond =
      refused("four_bar", "A0", "start = { angle = \"120 deg\" }\nangle.limit = [0, \"100 deg\"]");
  EXPECT_NE(beyond.find("starts at 120 deg, beyond its limit 100 deg"), std::string::npos) << beyond;
  EXPECT_THROW(read_scene(std::string_view(door + "start = { angle = \"200 deg\" }\n"), "test.toml"), SceneError);
}

}  // namespace
}  // namespace cdot::test
