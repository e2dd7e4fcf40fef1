// Scenes whose joints and effects are specs beside them, derived when the scene is read.
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>

#include "tests/runtime/tool/support.hpp"

namespace cdot::test::own_types_test {
namespace {

// A point slides on an ellipse of half axes p and q.
constexpr const char* ellipse = R"(joint bead_on_ellipse planar
  "A point of a stays on an ellipse around a point of b."
  point pa on a
  point pb on b
  frame f on b
  scalar p [m] from 0
  scalar q [m] from 0
  let u = pa - pb
  (dot(u, f.x)/p)^2 + (dot(u, f.y)/q)^2 = 1
)";

std::string scene_of(const std::string& type) {
  return fmt::format(R"(duration = 2
[[body]]
name = "bead"
mass = 1
inertia = 0.1
position = [2, 0]
velocity = [0, 0.5]
[[joint]]
type = "{}"
bodies = ["bead", "world"]
pa = [0, 0]
pb = [0, 0]
f = [1, 0]
p = 2
q = 1
)",
                     type);
}

void write(const std::string& path, const std::string& text) { std::ofstream(path) << text; }

std::string last_line(const std::string& path) {
  std::ifstream file(path);
  std::string line, last;
  while (std::getline(file, line)) last = line;
  return last;
}

TEST(OwnTypes, OfAFileBesideTheScene) {
  const TemporaryFolder folder;
  write(folder / "bead_on_ellipse.joint", ellipse);
  for (const char* type : {"bead_on_ellipse", "bead_on_ellipse.joint"}) {
    write(folder / "scene.toml", scene_of(type));
    const std::string scene = folder / "scene.toml", csv_path = folder / "run.csv";
    const CommandResult run = cdot_run(fmt::format("simulate '{}' -o '{}'", scene, csv_path));
    ASSERT_EQ(run.status, 0) << run.out << run.err;
    const std::string last = last_line(csv_path);
    double t = 0, x = 0, y = 0;
    ASSERT_EQ(std::sscanf(last.c_str(), "%lf,%lf,%lf", &t, &x, &y), 3);
    EXPECT_NEAR(x * x / 4 + y * y, 1, 1e-6);
    EXPECT_LT(y, 0.5);
  }
}

TEST(OwnTypes, MistakesOfTheSpecAreShownWithTheirLines) {
  const TemporaryFolder folder;
  std::string wrong = ellipse;
  wrong.replace(wrong.find("let u = pa"), 10, "let u = pc");
  write(folder / "bead_on_ellipse.joint", wrong);
  write(folder / "scene.toml", scene_of("bead_on_ellipse"));
  const CommandResult run = cdot_run(fmt::format("simulate '{}'", (folder / "scene.toml").string()));
  EXPECT_EQ(run.status, 2);
  for (const char* words : {"scene.toml:9:8: error: ", "bead_on_ellipse.joint cannot be used:",
                            "bead_on_ellipse.joint:8:11: error: ", "pc"})
    EXPECT_NE(run.err.find(words), std::string::npos) << words << "\n" << run.err;
}

TEST(OwnTypes, OfTheOtherSpaceAreRefused) {
  const TemporaryFolder folder;
  std::string spatial = ellipse;
  spatial.replace(spatial.find("planar"), 6, "spatial");
  write(folder / "bead_on_ellipse.joint", spatial);
  write(folder / "scene.toml", scene_of("bead_on_ellipse"));
  const CommandResult run = cdot_run(fmt::format("simulate '{}'", (folder / "scene.toml").string()));
  EXPECT_EQ(run.status, 2);
  EXPECT_NE(run.err.find("is a joint in space, and this scene is planar"), std::string::npos) << run.err;
}

// A block on a rail held by dry friction, and pushed by a force that grows with time: it slips at 3 s.
constexpr const char* stiction = R"(effect stiction coordinate
  "Dry friction up to a largest force."
  coordinate s [any]
  scalar most [J/any] from 0
  grip: rate(s) = 0, force in [-most, most]
)";
constexpr const char* ramp = R"(effect ramp planar
  "A force at a point of a body, along x, in proportion to the time."
  point pa on a
  unit n on world = world.x
  scalar r [N/s]
  force on pa = r*time * n
)";
constexpr const char* rail = R"(duration = 4
gravity = [0, -9.81]
[[body]]
name = "block"
mass = 1
inertia = 0.1
[[joint]]
type = "prismatic"
bodies = ["world", "block"]
at = [0, 0]
{} = 6
[[joint]]
type = "ramp"
bodies = ["block"]
pa = [0, 0]
r = 2
)";

