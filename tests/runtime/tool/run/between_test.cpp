// States between the ends of adaptive steps: as accurate as the ends, on the constraints, and without influence on
// later steps.
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cdot/effects.hpp>
#include <cdot/world.hpp>

namespace cdot::test::between_test {
namespace {

Settings adaptive(Integrator integrator, double local_error) {
  return {.integrator = integrator, .local_error = local_error, .gravity_y = -9.81};
}

struct Pendulum {
  World<double> world;
  int upper, lower, pivot;

  explicit Pendulum(const Settings& settings) : world(settings) {
    upper = world.add_body({.x = 1, .mass = 1, .inertia = 0.1});
    lower = world.add_body({.x = 3, .mass = 1, .inertia = 0.1});
    pivot = world.add_joint({"revolute", {world.ground(), upper}, {{"pa", {0, 0}}, {"pb", {-1, 0}}}, {}});
    world.add_joint({"revolute", {upper, lower}, {{"pa", {1, 0}}, {"pb", {-1, 0}}}, {}});
  }
};

class Between : public testing::TestWithParam<Integrator> {};

// With 16 times more requested states the method takes about as many steps. Its states at common times are as close to
// a run with a thousandth of the local error.
TEST_P(Between, AskingOftenCostsNoSteps) {
  const double local_error = 1e-7;
  Pendulum seldom(adaptive(GetParam(), local_error)), often(adaptive(GetParam(), local_error)),
      exact(adaptive(GetParam(), 1e-3 * local_error));
  double worst_seldom = 0, worst_often = 0, worst_C = 0, worst_Cdot = 0, worst_force = 0;
  for (int k = 0; k < 16; ++k) {
    seldom.world.step(1.0 / 8);
    exact.world.step(1.0 / 8);
    for (int part = 0; part < 16; ++part) {
      often.world.step(1.0 / 128);
      worst_C = std::max(worst_C, often.world.worst_position_error().value);
      worst_Cdot = std::max(worst_Cdot, often.world.worst_velocity_error().value);
    }
    const auto p = exact.world.pose(exact.lower), p1 = seldom.world.pose(seldom.lower),
               p2 = often.world.pose(often.lower);
    worst_seldom = std::max(worst_seldom, std::hypot(p1.x - p.x, p1.y - p.y));
    worst_often = std::max(worst_often, std::hypot(p2.x - p.x, p2.y - p.y));
    const auto f = exact.world.reaction(exact.pivot, exact.upper), f2 = often.world.reaction(often.pivot, often.upper);
    worst_force = std::max(worst_force, std::hypot(f.force_x - f2.force_x, f.force_y - f2.force_y));
  }
  const long long steps = seldom.world.step_counts().taken, more = often.world.step_counts().taken;
  fmt::print("  {} steps, {} if asked 16 times as often; off by {:.1e} m and {:.1e} m; |C| {:.1e}, |Cdot| {:.1e}\n",
             steps, more, worst_seldom, worst_often, worst_C, worst_Cdot);
  EXPECT_LE(more, steps * 11 / 10 + 2);
  EXPECT_LT(worst_often, 50 * local_error);
  EXPECT_LT(worst_C, 1e-12);
  EXPECT_LT(worst_Cdot, 1e-12);
  EXPECT_LT(worst_force, 1e4 * local_error);
}

// The energy is conserved between the ends as well as at the ends.
TEST_P(Between, TheEnergyHolds) {
  for (const double local_error : {1e-5, 1e-8, 1e-11}) {
    Pendulum p(adaptive(GetParam(), local_error));
    const double start = p.world.energy();
    double worst = 0;
    for (int k = 0; k < 1000; ++k) {
      p.world.step(2e-3);
      worst = std::max(worst, std::abs(p.world.energy() - start));
    }
    fmt::print("  local error {:.0e}: energy off by {:.1e} J, {} steps for 1000 states\n", local_error, worst,
               p.world.step_counts().taken);
    EXPECT_LT(worst, 2e3 * local_error);
  }
}

// A change between the ends of a step acts from its time on.
TEST_P(Between, AChangeActsWhenItIsMade) {
  World<double> world(adaptive(GetParam(), 1e-9));
  const int ball = world.add_body({.vx = 1, .mass = 2});
  for (int k = 0; k < 10; ++k) world.step(0.01);
  world.apply_impulse(ball, {4, 0, 0});
  for (int k = 0; k < 10; ++k) world.step(0.01);
  world.set_force(ball, {0, 2 * 9.81, 0});
  for (int k = 0; k < 10; ++k) world.step(0.01);
  EXPECT_NEAR(world.pose(ball).x, 1 * 0.1 + 3 * 0.2, 1e-12);
  EXPECT_NEAR(world.velocity(ball).y, -9.81 * 0.2, 1e-12);
  EXPECT_NEAR(world.pose(ball).y, -9.81 * 0.2 * (0.1 + 0.1), 1e-12);
}

// A load that breaks a joint is an event within a step: where none comes, steps are as long as without it.
TEST_P(Between, LoadsThatBreakNothingEndNoStep) {
  Pendulum strong(adaptive(GetParam(), 1e-6)), rigid(adaptive(GetParam(), 1e-6));
  set_breaking_load(strong.world, strong.pivot, 1e9);
  for (Pendulum* p : {&strong, &rigid})
    for (int k = 0; k < 100; ++k) p->world.step(1e-3);
  EXPECT_GT(strong.world.step_counts().longest, 1e-3);
  EXPECT_EQ(strong.world.step_counts().taken, rigid.world.step_counts().taken);
  EXPECT_EQ(strong.world.pose(strong.lower).x, rigid.world.pose(rigid.lower).x);
}

// In space, with a tensor that turns: a torque-free body keeps its energy and its angular momentum at every state.
TEST_P(Between, ATumblingBodyKeepsItsMomentum) {
  const double local_error = GetParam() == Integrator::dop853 ? 1e-10 : 1e-6;
  SpatialWorld<double> world({.integrator = GetParam(), .local_error = local_error});
  const int body = world.add_body({.wx = 0.01, .wy = 5, .wz = 0.01, .mass = 1, .inertia = {.xx = 1, .yy = 2, .zz = 3}});
  const double start = world.energy();
  double worst = 0, longest_way = 0;
  auto before = world.pose(body);
  for (int k = 0; k < 500; ++k) {
    world.step(0.01);
    worst = std::max(worst, std::abs(world.energy() - start) / start);
    const auto now = world.pose(body);
    longest_way = std::max(longest_way, std::abs(now.e0 - before.e0) + std::abs(now.e2 - before.e2));
    before = now;
  }
  fmt::print("  energy off by {:.1e} of it, {} steps for 500 states\n", worst, world.step_counts().taken);
  EXPECT_LT(worst, 10 * local_error);
  EXPECT_LT(world.step_counts().taken, 450);
  EXPECT_LT(longest_way, 0.1);  // no jumps from state to state
}

INSTANTIATE_TEST_SUITE_P(Methods, Between, testing::Values(Integrator::rk4, Integrator::dop853, Integrator::radau5),
                         [](const auto& info) { return std::string(row_of(info.param).name); });

}  // namespace
}  // namespace cdot::test::between_test
