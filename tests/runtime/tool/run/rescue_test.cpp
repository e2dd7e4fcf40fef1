// The midpoint rule replaces Runge-Kutta steps with meaningless errors, and a count reports it: no run
// explodes or hangs.
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "runtime/tool/run/trajectory.hpp"
#include "tests/runtime/tool/run/heavy_load.hpp"
#include "tests/runtime/tool/support.hpp"

namespace cdot::test::rescue_test {
namespace {

constexpr Integrator methods[] = {Integrator::rk4, Integrator::dop853, Integrator::radau5};

class Rescue : public testing::TestWithParam<std::tuple<Integrator, double>> {};

// On rods or on beads.
class RescueOfALoad : public testing::TestWithParam<std::tuple<Integrator, double, bool>> {};

TEST_P(RescueOfALoad, DoesNotExplode) {
  const auto& [integrator, local_error, beads] = GetParam();
  World<double> world({.integrator = integrator, .local_error = local_error, .gravity_y = -9.81});
  hang_load(world, beads, 1e6);
  const double start = world.energy(), kick = 0.5e6;
  double gained = 0, gap = 0;
  for (int k = 0; k < 60; ++k) {
    world.step(1.0 / 60);
    gained = std::max(gained, world.energy() - start);
    gap = std::max(gap, world.worst_position_error().value);
  }
  const StepCounts& counts = world.step_counts();
  fmt::print("  gained {:.1e} of the kick's energy, gap {:.1e} m, {} steps left to an implicit method\n", gained / kick,
             gap, counts.rescued);
  EXPECT_LT(gained, 0.01 * kick);
  EXPECT_LT(gap, 1e-3);
  EXPECT_EQ(counts.rescued > 0, local_error == 0);
}

// A weight is pulled up to and through the wheel of its pulley: there the rope has no direction and then jams.
TEST_P(Rescue, ARopeJamsInItsPulley) {
  const auto& [integrator, local_error] = GetParam();
  World<double> world({.integrator = integrator, .local_error = local_error, .gravity_y = -9.81});
  const int heavy = world.add_body({.x = -1, .y = 5, .mass = 2, .inertia = 0.4});
  const int light = world.add_body({.x = 1, .y = 9.8, .mass = 1, .inertia = 0.2});
  world.add_joint({"pulley", {heavy, light}, {{"pa", {0, 0}}, {"pb", {0, 0}}, {"ga", {-1, 10}}, {"gb", {1, 10}}}, {}});
  const double start = world.energy();
  double gained = 0;
  for (int k = 0; k < 60; ++k) {
    world.step(1.0 / 60);
    gained = std::max(gained, world.energy() - start);
  }
  const StepCounts& counts = world.step_counts();
  fmt::print("  gained {:.1e} J, {} steps left to an implicit method, {} taken\n", gained, counts.rescued,
             counts.taken);
  EXPECT_LT(gained, 1e-3 * 2 * 9.81);
  EXPECT_GT(counts.rescued, 0);
  EXPECT_LT(counts.taken, 100'000);
}

// A motor of unlimited force turns a rod that a bar to the ground blocks. The motor alone misses its rate: the rod
// stays where the bar holds it, and no step falls back to the midpoint rule.
TEST_P(Rescue, AMotorTurnsAgainstABar) {
  const auto& [integrator, local_error] = GetParam();
  World<double> world({.integrator = integrator, .local_error = local_error, .gravity_y = -9.81});
  const int rod = world.add_body({.x = 1, .mass = 1, .inertia = 0.1});
  const int hinge = world.add_joint({"revolute", {world.ground(), rod}, {{"pa", {0, 0}}, {"pb", {-1, 0}}}, {}});
  world.add_joint({"distance", {world.ground(), rod}, {{"pa", {2, -1}}, {"pb", {1, 0}}, {"l", {1}}}, {}});
  add_motor(world, hinge, "angle", {.speed = 1});
  constexpr int steps = 60;
  for (int k = 0; k < steps; ++k) world.step(1.0 / 60);
  const StepCounts& counts = world.step_counts();
  const double gap = world.worst_position_error().value;
  fmt::print("  gap {:.1e} m, {} evaluations, {} of {} steps left to an implicit method\n", gap, counts.evaluations,
             counts.rescued, steps);
  EXPECT_EQ(counts.rescued, 0);
  EXPECT_LT(counts.evaluations, 100 * steps);
  EXPECT_LT(gap, 1e-10);
  EXPECT_LT(std::abs(world.coordinate(hinge, "angle")), 1e-10);
  EXPECT_LT(std::abs(world.coordinate_rate(hinge, "angle")), 1e-10);
}

// A double pendulum in floats with a requested error far below the last bit. The error is then that of the last bit, by
// steps of a high-order method and not by steps of pure round-off.
TEST(RescueOfFloats, NoErrorIsBelowTheLastBit) {
  for (const Integrator integrator : methods) {
    World<float> world({.integrator = integrator, .local_error = 1e-12, .gravity_y = -9.81});
    int above = world.ground();
    for (const double x : {0.5, 1.5}) {
      const int rod = world.add_body({.x = x, .mass = 1, .inertia = 0.1});
      world.add_joint({"revolute", {above, rod}, {{"pa", {x > 1 ? 0.5 : 0, 0}}, {"pb", {-0.5, 0}}}, {}});
      above = rod;
    }
    const double start = world.energy();
    for (int k = 0; k < 20; ++k) world.step(0.1);
    const StepCounts& counts = world.step_counts();
    const double off = std::abs(world.energy() - start);
    fmt::print("  {} taken, {} left to an implicit method, energy off by {:.1e} J\n", counts.taken, counts.rescued,
               off);
    EXPECT_LT(counts.taken, 20'000);
    EXPECT_EQ(counts.rescued, 0);
    EXPECT_LT(off, 1e-3);
  }
}

// A spring swings its rod 160,000 times in a second, and a step of a second leaves it all to explicit steps.
TEST(RescueOfAStiffSpring, AStepEnds) {
  World<double> world({.integrator = Integrator::dop853, .local_error = 1e-6});
  const int rod = world.add_body({.w = 1, .mass = 1, .inertia = 0.1});
  const int hinge = world.add_joint({"revolute", {world.ground(), rod}, {{"pa", {0, 0}}, {"pb", {0, 0}}}, {}});
  add_spring(world, hinge, "angle", {.softness = {.by_frequency = false, .stiffness = 1e11}});
  EXPECT_TRUE(world.step(1));
  const StepCounts& counts = world.step_counts();
  fmt::print("  {} taken, {} rejected, {} left to an implicit method\n", counts.taken, counts.rejected, counts.rescued);
  EXPECT_EQ(counts.taken, 20'000);
  EXPECT_EQ(counts.rescued, 1);
  EXPECT_EQ(world.time(), 1);
}

// A bead of 1 g on two bars between the ground and a load of 1 kg that flies away: they become taut in less time than a
// fixed step. A step that ends out of the joints' reach is rejected, and the counts report it.
TEST_P(Rescue, ALightBeadIsDrawnTaut) {
  const auto& [integrator, local_error] = GetParam();
  for (const auto& [x, h] : {std::pair{0.9, 0.027}, {0.97, 0.083}}) {
    World<double> world({.integrator = integrator, .local_error = local_error});
    const int bead = world.add_body({.x = x, .y = std::sqrt(1 - x * x), .mass = 1e-3, .inertia = 1e-4});
    const int load = world.add_body({.x = 2 * x, .vx = 1, .mass = 1, .inertia = 0.1});
    for (const auto& bodies : {std::vector{world.ground(), bead}, std::vector{bead, load}})
      world.add_joint({"distance", bodies, {{"pa", {0, 0}}, {"pb", {0, 0}}, {"l", {1}}}, {}});
    double unsaid = 0;
    for (int k = 0; k < 40; ++k) {
      world.step(h);
      if (world.step_counts().rescued == 0) unsaid = std::max(unsaid, world.worst_position_error().value);
    }
    fmt::print("  off by {:.1e} m with nothing said, {:.1e} m at the end, {} steps left to an implicit method\n",
               unsaid, world.worst_position_error().value, world.step_counts().rescued);
    EXPECT_LT(unsaid, 1e-10);
  }
}

// Ten links in space, for which 1/24 s is sometimes too long for rk4. The step is then taken in parts, and the result
// agrees with fine steps of another method. Euler's method would end 0.29 m away.
TEST(RescueOfASpatialChain, TakesPartsOfTheStepFirst) {
  Scene scene = scene_named("spatial/chain_10");
  const auto end_of = [&](Integrator integrator, int steps, StepCounts& counts) {
    scene.settings.integrator = integrator;
    SpatialWorld<double> world = build_world_in<Spatial<double>>(scene);
    for (int k = 0; k < steps; ++k) world.step(scene.duration / steps);
    counts = world.step_counts();
    return frame_of(world, scene.duration, 10);
  };
  StepCounts coarse, fine;
  const Frame end = end_of(Integrator::rk4, 48, coarse), truth = end_of(Integrator::rattle, 2000, fine);
  const double off = apart(end, truth, scene.dimension).position;
  fmt::print("  off by {:.2e} m, {} attempts in parts, {} steps left to an implicit method\n", off, coarse.rejected,
             coarse.rescued);
  EXPECT_LT(off, 0.05);
  EXPECT_GT(coarse.rejected, 0);
  EXPECT_EQ(coarse.rescued, 0);
}

std::string name_of(Integrator integrator, double local_error) {
  return std::string(row_of(integrator).name) + (local_error == 0 ? "_fixed" : "_adaptive");
}

constexpr double local_errors[] = {0, 1e-6};
// A palm that turns until its wrist strikes a limit. Five fingers of two bones each hang at their own limits. Their
// dampers decay at 1e4 to 1e6 1/s: the blow throws the bones off, and they stop within microseconds.
Scene hand(const std::string& method) {
  std::string text = "duration = 0.3\ngravity = [0, -9.81]\n" + method + R"(
[[body]]
name = "palm"
mass = 0.4
inertia = 1e-3
position = [0.05, 0]
[[joint]]
type = "revolute"
bodies = ["world", "palm"]
at = [0, 0]
angle.limit = { lower = -0.6, upper = 0.5 }
)";
  constexpr const char* bone =
      "[[body]]\nname = \"{0}\"\nmass = {1}\ninertia = {2}\nposition = [{3}, {4}]\n"
      "[[joint]]\ntype = \"revolute\"\nbodies = [\"{5}\", \"{0}\"]\nat = [{6}, {4}]\n"
      "angle.limit = {{ lower = -1.5, upper = 0 }}\nangle.spring = {{ stiffness = 0, damping = 0.1, rest = 0 }}\n";
  for (int k = 0; k < 5; ++k) {
    const std::string near = fmt::format("near{}", k);
    const double height = -0.04 + 0.02 * k;
    text += fmt::format(bone, near, 0.02 + 0.002 * k, 2e-6, 0.12, height, "palm", 0.1);
    text += fmt::format(bone, fmt::format("far{}", k), 0.01, 5e-7, 0.15, height, near, 0.14);
  }
  return read_scene(text, "hand");
}

// Radau IIA takes no step of another method there. It moves as DOP853 does, whose steps are as short as the dampers
// ask.
TEST(RescueOfAHand, IsNotNeededBehindABlow) {
  const std::vector<Frame> fine = run_of(hand("integrator = \"dop853\"\nlocal_error = 1e-8"), 0.3, 0.05);
  for (const double local_error : {1e-4, 1e-6, 1e-8}) {
    const auto [result, rows] =
        recorded(hand(fmt::format("integrator = \"radau5\"\nlocal_error = {}", local_error)), 0.05);
    double off = 0;
    ASSERT_EQ(rows.size(), fine.size());
    for (std::size_t k = 0; k < rows.size(); ++k)
      for (std::size_t body = 0; body < rows[k].bodies.size(); ++body)
        off = std::max(off, std::abs(rows[k].bodies[body].angle - fine[k].bodies[body].angle));
    fmt::print("  {:.0e}: {} steps, {} events, off by {:.1e} rad\n", local_error, result.counts.taken,
               result.counts.events, off);
    EXPECT_EQ(result.counts.rescued, 0) << local_error;
    EXPECT_GE(result.counts.events, 5) << local_error;
    EXPECT_LT(off, 10 * local_error) << local_error;
  }
}

INSTANTIATE_TEST_SUITE_P(Methods, Rescue, testing::Combine(testing::ValuesIn(methods), testing::ValuesIn(local_errors)),
                         [](const auto& info) { return std::apply(name_of, info.param); });
INSTANTIATE_TEST_SUITE_P(Methods, RescueOfALoad,
                         testing::Combine(testing::ValuesIn(methods), testing::ValuesIn(local_errors), testing::Bool()),
                         [](const auto& info) {
                           return name_of(std::get<0>(info.param), std::get<1>(info.param)) +
                                  (std::get<2>(info.param) ? "_on_beads" : "_on_rods");
                         });

}  // namespace
}  // namespace cdot::test::rescue_test
