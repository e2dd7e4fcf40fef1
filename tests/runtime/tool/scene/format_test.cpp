// A scene file -> the Scene: units, frames, defaults, copies.
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <numbers>

#include "tests/runtime/tool/support.hpp"

namespace cdot::test {
namespace {

namespace fs = std::filesystem;

Scene scene_of(const std::string& text) { return read_scene(std::string_view(text), "test.toml"); }

std::string body(const std::string& keys) { return "[[body]]\nname = \"rod\"\nmass = 2\n" + keys + "\n"; }

const std::vector<double>& parameter(const Scene& scene, std::size_t joint, const std::string& name) {
  for (const NamedValue& value : scene.joints[joint].definition.parameters) {
    if (value.name == name) return value.numbers;
  }
  throw Error("no parameter " + name);
}

TEST(Format, EverySceneOfTheCatalogueIsRead) {
  int scenes = 0;
  for (const fs::path& file : all_scene_files()) {
    EXPECT_NO_THROW(read_scene(file.string())) << file;
    ++scenes;
  }
  EXPECT_GE(scenes, 20);
}

// A body turned by a third of a turn about (1, 1, 1): its x, y, z are the world's y, z, x.
TEST(Format, TwoAxesOfAFrameAreGivenInTheWorld) {
  const Scene scene = scene_of("dimension = 3\n" + body("inertia = 1\norientation = [1, 1, 1, 1]") +
                               "[[joint]]\ntype = \"universal\"\nbodies = [\"rod\", \"world\"]\nat = [0, 0, 0]\n"
                               "fa = { world = [[1, 0, 0], [1, 2, 0]] }\n");
  const std::vector<double>& fa = parameter(scene, 0, "fa");
  const double expected[] = {0, 0, 1, 2, 0, 1};
  ASSERT_EQ(fa.size(), 6u);
  for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(fa[k], expected[k], 1e-15) << k;
}

// TOML calls 9107011641597973 a whole number, and a double rounds it.
TEST(Format, AWholeNumberBeyondTheDoublesIsRounded) {
  EXPECT_EQ(scene_of("duration = 9107011641597973\n" + body("inertia = 1")).duration, 9107011641597972.0);
  EXPECT_EQ(scene_of(body("inertia = 9223372036854775807")).bodies[0].definition.inertia, 0x1p63);
}

TEST(Format, EveryExampleOfTheReadmeIsAScene) {
  const std::string readme = read_text(scenes_dir() / "README.md");
  int examples = 0;
  for (std::size_t at = 0; (at = readme.find("```toml\n", at)) != std::string::npos; ++examples) {
    at += 8;
    const std::string text = readme.substr(at, readme.find("```", at) - at);
    EXPECT_NO_THROW(scene_of(text)) << text;
  }
  EXPECT_EQ(examples, 5);
}

// The keys in the README's tables and in the reader are the same: the reader lists its keys in the error about an
// unknown key.
TEST(Format, TheReadmeNamesEveryKey) {
  const std::string readme = read_text(scenes_dir() / "README.md");
  const std::string text = "zzzzzzzz = 1\n" + body("inertia = 1\nzzzzzzzz = 1");
  try {
    scene_of(text);
    FAIL();
  } catch (const SceneError& error) {
    std::string report = error.what();
    int keys = 0;
    for (std::size_t at = 0; (at = report.find("known are: ", at)) != std::string::npos;) {
      at += 11;
      std::string list = report.substr(at, report.find('\n', at) - at) + ", ";
      for (std::size_t end; (end = list.find(", ")) != std::string::npos; list.erase(0, end + 2)) {
        const std::string key = list.substr(0, end);
        const bool named = readme.find("`" + key) != std::string::npos || readme.find("[[" + key) != std::string::npos;
        EXPECT_TRUE(named) << key;
        ++keys;
      }
    }
    EXPECT_GE(keys, 30);
  }
}

TEST(Format, AnglesAndFractions) {
  const Scene scene = scene_of("step = \"1/60\"\n" + body("inertia = \"3/4\"\nangle = \"-90 deg\"\nspin = 2"));
  EXPECT_DOUBLE_EQ(scene.step, 1.0 / 60);
  EXPECT_DOUBLE_EQ(scene.bodies[0].definition.inertia, 0.75);
  EXPECT_DOUBLE_EQ(scene.bodies[0].definition.angle, -std::numbers::pi / 2);
  EXPECT_EQ(scene.bodies[0].definition.w, 2);
}

TEST(Format, InertiaOfUniformShapes) {
  EXPECT_DOUBLE_EQ(scene_of(body("shape = { rod = 3 }")).bodies[0].definition.inertia, 2 * 9.0 / 12);
  EXPECT_DOUBLE_EQ(scene_of(body("shape = { box = [3, 4] }")).bodies[0].definition.inertia, 2 * 25.0 / 12);
  EXPECT_DOUBLE_EQ(scene_of(body("shape = { disc = 3 }")).bodies[0].definition.inertia, 2 * 9.0 / 2);
  EXPECT_EQ(scene_of(body("shape = { disc = 3 }\ninertia = 7")).bodies[0].definition.inertia, 7);
}

TEST(Format, DefaultsAreThoseOfTheReadme) {
  const Scene scene = scene_of(body("inertia = 1"));
  EXPECT_EQ(scene.duration, 10);
  EXPECT_EQ(scene.step, 0);  // chosen by the default accuracy
  EXPECT_EQ(scene.accuracy, 0);
  EXPECT_TRUE(chooses_method(scene));
  EXPECT_EQ(scene.tolerance, 0.01);
  EXPECT_EQ(scene.settings.gravity_x, 0);
  EXPECT_EQ(scene.settings.gravity_y, -9.81);
  EXPECT_EQ(scene.settings.solver, Solver::direct);
  EXPECT_EQ(scene.settings.drift, Drift::projection);
  EXPECT_EQ(scene.settings.iterations, 10);
  EXPECT_EQ(scene.settings.substeps, 1);
  EXPECT_EQ(scene.settings.baumgarte, 0.2);
  EXPECT_EQ(scene.settings.sleep_after, 0);
  EXPECT_EQ(scene.settings.sleep_speed, 0.001);
  EXPECT_TRUE(scene.settings.warm_start);
  EXPECT_EQ(scene.settings.integrator, Integrator::euler);
  EXPECT_FALSE(scene.project);
}

// One point, given in three ways. The body is at (2, 1), rotated by 90 degrees: its x axis points up.
TEST(Format, PointsInTheBodyAndInTheWorld) {
  const std::string head = body("inertia = 1\nposition = [2, 1]\nangle = \"90 deg\"") +
                           "[[joint]]\ntype = \"revolute\"\nbodies = [\"world\", \"rod\"]\n";
  for (const char* said :
       {"pa = [2, 1.5]\npb = [0.5, 0]", "pa = [2, 1.5]\npb = { world = [2, 1.5] }", "at = [2, 1.5]"}) {
    const Scene scene = scene_of(head + said);
    EXPECT_NEAR(parameter(scene, 0, "pb")[0], 0.5, 1e-15) << said;
    EXPECT_NEAR(parameter(scene, 0, "pb")[1], 0, 1e-15) << said;
    EXPECT_EQ(parameter(scene, 0, "pa"), (std::vector<double>{2, 1.5})) << said;
  }
}

TEST(Format, DirectionsInTheWorldTurnWithTheBody) {
  const Scene scene = scene_of(body("inertia = 1\nangle = \"90 deg\"") +
                               "[[joint]]\ntype = \"prismatic\"\nbodies = [\"world\", \"rod\"]\nat = [0, 0]\n"
                               "t = { world = [0, 3] }\n");
  EXPECT_NEAR(parameter(scene, 0, "t")[0], 3, 1e-15);
  EXPECT_NEAR(parameter(scene, 0, "t")[1], 0, 1e-15);
}

TEST(Format, CopiesAreNumberedShiftedAndGivenValuesOfTheirOwn) {
  const Scene scene = scene_of(
      "[[body]]\nrepeat = 3\nname = \"link{i}\"\nmass = 1\ninertia = 1\nposition = [0.5, 1]\n"
      "shift = { position = [1, 0], mass = 0.5 }\neach = { angle = [0.1, \"180 deg\", 0.3] }\n"
      "[[joint]]\nrepeat = 2\nname = \"j{i-1}\"\ntype = \"revolute\"\nbodies = [\"link{i}\", "
      "\"link{i+1}\"]\n"
      "at = [1, 1]\nshift = { at = [1, 0] }\n");
  ASSERT_EQ(scene.bodies.size(), 3u);
  EXPECT_EQ(scene.bodies[2].name, "link3");
  EXPECT_EQ(scene.bodies[2].definition.x, 2.5);
  EXPECT_EQ(scene.bodies[2].definition.y, 1);
  EXPECT_EQ(scene.bodies[2].definition.mass, 2);
  EXPECT_DOUBLE_EQ(scene.bodies[1].definition.angle, std::numbers::pi);
  ASSERT_EQ(scene.joints.size(), 2u);
  EXPECT_EQ(scene.joints[0].name, "j0");
  EXPECT_EQ(scene.joints[1].definition.bodies, (std::vector<int>{1, 2}));
}

TEST(Format, EffectsOnCoordinates) {
  const Scene scene =
      scene_of(body("inertia = 1") +
               "[[joint]]\ntype = \"revolute\"\nbodies = [\"world\", \"rod\"]\nat = [0, 0]\n"
               "angle.limit = { upper = \"90 deg\" }\nangle.motor = { speed = 2, max = 5 }\n"
               "angle.spring = { stiffness = 10, damping = 1, rest = 0.5 }\nangle.damper = 0.25\n"
               "angle.friction = 3\nangle.load = -2\nbreaking = 500\nsoft = { frequency = 4, damping_ratio = 0.7 }\n");
  const SceneJoint& joint = scene.joints[0];
  ASSERT_EQ(joint.effects.size(), 1u);
  const CoordinateEffects& effects = joint.effects[0];
  EXPECT_EQ(effects.coordinate, "angle");
  EXPECT_FALSE(effects.limit->lower);
  EXPECT_DOUBLE_EQ(*effects.limit->upper, std::numbers::pi / 2);
  EXPECT_EQ(effects.motor->speed, 2);
  EXPECT_EQ(effects.motor->max_force, 5);
  ASSERT_EQ(effects.springs.size(), 2u);
  EXPECT_EQ(effects.springs[0].softness.stiffness, 10);
  EXPECT_EQ(effects.springs[0].rest, 0.5);
  EXPECT_EQ(effects.springs[1].softness.damping, 0.25);
  EXPECT_EQ(effects.friction->max_force, 3);
  EXPECT_EQ(effects.load->force, -2);
  ASSERT_EQ(joint.bonds.size(), 1u);
  EXPECT_EQ(joint.bonds[0].type, "breaking");
  EXPECT_EQ(joint.bonds[0].parameters[0].numbers, std::vector<double>{500});
  EXPECT_TRUE(joint.definition.soft->by_frequency);
  EXPECT_EQ(joint.definition.soft->frequency, 4);
}

TEST(Format, SpringsTakeTheirLengthFromTheStart) {
  const Scene scene =
      scene_of(body("inertia = 1\nposition = [3, 4]") + "[[spring]]\nbodies = [\"world\", \"rod\"]\nstiffness = 10\n");
  ASSERT_EQ(scene.springs.size(), 1u);
  EXPECT_EQ(scene.springs[0].rest_length, 5);
  EXPECT_EQ(scene.springs[0].body_a, world_body);
}

}  // namespace
}  // namespace cdot::test
