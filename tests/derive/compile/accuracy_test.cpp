// `cdot-run accuracy` compiles a scene with the machine's compiler: the compiled step is a way beside the World's.
#include <cmath>
#include <cstdlib>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "runtime/tool/compiled/compiled_scenes.hpp"
#include "tests/derive/compile/beside_world.hpp"
#include "tests/derive/compile/command.hpp"

namespace cdot {
namespace {

Scene scene_at(const std::string& path) { return read_scene(std::string(CDOT_SOURCE_DIR) + "/" + path); }

std::vector<Way> ways_of(Integrator integrator) {
  std::vector<Way> ways;
  for (const Way& way : compiled_ways())
    if (way.integrator == integrator) ways.push_back(way);
  return ways;
}

const SceneCompiler compiler = {std::filesystem::path(CDOT).parent_path() / "cdot-compile",
                                CDOT_SOURCE_DIR "/runtime/include", 60};
const auto silent = [](const std::string&) {};

void expect_the_trajectory_of_a_world(const std::string& path, Integrator integrator) {
  const Scene scene = scene_at(path);
  std::vector<Way> ways = ways_of(integrator);
  ASSERT_EQ(ways.size(), 2u);
  const CompiledScenes compiled(scene, ways, compiler, silent);
  ASSERT_EQ(ways.size(), 2u) << compiled.left_out().front();
  const std::vector<double> times = equal_times(0.4, 4);
  const Knob knob{50, 0};  // steps of 2 ms: the gyroscope spins at 150 rad/s
  Way of_world = ways[0];
  of_world.lanes = 0;
  const Trajectory world = trajectory_of(scene, of_world, knob, times, {}, {}, true);
  const Trajectory alone = compiled.trajectory(ways[0], knob, times, {});
  const Trajectory in_lanes = compiled.trajectory(ways[1], knob, times, {});
  ASSERT_EQ(alone.frames.size(), times.size());
  ASSERT_EQ(in_lanes.frames.size(), times.size());
  for (std::size_t k = 0; k < times.size(); ++k) {
    EXPECT_LT(apart(alone.frames[k], world.frames[k], scene.dimension).larger(), 1e-10) << path << " " << times[k];
    EXPECT_EQ(apart(alone.frames[k], in_lanes.frames[k], scene.dimension).larger(), 0) << path << " " << times[k];
    EXPECT_NEAR(alone.frames[k].energy, world.frames[k].energy, 1e-9);
    for (std::size_t body = 0; body < scene.bodies.size(); ++body)
      EXPECT_NEAR(alone.frames[k].bodies[body].vx, world.frames[k].bodies[body].vx, 1e-9);
  }
  EXPECT_GT(apart(world.frames.back(), world.frames.front(), scene.dimension).larger(), 0.01) << "it moves";
  EXPECT_NEAR(alone.most_energy, world.most_energy, 1e-9);
  EXPECT_LT(alone.C, 1e-12);
  EXPECT_LT(alone.Cdot, 1e-11);
  EXPECT_GT(compiled.cpu(ways[1], knob, times, {}), 0);
}

TEST(CompiledWays, MoveAsAWorld) {
  expect_the_trajectory_of_a_world("specs/scenes/slider_crank.toml", Integrator::rk4);
  expect_the_trajectory_of_a_world("specs/scenes/spatial/gyroscope.toml", Integrator::rattle);
}

ShellResult accuracy(const std::string& scene, const std::string& options, const std::string& setting = {}) {
  return run(fmt::format("cd {} && {} {} accuracy {} --until 0.5 --rounds 1 -o $(mktemp -u) {}", CDOT_SOURCE_DIR,
                         setting, CDOT_RUN_PROGRAM, scene, options));
}

TEST(CompiledWays, StandInTheReport) {
  const std::string scene = "specs/scenes/double_pendulum.toml";
  const auto json = nlohmann::json::parse(accuracy(scene, "--only rk4 --levels 3 --json").text);
  double error[9] = {};
  for (const auto& point : json["points"])
    if (point["step"] == 0.5 / 16 / 2 && point["precision"] == "double" && point["solver"] == "direct")
      error[point["lanes"].get<int>()] = point["error"];
  EXPECT_GT(error[0], 0);
  EXPECT_NEAR(error[1], error[0], 1e-12);
  EXPECT_EQ(error[8], error[1]);
  for (const auto& advice : json["advice"]) EXPECT_EQ(json["points"][advice["point"].get<int>()]["lanes"], 0);
  ASSERT_FALSE(json["compiled"].empty());
  for (const auto& compiled : json["compiled"]) {
    const auto& point = json["points"][compiled["point"].get<int>()];
    EXPECT_EQ(point["lanes"], compiled["lanes"]);
    EXPECT_LE(point["error"], compiled["error"]);
  }
  const std::string text = accuracy(scene, "--only rk4 --levels 3").text;
  EXPECT_NE(text.find("compiled: `cdot compile double_pendulum.toml --integrator … --step …`, then "),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("1e-1   rk4, direct, compiled, step 0.03125 s: "), std::string::npos) << text;
  EXPECT_NE(text.find("; each of 8 lanes: "), std::string::npos) << text;
}

TEST(CompiledWays, AreLeftOutWithAReason) {
  const std::string pendulum = "specs/scenes/simple_pendulum.toml";
  const ShellResult none = accuracy(pendulum, "--only rk4 --levels 2", "CXX=/no/such/compiler");
  EXPECT_EQ(none.status, 0) << none.text;
  EXPECT_NE(none.text.find("not compiled\n    there is no compiler /no/such/compiler. Fix: install g++, or set CXX\n"),
            std::string::npos)
      << none.text;
  const ShellResult only = accuracy(pendulum, "--only compiled", "CXX=/no/such/compiler");
  EXPECT_EQ(only.status, 2);
  EXPECT_NE(only.text.find("no way is left: there is no compiler /no/such/compiler. Fix: install g++, or set CXX"),
            std::string::npos)
      << only.text;
  const std::string triangle = "tests/hard_cases/incompatible_triangle/planar.toml";
  const ShellResult misfit = accuracy(triangle, "--only 'rk4, direct' --levels 2");
  EXPECT_NE(misfit.text.find("not compiled\n    rk4: "), std::string::npos) << misfit.text;
  EXPECT_NE(misfit.text.find("planar.toml:27:1: error: ab: cdot compile knows no joints that contradict each other"),
            std::string::npos)
      << misfit.text;
}

TEST(CompiledWays, TheCompilerHasABound) {
  const Scene scene = scene_at("specs/scenes/chain_10.toml");
  std::vector<Way> ways = ways_of(Integrator::dop853);
  const CompiledScenes compiled(scene, ways, {compiler.program, compiler.include, 0.01}, silent);
  EXPECT_TRUE(ways.empty());
  ASSERT_EQ(compiled.left_out().size(), 1u);
  EXPECT_NE(compiled.left_out()[0].find("takes more than 1 s of CPU time. Fix: a larger --budget"), std::string::npos)
      << compiled.left_out()[0];
}

}  // namespace
}  // namespace cdot