// After 3 s: x'' = 2 (t - 3), so x = (t - 3)^3 / 3.
TEST(OwnTypes, EffectsBetweenBodiesAndOnCoordinates) {
  const TemporaryFolder folder;
  write(folder / "stiction.effect", stiction);
  write(folder / "ramp.effect", ramp);
  for (const char* key : {"slide.stiction", "slide.\"stiction.effect\""}) {
    write(folder / "scene.toml", fmt::format(rail, key));
    const std::string scene = folder / "scene.toml", csv_path = folder / "run.csv";
    const CommandResult run = cdot_run(fmt::format("simulate '{}' --accuracy 1e-6 -o '{}'", scene, csv_path));
    ASSERT_EQ(run.status, 0) << run.out << run.err;
    EXPECT_NE(run.out.find("stiction -"), std::string::npos) << "the work of its friction\n" << run.out;
    const std::string last = last_line(csv_path);
    double t = 0, x = 0;
    ASSERT_EQ(std::sscanf(last.c_str(), "%lf,%lf", &t, &x), 2);
    EXPECT_NEAR(x, 1. / 3, 1e-6);
  }
}

TEST(OwnTypes, EffectsInTheWrongPlaceAreToldWhereTheyGo) {
  const TemporaryFolder folder;
  write(folder / "stiction.effect", stiction);
  write(folder / "ramp.effect", ramp);
  std::string scene = fmt::format(rail, "slide.ramp");
  scene.replace(scene.find("\"ramp\""), 6, "\"stiction\"");
  write(folder / "scene.toml", scene);
  const CommandResult run = cdot_run(fmt::format("simulate '{}'", (folder / "scene.toml").string()));
  EXPECT_EQ(run.status, 2);
  for (const char* words :
       {"ramp.effect does not act on the coordinate of any joint", "[[joint]] type = \"ramp\" makes it act on bodies",
        "stiction.effect is an effect on the coordinate of a joint", "name it there: angle.stiction = {"})
    EXPECT_NE(run.err.find(words), std::string::npos) << words << "\n" << run.err;
}

// A weight of 20 N hangs on a cord whose strength of 100 N falls to nothing in 10 s: it breaks after 8 s.
constexpr const char* cord = R"(effect burning joint
  "A cord that burns, until what is left of its strength is too little."
  scalar strength [J/any] above 0
  scalar life [s] above 0
  bond: joint, until load(bond) >= strength*(1 - time/life)
)";
constexpr const char* weight = R"(duration = 9
solver = "direct"
step = 0.01
gravity = [0, -10]
[[body]]
name = "weight"
mass = 2
inertia = 0.1
position = [0, -1]
[[joint]]
type = "distance"
bodies = ["weight", "world"]
pa = [0, 0]
pb = [0, 0]
burning = { strength = 100, life = 10 }
)";

TEST(OwnTypes, AJointBreaksByASpecOfItsOwn) {
  const TemporaryFolder folder;
  write(folder / "burning.effect", cord);
  write(folder / "scene.toml", weight);
  const std::string scene = folder / "scene.toml", csv_path = folder / "run.csv";
  const CommandResult run = cdot_run(fmt::format("simulate '{}' -o '{}'", scene, csv_path));
  ASSERT_EQ(run.status, 0) << run.out << run.err;
  EXPECT_NE(run.out.find("broken          \"joint1\""), std::string::npos) << run.out;
  double t = 0, x = 0, y = 0;
  ASSERT_EQ(std::sscanf(last_line(csv_path).c_str(), "%lf,%lf,%lf", &t, &x, &y), 3);
  EXPECT_NEAR(y, -1 - 5 * 1 * 1, 0.11);  // falls for a second, less a step
}

TEST(OwnTypes, AnEffectOnACoordinateIsNoneOfTheJoint) {
  const TemporaryFolder folder;
  write(folder / "burning.effect", stiction);
  write(folder / "scene.toml", weight);
  const CommandResult run = cdot_run(fmt::format("simulate '{}'", (folder / "scene.toml").string()));
  EXPECT_EQ(run.status, 2);
  EXPECT_NE(run.err.find("burning.effect acts on a coordinate of a joint"), std::string::npos) << run.err;
}

}  // namespace
}  // namespace cdot::test::own_types_test
