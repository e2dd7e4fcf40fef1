// Bounds on the cost of searches and trials, in evaluations and solves: no clock decides.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "runtime/state/world_data.hpp"
#include "runtime/tool/search/advice.hpp"
#include "runtime/tool/search/work.hpp"
#include "tests/runtime/tool/support.hpp"

namespace cdot::test::budgets_test {
namespace {

// A plate that hangs from the world, with fingers of two links below. They rattle between their limits, and the damper
// of the first one decays at 1e5 1/s. With a motor that shakes the plate they go on for ever.
Scene rattling_fingers(int fingers, const char* method, const char* motor = "") {
  std::string text = fmt::format(
      "duration = 1\n{}\n"
      "[[body]]\nname = \"plate\"\nmass = 10\ninertia = 1\nposition = [0.5, -0.2]\n"
      "[[joint]]\ntype = \"revolute\"\nbodies = [\"world\", \"plate\"]\nat = [0, 0]\n{}\n",
      method, motor);
  const auto add = [&](const std::string& above, const std::string& link, double mass, double x, double y, double half,
                       double damping) {
    text += fmt::format(
        "[[body]]\nname = \"{1}\"\nmass = {2}\ninertia = {3}\nposition = [{4}, {5}]\n"
        "[[joint]]\ntype = \"revolute\"\nbodies = [\"{0}\", \"{1}\"]\nat = [{4}, {6}]\n"
        "angle.limit = {{ lower = -0.05, upper = 0.05 }}\n"
        "angle.spring = {{ stiffness = 0, damping = {7} }}\n",
        above, link, mass, mass * half * half / 3, x, y - half, y, damping);
  };
  for (int k = 0; k < fingers; ++k) {
    const double x = 0.1 * k, half = 0.05 + 0.002 * k, damping = k == 0 ? 1 : 1e-4;
    add("plate", fmt::format("upper{}", k), 0.01, x, -0.2, half, damping);
    add(fmt::format("upper{}", k), fmt::format("lower{}", k), 0.0025, x, -0.2 - 2 * half, half, damping);
  }
  return read_scene(text, "fingers.toml");
}

// Each impact costs collocation two evaluations for each component of velocity. It ends after a little work, and fixed
// steps go on; explicit ones, which the damper makes as dear, are not tried. All of these took 1e6 evaluations.
TEST(Budgets, OfCollocationEndWhereImpactsMakeItDear) {
  const Scene scene = rattling_fingers(12, "", "angle.motor = { speed = \"20 [rad/s] * sin(time / 0.001 [s])\" }");
  std::string warnings;
  const RunResult result = simulate(scene, {}, warnings);
  const Choice& choice = result.choice.value();
  EXPECT_FALSE(choice.reached);
  EXPECT_TRUE(choice.ended_by_budget);
  EXPECT_EQ(choice.integrator, Integrator::implicit);
  EXPECT_NEAR(result.time, 1, 1e-9);
  EXPECT_LE(static_cast<double>(choice.evaluations + choice.evaluations_before), 7e6 / work_of_evaluation(scene));
  EXPECT_NE(summary_text(scene, result).find("the search ended at its budget, after "), std::string::npos);
}

// The search has measured two runs by then, and the third one costs little more than twice as much as the second.
TEST(Budgets, GrowForARunThatPromisesToBeTheLast) {
  const Scene scene = read_scene((source_dir() / "tests/runtime/tool/search/slack_bridge.toml").string());
  std::string warnings;
  const auto with_budget = [&](double evaluations) {
    RunOptions options;
    options.search_work = evaluations * work_of_evaluation(scene);
    return simulate(scene, options, warnings).choice.value();
  };
  const Choice whole = with_budget(1e7);
  // The first run and the last one are repeated, for their round-off, beside the budget.
  const auto before = static_cast<double>(whole.evaluations_before - whole.evaluations);
  ASSERT_TRUE(whole.reached);
  const Choice bounded = with_budget(before);
  EXPECT_TRUE(bounded.reached);
  EXPECT_EQ(bounded.local_error, whole.local_error);
  EXPECT_FALSE(with_budget(0.4 * before).reached);  // two runs were not measured
}

// No joint is to blame where a run is too long for the search.
TEST(Budgets, OfLongRunsAreTold) {
  const Scene scene = read_scene(
      "duration = 1000\n[[body]]\nname = \"bob\"\nmass = 1\ninertia = 1\nposition = [1, 0]\n"
      "[[joint]]\nname = \"rod\"\ntype = \"distance\"\nbodies = [\"world\", \"bob\"]\npa = [0, 0]\npb = [0, 0]\nl = "
      "1\n",
      "long.toml");
  std::string warnings;
  RunOptions options;
  options.search_work = 4e4;
  const RunResult result = simulate(scene, options, warnings);
  EXPECT_TRUE(result.choice.value().ended_by_budget);
  const std::string text = failure(scene, result);
  EXPECT_NE(text.find("ended at its budget"), std::string::npos) << text;
  EXPECT_NE(text.find("--until"), std::string::npos) << text;
  EXPECT_EQ(text.find("joints that can follow"), std::string::npos) << text;
}

// Where rows press on each other, a step by fixed steps takes many factorisations. These count as evaluations do.
TEST(Budgets, CountTheSolvesOfFixedSteps) {
  const Scene scene = rattling_fingers(3, "integrator = \"implicit\"\nstep = 0.01");
  std::string warnings;
  RunOptions options;
  options.estimates_error = false;
  const RunResult whole = simulate(scene, options, warnings);
  EXPECT_FALSE(whole.stopped);
  EXPECT_EQ(whole.counts.evaluations, 0);
  ASSERT_GT(whole.solves, 200);
  EXPECT_EQ(work_of(scene, whole), work_of_evaluation(scene) * static_cast<double>(whole.solves));
  options.most_evaluations = 100;
  const RunResult bounded = simulate(scene, options, warnings);
  EXPECT_TRUE(bounded.stopped);
  EXPECT_GT(bounded.solves, 100);
  EXPECT_LT(bounded.time, whole.time / 2);
}

// A drive, a coupling and a slide that contradict each other: no load is found for the friction on the slide. The step
// has failed by then, and shorter parts of it are not tried. The scene is one of the torture's, and jams only with all
// its digits.
TEST(Budgets, StepsThatJamEndAtOnce) {
  const Scene scene = read_scene(std::string_view(R"(dimension = 3
duration = 0.003
step = 0.003
integrator = "implicit"
[[body]]
name = "b1"
mass = 3114238.8031857572
inertia = [[2.216e+06, 0, 0], [0, 2.216e+06, 0], [0, 0, 2.216e+06]]
position = [-0.9128, -1.937, 1.5]
orientation = [0.03227, 0.656, 0.07226, -0.7506]
[[body]]
name = "b2"
mass = 601.3
inertia = [[139.3, 0.6572625302565687, -18.459233886781345],
           [0.6572625302565687, 202.5, 49.52855929591464], [-18.459233886781345, 49.52855929591464, 225.6]]
position = [0.3531, 0.3322001194365016, 0.2846]
orientation = [-0.6774, 0.6556, 0.297, -0.152]
[[joint]]
name = "j2"
type = "point_on_plane"
bodies = ["b2", "b1"]
fa = [[-0.4517, -0.889, -0.07522], [-0.03407, -0.0670567053013465, 0.9971672077068311]]
pa = [0.2786, -0.0856, 0.1153]
slide_y.tearing_rope = { strength = 3.474e+04 }
slide_z.rail_friction = { mu = 2.251 }
[[joint]]
name = "j18"
type = "driven"
bodies = ["b1", "b2"]
pa = [0.06664, 0.3775, 0.3225]
fa = [[-0.40157330488570014, -0.6986, -0.5922], [0.9158, -0.3063060329958574, -0.2597]]
rate = 1.4716238008733662
[[joint]]
name = "j20"
type = "constant_velocity"
bodies = ["b1", "b2"]
pa = [-0.1515, -0.23032321442975656, 0.2386]
fa = [[0.7609, 0.3903, 0.5184], [-0.3226, 0.9207, -0.2198]]
)"),
                                 "jams.toml");
  auto world = build_world_in<Spatial<double>>(scene);
  EXPECT_EQ(world.step(0.003).problem, StepProblem::jams);
  fmt::print("  {} solves\n", world.data().solves);
  EXPECT_LT(world.data().solves, 1500);
}

// The same in a search: its first run takes 16 steps of `implicit`, and is stopped.
TEST(Budgets, PriceFixedStepsByTheirSolves) {
  std::string warnings;
  RunOptions options;
  options.most_evaluations = 200;
  const RunResult result = simulate(rattling_fingers(12, ""), options, warnings);
  const Choice& choice = result.choice.value();
  EXPECT_EQ(choice.integrator, Integrator::implicit);
  EXPECT_EQ(choice.runs_before, 0);
  EXPECT_TRUE(result.stopped);
  EXPECT_GT(choice.evaluations, 200);
}

// Joints alone as well: a step that is too long is taken in parts, and each part solves by Newton's method. A factor of
// ten joints with their tensions costs more than an evaluation, so the search leaves `implicit` after its first run.
TEST(Budgets, CountTheSolvesOfJoints) {
  Scene scene = read_scene((source_dir() / "tests/hard_cases/heavy_load/spatial_beads.toml").string());
  scene.step = 0;  // a method by default
  std::string warnings;
  RunOptions options;
  options.estimates_error = false;
  const RunResult found = simulate(scene, options, warnings);
  ASSERT_TRUE(found.choice);
  EXPECT_TRUE(found.choice->reached);
  EXPECT_LE(found.choice->runs_before, 3);
  scene.settings.integrator = Integrator::implicit, scene.step = scene.duration / 16;
  const RunResult whole = simulate(scene, options, warnings);
  EXPECT_EQ(whole.counts.evaluations, 0);
  EXPECT_GT(whole.solves, 16 * 25);  // more than the most rounds of 16 whole steps
  EXPECT_GT(work_of(scene, whole), work_of_evaluation(scene) * 16 * 25);
}

// Twenty bodies on hinges, and twenty free ones: an evaluation is mostly that of the twenty.
TEST(Budgets, CountEvaluationsOfTheMeanBodysMechanism) {
  std::string text = "duration = 1\n";
  for (int k = 0; k < 40; ++k)
    text += fmt::format("[[body]]\nname = \"b{}\"\nmass = 1\ninertia = 1\nposition = [{}, 0]\n", k, k);
  for (int k = 1; k < 20; ++k)
    text += fmt::format("[[joint]]\ntype = \"revolute\"\nbodies = [\"b{}\", \"b{}\"]\nat = [{}, 0]\n", k - 1, k, k);
  const Scene scene = read_scene(text, "twenty.toml");
  const double of_one = overhead + (20 * 20 + 20 * 1) / 40.0, of_all = overhead * 21 + 40;
  EXPECT_EQ(work_of_evaluation(scene), of_one);
  EXPECT_EQ(evaluations_of_all(scene), of_all / of_one);
}

// Runs of a search are judged by each other. An estimate of their error would cost half as much again.
TEST(Budgets, PayForNoEstimateInASearch) {
  const Scene scene = scene_named("pulley_ratio1");
  std::string warnings;
  const RunResult found = simulate(scene, {}, warnings);
  ASSERT_TRUE(found.choice.value().reached);
  EXPECT_EQ(found.error.samples, 0);
  EXPECT_GT(simulate(solved_by(*found.choice, scene), {}, warnings).error.samples, 0);
}

// A trial gets less than the search had.
TEST(Budgets, LeaveNoTrialsAfterASearchThatTookItsOwn) {
  const Scene scene = rattling_fingers(1, "");
  RunResult result;
  result.finite = false;  // so that it fails
  result.choice.emplace().reached = true;
  result.time = 1;
  EXPECT_FALSE(find_advice(scene, {}, result).value().tried.empty());
  result.choice->ended_by_budget = true;
  EXPECT_FALSE(find_advice(scene, {}, result));
}

// Rods stand still. Pins, brakes and a rope share loads by round-off: nothing that shorter steps would resolve.
TEST(Budgets, OfWhatStandsStillAreSmall) {
  std::string text = "gravity = [0, 0]\nduration = 1.5\n";
  const auto add_rod = [&](int k, double mass, const char* effects) {
    text += fmt::format(
        "[[body]]\nname = \"rod{0}\"\nmass = {1}\nshape = {{ rod = 1 }}\nposition = [{0}.5, 0]\n"
        "[[joint]]\ntype = \"revolute\"\nbodies = [\"{2}\", \"rod{0}\"]\nat = [{0}, 0]\n{3}\n",
        k, mass, k == 0 ? "world" : fmt::format("rod{}", k - 1), effects);
  };
  add_rod(0, 2, "angle.shear_pin = { strength = 0.5 }");
  add_rod(1, 5,
          "angle.shear_pin = { strength = 2 }\nangle.bearing_friction = { most = 0.5, creep = 0.5 }\n"
          "angle.freewheel = {}\nangle.spring = { stiffness = 50, damping = 0 }");
  add_rod(2, 2,
          "angle.shear_pin = { strength = 20 }\nangle.air_brake = { torque = 0.5, rise = 0.5 }\n"
          "angle.spindle = { speed = 2.75, ramp = 0.1, most = 1 }");
  text +=
      "[[joint]]\ntype = \"tearing_rope\"\nbodies = [\"rod0\", \"rod1\"]\npa = [0.1, 0]\npb = [0.5, 0]\n"
      "strength = 60\n";
  std::string warnings;
  const RunResult result = simulate(read_scene(text, "at_rest.toml"), {}, warnings);
  ASSERT_TRUE(result.choice.value().reached);
  const auto evaluations = result.choice->evaluations + result.choice->evaluations_before;
  fmt::print("  {} evaluations\n", evaluations);
  EXPECT_LT(evaluations, 1e4);
}

}  // namespace
}  // namespace cdot::test::budgets_test
