// Searches for a method that are in vain: they end soon, and advise nothing that they have tried.
#include <gtest/gtest.h>

#include "runtime/tool/search/advice.hpp"
#include "runtime/tool/search/simulate.hpp"
#include "tests/runtime/tool/support.hpp"

namespace cdot::test::in_vain_test {
namespace {

// Gas in a cylinder between two bodies that meet at t = 0.11 s: no method passes that pose, and no step.
constexpr const char* cylinder_that_closes = R"(
dimension = 3
gravity = [0, 0, 0]
duration = 0.18
project = true
[[body]]
name = "b1"
mass = 0.027
inertia = [[0.0096, -0.0013, -0.0019], [-0.0013, 0.011, -0.0026], [-0.0019, -0.0026, 0.0073]]
position = [0.5, -1.6, -0.84]
orientation = [0.043, 0.84, 0.53, 0.13]
velocity = [2.5, -1.9, 2.1]
spin = [2, 0.5, -1.9]
[[body]]
name = "b2"
mass = 1.4
inertia = [[0.054, -0.012, -0.02], [-0.012, 0.059, -0.0036], [-0.02, -0.0036, 0.034]]
position = [-1.9, -1.2, 0.52]
orientation = [0.061, -0.76, 0.56, 0.32]
velocity = [-0.18, 0.37, 2.2]
spin = [-2.2, -0.032, 1.1]
[[joint]]
name = "j1"
type = "surface"
bodies = ["b1", "b2"]
pa = [0.17, 0.42, 0.19]
pb = [0.15, -0.11, 0.11]
fa = [[0.46, 0.58, 0.67], [0.89, -0.3, -0.35]]
height = 0.8
k = -2.5
x.gas_spring = { F = 4.4 }
)";

// Fixed steps that fail were made shorter up to 2^20 of them, at 4e6 evaluations and 3 s of CPU time.
TEST(SearchInVain, EndsSoonWhereEveryMethodFails) {
  const Scene scene = read_scene(cylinder_that_closes, "cylinder.toml");
  std::string warnings;
  const RunResult result = simulate(scene, {}, warnings);
  ASSERT_TRUE(result.choice);
  EXPECT_FALSE(result.choice->reached);
  EXPECT_TRUE(result.failed_step);
  EXPECT_GT(result.time, 0.1);
  EXPECT_LE(result.choice->runs_before, 24);
  EXPECT_LE(result.choice->evaluations + result.choice->evaluations_before, 200000);
}

// An accuracy of 1e-5 is no cure where 1e-4 was not reached: the search itself went further. The scene says project.
TEST(SearchInVain, AdvisesNoFinerAccuracy) {
  const Scene scene = read_scene(cylinder_that_closes, "cylinder.toml");
  std::string warnings;
  RunResult result = simulate(scene, {}, warnings);
  ASSERT_TRUE(needs_advice(scene, result));
  result.advice = find_advice(scene, {}, result);
  EXPECT_FALSE(result.advice);
  const std::string why = failure(scene, result);
  EXPECT_EQ(why.find("Tried"), std::string::npos) << why;
  EXPECT_NE(why.find("Likely fix: an earlier end (--until)"), std::string::npos) << why;
}

Scene hard_case(const std::string& name) {
  Scene scene = read_scene((source_dir() / "tests/hard_cases" / name).string());
  scene.settings.integrator = Integrator::rattle;
  return scene;
}

std::vector<std::string> tried_for(const Scene& scene, double most_work) {
  std::string warnings;
  const RunResult result = simulate(scene, {}, warnings);
  EXPECT_TRUE(needs_advice(scene, result));
  const std::optional<TriedFix> advice = find_advice(scene, {}, result);
  EXPECT_LT(advice.value().work, most_work);
  return advice->tried;
}

// Each trial of dop853 took the 4e6 that a trial may, three times: with that it passes a fifth of the run. Steps of
// RATTLE are the run's own, and the start satisfies the joint.
TEST(TrialsInVain, EndByTheirForeseenPriceAndComeOnce) {
  const std::vector<std::string> tried = {"--integrator implicit", "--step 0.00833333",
                                          "--integrator dop853 --local-error 1e-06",
                                          "--integrator dop853 --local-error 1e-09", "--step 0.00208333"};
  EXPECT_EQ(tried_for(hard_case("stiff_servo/planar.toml"), 2e6), tried);
}

// A run that is off is compared with a finer one, which costs no less. So this trial ends after 2e6 of the 4e6 that it
// may take.
TEST(TrialsInVain, LeaveHalfOfTheirWorkToAFinerRun) { tried_for(hard_case("stick_slip/planar.toml"), 3e6); }

RunResult tried_out(const Scene& scene, double most_evaluations) {
  RunOptions options;
  options.is_trial = true;
  options.most_evaluations = most_evaluations;
  std::string warnings;
  return run_once(scene, options, warnings);
}

// The joints are open by a metre at the start.
TEST(TrialsInVain, EndWhereTheyFail) {
  const RunResult result = tried_out(hard_case("stretched_chain/planar.toml"), 1e9);
  EXPECT_TRUE(result.stopped);
  EXPECT_EQ(result.steps, 0);
}

// The estimate of the trajectory passes its bound long before the end.
TEST(TrialsInVain, EndWhereTheyWarn) {
  const Scene scene = hard_case("stiff_servo/planar.toml");
  const RunResult result = tried_out(scene, 1e9);
  EXPECT_TRUE(result.stopped);
  EXPECT_LT(result.time, scene.duration / 2);
}

// The energy of an oscillation swings by steps of Euler's method, by more than the tolerance from the first turn on.
TEST(TrialsInVain, EndWhereTheyHaveLostTheirEnergy) {
  Scene scene = read_scene(
      "duration = 100\nstep = 0.1\nintegrator = \"euler\"\ngravity = [0, 0]\nenergy_tolerance = 0.01\n"
      "trajectory_tolerance = 1e9\n[[body]]\nname = \"bob\"\nmass = 1\ninertia = 1\nposition = [2, 0]\n"
      "[[spring]]\nbodies = [\"world\", \"bob\"]\nstiffness = 9\nrest = 1\n",
      "spring.toml");
  const RunResult result = tried_out(scene, 1e9);
  EXPECT_TRUE(result.stopped);
  EXPECT_NEAR(result.time, scene.duration / 10, 5);
}

}  // namespace
}  // namespace cdot::test::in_vain_test
