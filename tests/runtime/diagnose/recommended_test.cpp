// The method that the runtime chooses for fixed steps, and its reason.
#include <cmath>
#include <gtest/gtest.h>

#include <cdot/effects.hpp>
#include <cdot/recommended.hpp>

#include "tests/runtime/support.hpp"

namespace cdot::test::recommended_test {
namespace {

constexpr double h = 1.0 / 60;
const Settings heavy{.gravity_y = -9.81};

// Level and at rest: no joint is under tension yet.
World<double> level_chain(int rods, double load = 0) {
  World<double> world(heavy);
  const int last = add_chain(world, rods, 0).back();
  if (load > 0) revolute(world, last, world.add_body({.x = double(rods), .mass = load}), 0.5, 0, 0, 0);
  return world;
}

Integrator chosen(World<double>& world, double step, const char* because) {
  const Recommendation found = recommended(world, step);
  EXPECT_NE(found.reason.find(because), std::string::npos) << found.reason;
  return found.settings.integrator;
}

TEST(Recommended, TensionToComeTakesTheMidpointRule) {
  World<double> loaded = level_chain(10, 1000), longer = level_chain(40);
  EXPECT_EQ(chosen(loaded, h, "the tension of the joints can make body"), Integrator::implicit);
  EXPECT_EQ(chosen(longer, h, "the tension of the joints can make body"), Integrator::implicit);
  EXPECT_GT(recommended(loaded, h).radians, 5);
}

TEST(Recommended, WhereNothingIsStiffRattleIsCheaper) {
  World<double> rod = level_chain(1), two = level_chain(2);
  EXPECT_EQ(chosen(rod, h, "nothing is stiff"), Integrator::rattle);
  EXPECT_EQ(chosen(two, 1.0 / 240, "nothing is stiff"), Integrator::rattle);
}

// The error of a fall by half a second in steps of a tenth: the eighth order's against that of the midpoint rule.
TEST(Recommended, ACoarseStepOfAPendulumTakesEighthOrder) {
  World<double> rod = level_chain(1);
  EXPECT_EQ(chosen(rod, 0.1, "oscillates by 0.66 rad per substep, which the eighth order follows"), Integrator::dop853);
  const auto angle_after = [](Integrator integrator, int steps) {
    Settings settings = heavy;
    settings.integrator = integrator;
    World<double> world(settings);
    const int body = add_chain(world, 1, 0).back();
    for (int k = 0; k < steps; ++k) world.step(0.5 / steps);
    return world.pose(body).angle;
  };
  const double fine = angle_after(Integrator::rk4, 5000);
  EXPECT_LT(std::abs(angle_after(Integrator::dop853, 5) - fine), 1e-7);
  EXPECT_GT(std::abs(angle_after(Integrator::implicit, 5) - fine), 1e-3);
  World<double> coarser = level_chain(1);
  EXPECT_EQ(chosen(coarser, 0.2, "the tension of the joints can make"), Integrator::implicit);
}

TEST(Recommended, StiffSpringsTakeTheMidpointRule) {
  World<double> world(heavy);
  const int ball = world.add_body({.y = -1, .mass = 1, .inertia = 0.1});
  world.add_spring({.body_a = world.ground(), .body_b = ball, .stiffness = 1e4, .rest_length = 1});
  EXPECT_EQ(chosen(world, h, "a spring can make body 0 oscillate by 1.7 rad"), Integrator::implicit);
  EXPECT_EQ(chosen(world, h / 10, "nothing is stiff"), Integrator::rattle);
}

TEST(Recommended, LimitsTakeTheMidpointRule) {
  World<double> world = level_chain(1);
  add_limit(world, 0, "angle", Limit{-1, 1});
  EXPECT_EQ(chosen(world, h, "limits"), Integrator::implicit);
}

// Its tension is that of its own spin. A wheel about its centre has none.
TEST(Recommended, AFastRodTakesEighthOrder) {
  World<double> rod(Settings{}), wheel(Settings{});
  const int body = rod.add_body({.x = 0.5, .vy = 50, .w = 100, .mass = 1, .inertia = 1.0 / 12});
  revolute(rod, rod.ground(), body, 0, 0, -0.5, 0);
  EXPECT_EQ(chosen(rod, h, "rotates by 1.7 rad"), Integrator::dop853);
  EXPECT_EQ(recommended(rod, h).settings.substeps, 1);
  EXPECT_EQ(recommended(rod, 10 * h).settings.substeps, 34);  // 16.7 rad, each substep at most half a radian
  const int disc = wheel.add_body({.w = 100, .mass = 1, .inertia = 1});
  revolute(wheel, wheel.ground(), disc, 0, 0, 0, 0);
  EXPECT_EQ(chosen(wheel, h, "nothing is stiff"), Integrator::rattle);
}

// The eighth order follows a feather between anvils at 1/60 s. At 1/30 s it makes up energy.
TEST(Recommended, UnevenMassesTakeEighthOrderOrTheMidpointRule) {
  World<double> world(heavy);
  int last = world.ground();
  for (int k = 0; k < 3; ++k) {
    const int body = world.add_body(rod(k, 0, 0, k == 1 ? 1e-3 : 1e3));
    revolute(world, last, body, k > 0 ? 0.5 : 0, 0, -0.5, 0);
    last = body;
  }
  EXPECT_EQ(chosen(world, h, "bodies from 0.001 to 1e+03 kg hang together, at most 0.31 rad"), Integrator::dop853);
  EXPECT_EQ(chosen(world, 2 * h, "bodies from 0.001 to 1e+03 kg"), Integrator::implicit);
}

// The island that needs most decides for the World, whatever the order.
// A light body beside a heavy one would get the eighth order, which a damper makes unstable: exp(-h d / I) from 6.2 on.
TEST(Recommended, DampersOfLightBodiesTakeTheMidpointRule) {
  const auto damped = [](double damping) {
    World<double> world(Settings{});
    const int hand = world.add_body({.mass = 1, .inertia = 1}),
              thumb = world.add_body({.mass = 0.001, .inertia = 0.001});
    revolute(world, world.ground(), hand, 0, 0, 0, 0);
    const int joint = revolute(world, hand, thumb, 0, 0, 0, 0);
    add_spring(world, joint, "angle", {.softness = {.by_frequency = false, .stiffness = 0, .damping = damping}});
    return world;
  };
  World<double> slight = damped(0.1), strong = damped(0.4);
  EXPECT_EQ(chosen(slight, h, "bodies from 0.001 to 1 kg hang together"), Integrator::dop853);
  EXPECT_EQ(chosen(strong, h, "dampers slow body 1 at a rate of 6.7 per substep"), Integrator::implicit);
}

TEST(Recommended, TheStiffestIslandDecides) {
  for (const bool first : {true, false}) {
    World<double> world(heavy);
    if (first) add_chain(world, 1, -1);
    add_chain(world, 40, 0);
    if (!first) add_chain(world, 1, -1);
    const Recommendation found = recommended(world, h);
    EXPECT_EQ(found.settings.integrator, Integrator::implicit);
    EXPECT_EQ(found.island, first ? 1 : 0);
  }
}

TEST(Recommended, AskingChangesNoBit) {
  for (const Solver solver : {Solver::direct, Solver::iterative}) {
    Settings settings = heavy;
    settings.solver = solver;
    World<double> asked(settings), silent(settings);
    for (World<double>* world : {&asked, &silent}) add_chain(*world, 10, 0);
    recommended(asked, h);
    for (int k = 0; k < 100; ++k) asked.step(h), silent.step(h);
    EXPECT_EQ(asked.hash(), silent.hash());
  }
}

// A World that takes other settings before its first step is a World built with them.
TEST(Recommended, UsedSettingsAreThoseOfANewWorld) {
  World<double> used = level_chain(10);
  Settings settings = recommended(used, h).settings;
  settings.gravity_x = 1;
  used.use(settings);
  World<double> built(settings);
  add_chain(built, 10, 0);
  for (int k = 0; k < 100; ++k) used.step(h), built.step(h);
  EXPECT_EQ(used.hash(), built.hash());
  EXPECT_EQ(used.settings().integrator, Integrator::implicit);
}

// A second buys every substep, a nanosecond one iteration.
TEST(Recommended, ABudgetBuysSubstepsOrIterations) {
  World<double> world = level_chain(10);
  const Recommendation rich = recommended_within(world, h, 1), poor = recommended_within(world, h, 1e-9);
  EXPECT_EQ(rich.settings.solver, Solver::direct);
  EXPECT_EQ(rich.settings.substeps, 64);
  EXPECT_EQ(rich.settings.integrator, Integrator::rattle);  // not stiff in a substep
  EXPECT_NE(rich.reason.find("64 substeps take"), std::string::npos) << rich.reason;
  EXPECT_EQ(poor.settings.solver, Solver::iterative);
  EXPECT_EQ(poor.settings.iterations, 1);
  EXPECT_NE(poor.reason.find("of 1 iteration "), std::string::npos) << poor.reason;
  EXPECT_EQ(world.time(), 0);
  EXPECT_EQ(world.pose(9).y, 0) << "the measured steps are taken back";
  world.use(rich.settings);
  EXPECT_TRUE(world.step(h));
}

TEST(Recommended, OnlyBeforeTheFirstStep) {
  World<double> world = level_chain(2);
  world.step(h);
  EXPECT_THROW(recommended(world, h), Error);
  EXPECT_THROW(world.use(heavy), Error);
  World<double> mistaken = level_chain(2);
  EXPECT_THROW(mistaken.use({.iterations = 0}), Error);
}

}  // namespace
}  // namespace cdot::test::recommended_test
