// Loads that grow without bound towards the flat pose of a parallelogram, whose left crank is damped: something breaks
// on the way there, and a step over the pose would see no such load.
#include <cmath>
#include <fmt/core.h>
#include <gtest/gtest.h>
#include <utility>

#include <cdot/effects.hpp>
#include <cdot/methods.hpp>

#include "tests/runtime/mechanisms.hpp"
#include "tests/runtime/support.hpp"

namespace cdot::test::loads_near_rank_loss_test {
namespace {

constexpr double gravity = 9.81, damping = 0.5;

// Upright cranks of 1 m and 1 kg at -1 rad/s. Their couplers are of 1 kg each: a level bar, or two that meet 0.4 m
// higher.
struct Parallelogram {
  Parallelogram(const Settings& s, bool bent) : world(s) {
    const int left = add_bar(world, {0, 0, 0, 1}), right = add_bar(world, {1, 0, 1, 1});
    const double height = bent ? 1.4 : 1, middle = bent ? 0.5 : 1;
    first = second = add_bar(world, {0, 1, middle, height});
    if (bent) second = add_bar(world, {middle, height, 1, 1});
    for (const int crank : {left, right}) world.set_velocity(crank, {0.5, 0, -1});
    for (const int coupler : {first, second}) world.set_velocity(coupler, {1, 0, 0});
    const int damped = pin(world, world.ground(), left, 0, 0);
    pin(world, left, first, 0, 1);
    if (bent) apex = pin(world, first, second, middle, height);
    last = pin(world, second, right, 1, 1);
    pin(world, world.ground(), right, 1, 0);
    add_effect(world, damped, "angle",
               CoordinateSpring{{.by_frequency = false, .stiffness = 0, .damping = damping}, 0});
  }
  double bend() const { return world.pose(first).angle - world.pose(second).angle; }
  World<double> world;
  int first = -1, second = -1, apex = -1, last = -1;
};

// With F on the right crank, and half of the level coupler's weight and inertia on each crank,
//   theta'' / 3 = cos(theta) F_y - sin(theta) F_x - g cos(theta) / 2.
// The time at which the last pin breaks, from the motion of one freedom by RK4 with steps of 1e-5 s.
double time_of_break(double strength) {
  const double h = 1e-5;
  const auto rate = [&](double at, double spin) {
    return -(2 * gravity * std::cos(at) + damping * spin) / (2.0 / 3 + 1);
  };
  double angle = pi / 2, spin = -1;
  for (long k = 0;; ++k) {
    const double a1 = rate(angle, spin), lift = std::cos(angle) * a1 - std::sin(angle) * spin * spin,
                 fy = -(gravity + lift) / 2, fx = (std::cos(angle) * (fy - gravity / 2) - a1 / 3) / std::sin(angle);
    if (std::hypot(fx, fy) >= strength) return static_cast<double>(k) * h;
    const double a2 = rate(angle + h / 2 * spin, spin + h / 2 * a1),
                 a3 = rate(angle + h / 2 * spin + h * h / 4 * a1, spin + h / 2 * a2),
                 a4 = rate(angle + h * spin + h * h / 2 * a2, spin + h * a3);
    angle += h * spin + h * h / 6 * (a1 + a2 + a3);
    spin += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
  }
}

TEST(LoadsNearRankLoss, BreakAPin) {
  using enum Integrator;
  for (const double strength : {40.0, 100.0, 400.0})
    for (const auto& [integrator, allowed] :
         {std::pair{rk4, 0.0}, {rk4, 1e-6}, {dop853, 0.0}, {dop853, 1e-6}, {dop853, 1e-9}})
      for (const double h : {0.05, 0.031, 0.02, 0.007}) {
        Parallelogram p(runge_kutta(integrator, allowed), false);
        const double breaks = time_of_break(strength);
        set_breaking_load(p.world, p.last, strength);
        double time = 0;
        for (; !p.world.broken(p.last) && time < 2 * breaks; time += h) ASSERT_TRUE(p.world.step(h));
        EXPECT_GE(time, breaks) << row_of(integrator).name << " " << allowed << " " << h;
        EXPECT_LT(time - h, breaks) << row_of(integrator).name << " " << allowed << " " << h;
      }
}

// The force along a bent coupler bends its pin. Steps of 1e-4 s are the second route.
TEST(LoadsNearRankLoss, ShearAPin) {
  const auto time_of_bend = [](const Settings& s, double strength, double h) {
    Parallelogram p(s, true);
    add_effect(p.world, p.apex, "angle", SpecEffect{"shear_pin", {{"strength", {strength}}}});
    const double start = p.bend();
    double time = 0;
    for (; std::abs(p.bend() - start) < 0.1 && time < 2; time += h) EXPECT_TRUE(p.world.step(h));
    return time;
  };
  for (const double strength : {20.0, 100.0}) {
    const double bends = time_of_bend(runge_kutta(Integrator::dop853), strength, 1e-4);
    EXPECT_LT(bends, 1.5) << strength;
    for (const double h : {0.05, 0.03})
      EXPECT_NEAR(time_of_bend(runge_kutta(Integrator::dop853, 1e-8), strength, h), bends, h) << strength << " " << h;
  }
}

// Of a rhombus from rest, whose coupler is too long by a misfit as of rounded numbers: how far its cranks are apart
// after a second, in which they have passed the flat pose.
double apart_after(const Settings& s, double angle, double misfit, bool may_break) {
  World<double> world(s);
  const double x = std::cos(angle), y = std::sin(angle);
  const int left = add_bar(world, {0, 0, x, y}), right = add_bar(world, {1, 0, 1 + x, y}),
            coupler = add_bar(world, {x, y, 1 + x + misfit, y});
  pin(world, world.ground(), left, 0, 0);
  pin(world, world.ground(), right, 1, 0);
  const int held = pin(world, left, coupler, x, y);
  world.add_joint({"revolute", {right, coupler}, {{"pa", {0.5, 0}}, {"pb", {0.5 * (1 + misfit), 0}}}, {}});
  if (may_break) set_breaking_load(world, held, 1e9);
  world.project(1e-12);
  run(world, 1, 1.0 / 64);
  EXPECT_FALSE(world.broken(held));
  return std::abs(world.pose(left).angle - world.pose(right).angle);
}

TEST(LoadsNearRankLoss, JointsThatHoldChangeNoBranch) {
  int runs = 0, apart = 0;
  for (const double misfit : {1e-12, 1e-11, 1e-10, -1e-10, 1e-9, -1e-9})
    for (const double angle : {0.53, 0.77, 0.92, 1.13, 1.32, 1.46})
      for (const double allowed : {1e-5, 1e-7, 1e-9})
        for (const bool may_break : {false, true}) {
          const double by_now = apart_after(runge_kutta(Integrator::dop853, allowed), angle, misfit, may_break);
          EXPECT_LT(by_now, 1e-3) << misfit << " " << angle << " " << allowed << " " << may_break;
          ++runs, apart += by_now > 1e-3;
        }
  fmt::print("  {} of {} runs leave the branch\n", apart, runs);
}

}  // namespace
}  // namespace cdot::test::loads_near_rank_loss_test
