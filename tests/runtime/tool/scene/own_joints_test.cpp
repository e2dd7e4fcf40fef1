// Scenes whose joints are specs beside them, derived when the scene is read.
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>

#include "tests/runtime/tool/support.hpp"

namespace cdot::test::own_joints_test {
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

TEST(OwnJoints, OfAFileBesideTheScene) {
  const TemporaryFolder folder;
  write(folder / "bead_on_ellipse.joint", ellipse);
  for (const char* type : {"bead_on_ellipse", "bead_on_ellipse.joint"}) {
    write(folder / "scene.toml", scene_of(type));
    const std::string scene = folder / "scene.toml", csv_path = folder / "run.csv";
    const CommandResult run = cdot_run(fmt::format("simulate '{}' -o '{}'", scene, csv_path));
    ASSERT_EQ(run.status, 0) << run.out << run.err;
    std::ifstream csv(csv_path);
    std::string line, last;
    while (std::getline(csv, line)) last = line;
    double t = 0, x = 0, y = 0;
    ASSERT_EQ(std::sscanf(last.c_str(), "%lf,%lf,%lf", &t, &x, &y), 3);
    EXPECT_NEAR(x * x / 4 + y * y, 1, 1e-6);
    EXPECT_LT(y, 0.5);
  }
}

TEST(OwnJoints, MistakesOfTheSpecAreShownWithTheirLines) {
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

TEST(OwnJoints, OfTheOtherSpaceAreRefused) {
  const TemporaryFolder folder;
  std::string spatial = ellipse;
  spatial.replace(spatial.find("planar"), 6, "spatial");
  write(folder / "bead_on_ellipse.joint", spatial);
  write(folder / "scene.toml", scene_of("bead_on_ellipse"));
  const CommandResult run = cdot_run(fmt::format("simulate '{}'", (folder / "scene.toml").string()));
  EXPECT_EQ(run.status, 2);
  EXPECT_NE(run.err.find("is a joint in space, and this scene is planar"), std::string::npos) << run.err;
}

}  // namespace
}  // namespace cdot::test::own_joints_test
