// Every integrator on every problem with a known solution: the error falls with the method's order, also for rotations
// in space, down to the reference's own error.
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cdot/effects.hpp>
#include <cdot/methods.hpp>

#include "tests/runtime/tool/run/heavy_load.hpp"
#include "tests/runtime/tool/support.hpp"

namespace cdot::test::integrators_test {
namespace {

struct Problem {
  const char* scene;
  double until;  // [s]
  // The coarsest steps for methods of second, fourth, fifth and eighth order [s]; 0: no step shows the order.
  double coarse2 = 0, coarse4 = 0, coarse5 = 0, coarse8 = 0;

  double coarsest(int order) const {
    return order == 2 ? coarse2 : order == 4 ? coarse4 : order == 5 ? coarse5 : coarse8;
  }
};

struct Case {
  Problem problem;
  Integrator integrator;
  double step;
  double least_slope;
};

double least_slope(int order) { return order == 2 ? 1.9 : 0.875 * order; }

// Slopes are taken between errors below this, where they follow the order.
constexpr double small_enough = 1e-2;

// The name of a scene's file and of its reference.
std::string name_of(const Problem& problem) { return std::filesystem::path(problem.scene).filename().string(); }

std::string name_of_case(const testing::TestParamInfo<Case>& info) {
  return fmt::format("{}_{}", name_of(info.param.problem), name_of(integrators, info.param.integrator));
}

// Integrators of second and higher order.
std::vector<Integrator> higher_orders() {
  std::vector<Integrator> found;
  for (const IntegratorRow& row : integrator_rows)
    if (row.order > 1) found.push_back(row.integrator);
  return found;
}

std::vector<Case> all_cases() {
  const Problem problems[] = {
      {"simple_pendulum", 10, 0.01, 0.05, 0.05, 0.25}, {"compound_pendulum", 10, 0.01, 0.05, 0.05, 0.25},
      {"double_pendulum", 2, 0.01, 0.02, 0.02, 0.125}, {"four_bar", 0.5, 0.00625, 0.0125, 0.05},
      {"slider_crank", 0.2, 1e-4, 4e-4, 4e-4, 2e-3},   {"spatial/torque_free_body", 20, 0.02, 0.1, 0.2, 0.4},
  };
  std::vector<Case> cases;
  for (const Problem& problem : problems)
    for (const Integrator integrator : higher_orders()) {
      const int order = row_of(integrator).order;
      if (problem.coarsest(order) > 0)
        cases.push_back({problem, integrator, problem.coarsest(order), least_slope(order)});
    }
  return cases;
}

void PrintTo(const Problem& problem, std::ostream* out) { *out << problem.scene; }

class Orders : public testing::TestWithParam<Case> {};

// Takes the slope of the two finest steps whose errors are well above round-off and the reference's error.
TEST_P(Orders, AreThoseOfTheMethod) {
  const auto& [problem, integrator, coarsest, least_slope] = GetParam();
  Scene scene = scene_named(problem.scene);
  scene.settings.integrator = integrator;
  const Reference reference = read_reference(name_of(problem), problem.until);
  double before = 0, last = 0;
  for (int halvings = 0; halvings < 5; ++halvings) {
    scene.step = coarsest / (1 << halvings);
    const double now = distance_to(reference, scene).largest();
    const double slope = halvings > 0 ? std::log2(before / now) : 0;
    fmt::print("  h = {:.4e}  off by {:.3e} m or rad  slope {:.2f}\n", scene.step, now, slope);
    if (now > std::max(20 * reference.accuracy, 1e-12) && before < small_enough) last = slope;
    before = now;
  }
  EXPECT_GT(last, least_slope);
}

INSTANTIATE_TEST_SUITE_P(Problems, Orders, testing::ValuesIn(all_cases()), name_of_case);

// Until its rank drops the four-bar moves so smoothly that steps of a tenth of the run are exact to round-off.
TEST(Orders, OfTheEighthOrderTheFourBarSeesOnlyRoundOff) {
  Scene scene = scene_named("four_bar");
  scene.settings.integrator = Integrator::dop853;
  scene.step = 0.05;
  const Reference reference = read_reference("four_bar", 0.5);
  EXPECT_LT(distance_to(reference, scene).largest(), 10 * reference.accuracy);
}

// Constant acceleration gives a parabola, which methods of second and higher order follow to round-off at every step.
TEST(Orders, FromTheSecondOnThePulleysSeeOnlyRoundOff) {
  for (const char* name : {"pulley_ratio1", "pulley_ratio2"})
    for (const Integrator integrator : higher_orders()) {
      Scene scene = scene_named(name);
      scene.settings.integrator = integrator;
      scene.step = 0.1;
      const double off = distance_to(read_reference(name, 1), scene).largest();
      fmt::print("  {}, {}: off by {:.1e} m, rad or their rates\n", name, name_of(integrators, integrator), off);
      EXPECT_LT(off, 1e-12);
    }
}

// `accuracy` in a scene: the chosen method reaches it, compared with the problem's own reference.
class Asked : public testing::TestWithParam<std::tuple<Problem, double>> {};

TEST_P(Asked, IsReached) {
  const auto& [problem, accuracy] = GetParam();
  Scene scene = scene_named(problem.scene);
  scene.accuracy = accuracy;
  const Reference reference = read_reference(name_of(problem), problem.until);
  const Distance distance = distance_to(reference, scene);
  fmt::print("  asked {:.0e}, off by {:.2e} m, {:.2e} rad\n", accuracy, distance.position, distance.angle);
  EXPECT_LE(std::max(distance.position, distance.angle), accuracy + reference.accuracy);
}

INSTANTIATE_TEST_SUITE_P(
    Problems, Asked,
    testing::Combine(testing::Values(Problem{"simple_pendulum", 10}, Problem{"compound_pendulum", 10},
                                     Problem{"double_pendulum", 2}, Problem{"four_bar", 0.5},
                                     Problem{"slider_crank", 0.2}, Problem{"pulley_ratio1", 1},
                                     Problem{"pulley_ratio2", 1}, Problem{"spatial/torque_free_body", 10}),
                     testing::Values(1e-2, 1e-4, 1e-6, 1e-8, 1e-10)),
    [](const auto& info) {
      return fmt::format("{}_{:.0f}", name_of(std::get<0>(info.param)), -std::log10(std::get<1>(info.param)));
    });

// A million steps of RATTLE: the energy oscillates with the mechanism, but the mean of the last tenth equals that of
// the first. The parallelogram lies flat twice a turn, 3000 times in total. There J loses a rank, and the joints'
// directions reverse within one step.
class LongRun : public testing::TestWithParam<const char*> {};

TEST_P(LongRun, TheEnergyOfRattleDoesNotDrift) {
  Scene scene = scene_named(GetParam());
  scene.settings.integrator = Integrator::rattle;
  World<double> world = build_world<double>(scene);
  constexpr int tenth = 100'000;
  const double start = world.energy();
  double first = 0, last = 0, largest = 0;
  for (int tenths = 0; tenths < 10; ++tenths) {
    for (int k = 0; k < tenth; ++k) {
      world.step(1e-3);
      if (tenths > 0 && tenths < 9) continue;
      const double off = world.energy() - start;
      (tenths == 0 ? first : last) += off / tenth;
      largest = std::max(largest, std::abs(off));
    }
  }
  fmt::print("  energy off by at most {:.2e} J, on average {:.6e} J at first, {:.6e} J at last\n", largest, first,
             last);
  EXPECT_LT(largest, 1e-3);
  EXPECT_LT(std::abs(last - first), 0.01 * largest);
  EXPECT_LT(world.worst_position_error().value, 1e-12);
  EXPECT_LT(world.worst_velocity_error().value, 1e-12);
}

INSTANTIATE_TEST_SUITE_P(OfAMillionSteps, LongRun, testing::Values("crank_rocker", "four_bar"),
                         [](const auto& info) { return std::string(info.param); });

// A chain of ten links of 1 kg with a load of 1e3 or 1e6 kg at its end, after a transverse kick. The midpoint
// rule, which is stable at 1/60 s (tests/hard_cases/heavy_load), converges at second order.
void converges(bool beads) {
  for (const double load : {1e3, 1e6}) {
    double x[4];
    for (int k = 0; k < 4; ++k) {
      World<double> world({.integrator = Integrator::implicit, .gravity_y = -9.81});
      const int end = hang_load(world, beads, load);
      for (int step = 0; step < 2 * (240 << k); ++step) world.step(1.0 / (240 << k));
      x[k] = world.pose(end).x;
    }
    const double order = std::log2((x[1] - x[2]) / (x[2] - x[3]));
    fmt::print("  {:.0e} kg: x = {:.6f} {:.6f} {:.6f} {:.6f} m, order {:.2f}\n", load, x[0], x[1], x[2], x[3], order);
    // Beside the lighter load, the kick leaves waves in the chain that are too fast for these steps.
    if (load > 1e5) EXPECT_NEAR(order, 2, 0.2);
    else EXPECT_LT(std::abs(x[0] - x[3]), 1e-5);
  }
}
TEST(HeavyLoad, OnALightChainConverges) { converges(false); }
TEST(HeavyLoad, OnBeadsConverges) { converges(true); }

// A rope of 1 m between a body and the ground above it, slack at first. The rope becomes taut at a known time and stops
// the fall. Fixed and adaptive steps find that time.
TEST(Events, ARopeGoesTautInTime) {
  for (const Integrator integrator : {Integrator::rk4, Integrator::dop853, Integrator::radau5}) {
    World<double> world({.integrator = integrator, .gravity_y = -9.81});
    const int ball = world.add_body({.y = -0.5, .mass = 2, .inertia = 0.1});
    world.add_joint({"max_distance", {world.ground(), ball}, {{"pa", {0, 0}}, {"pb", {0, 0}}, {"l", {1.0}}}, {}});
    const double taut = std::sqrt(2 * 0.5 / 9.81);
    world.step(0.75 * taut);
    EXPECT_NEAR(world.velocity(ball).y, -9.81 * 0.75 * taut, 1e-12);
    world.step(0.5 * taut);
    EXPECT_NEAR(world.pose(ball).y, -1, 2e-9);
    EXPECT_NEAR(world.velocity(ball).y, 0, 1e-9);
    EXPECT_EQ(world.step_counts().events, 1);
  }
}

// A motor of bounded force pushes a block on a slide: constant acceleration up to the motor's speed, then constant
// speed. The position has a closed form.
TEST(Events, AMotorReachesItsSpeed) {
  for (const Integrator integrator : {Integrator::rk4, Integrator::dop853, Integrator::radau5}) {
    World<double> world({.integrator = integrator});
    const int block = world.add_body({.mass = 2, .inertia = 0.1});
    const int slide = world.add_joint({"prismatic", {block, world.ground()}, {{"pa", {0, 0}}, {"t", {0, 1}}}, {}});
    add_motor(world, slide, "slide", {.speed = 1.5, .max_force = 6});
    for (int k = 0; k < 7; ++k) world.step(0.1);
    // 3 m/s^2 for 0.5 s, then 0.2 s at 1.5 m/s
    EXPECT_NEAR(std::abs(world.pose(block).x), 0.5 * 3 * 0.25 + 1.5 * 0.2, 1e-8);
    EXPECT_NEAR(std::abs(world.velocity(block).x), 1.5, 1e-9);
    EXPECT_EQ(world.step_counts().events, 1);
  }
}

// A slider whose motor pulls at a taut, slanting rope from the start stands, whatever the step. Where steps began with
// the impulse of the pressing motor, but without the rope's, RATTLE reached the limits and threw the slider to and fro.
TEST(Integrators, LeaveAMotorAtATautRopeStanding) {
  Scene scene = read_scene(R"(title = "pull"
duration = 1.5
[[body]]
name = "slider"
mass = 1
shape = { rod = 1 }
position = [0.5, 0]
[[joint]]
type = "prismatic"
bodies = ["world", "slider"]
at = [0, 0]
slide.motor = { speed = 1.27 }
slide.limit = { lower = -0.54, upper = 0.157 }
[[joint]]
type = "max_distance"
bodies = ["world", "slider"]
pa = [1.04, 0.9]
pb = [-0.2, 0]
)",
                           "pull.toml");
  scene.accuracy = 0;
  for (const Integrator integrator : {Integrator::rattle, Integrator::implicit})
    for (const double step : {0.03, 0.021875, 0.0217, 0.02, 0.01}) {
      scene.settings.integrator = integrator, scene.step = step;
      double far = 0;
      for (const Frame& frame : recorded(scene, step).rows) far = std::max(far, std::abs(frame.bodies[0].x - 0.5));
      EXPECT_LT(far, 1e-9) << name_of(integrators, integrator) << " " << step;
    }
}

// An arm whose motor of unlimited force has its rate all the time, beside limits far away: RATTLE is of second order.
TEST(Integrators, DriveAnArmAtTheirOrder) {
  Scene scene = read_scene(R"(title = "arm"
gravity = [0, -9.81]
duration = 2
[[body]]
name = "first"
mass = 1
shape = { rod = 1 }
position = [0.5, 0]
[[body]]
name = "second"
mass = 1
shape = { rod = 1 }
position = [1.5, 0]
[[joint]]
type = "revolute"
bodies = ["world", "first"]
at = [0, 0]
angle.motor = { speed = 1 }
angle.limit = { lower = -10, upper = 10 }
[[joint]]
type = "revolute"
bodies = ["first", "second"]
at = [1, 0]
)",
                           "arm.toml");
  scene.accuracy = 0, scene.settings.integrator = Integrator::rattle;
  double before = 0;
  for (const double step : {0.02, 0.01, 0.005}) {
    scene.step = step;
    const double off = true_error(scene).angle;
    fmt::print("  steps of {} s: off by {:.1e} rad\n", step, off);
    EXPECT_LT(off, 10 * step * step);
    if (before > 0) {
      EXPECT_NEAR(before / off, 4, 0.5);
    }
    before = off;
  }
}

}  // namespace
}  // namespace cdot::test::integrators_test
