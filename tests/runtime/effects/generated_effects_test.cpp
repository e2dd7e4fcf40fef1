// Effects from specs, by closed forms with every integrator, by their balance of energy and by stiffness.
#include "tests/runtime/effects/generated_effects.hpp"

#include <cmath>
#include <fmt/format.h>

namespace cdot::test {
namespace {

using effects::ball;
using effects::expect_orders;
using effects::wheel;
using effects::with;

long steps_of(double duration, double h) { return std::lround(duration / h); }

// A stone that falls through air: v = v_t tanh(g t / v_t) with v_t = sqrt(m g / c).
double error_of_fall(Integrator integrator, double h) {
  constexpr double g = 9.81, m = 2, c = 0.3;
  World<double> world(with(integrator, -g));
  const int stone = ball(world, 0, 0, 0, 0, m);
  world.add_joint({"drag", {stone}, {{"pa", {0, 0}}, {"c", {c}}}, {}});
  for (long k = 0; k < steps_of(1, h); ++k) EXPECT_TRUE(world.step(h));
  const double end = std::sqrt(m * g / c);
  return std::abs(world.velocity(stone).y + end * std::tanh(g / end));
}

TEST(GeneratedEffects, AStoneFallsThroughAir) { expect_orders("drag", 0.1, 0.3, error_of_fall); }

// The air of a wind is at rest in axes that move with it: there a ball of speed u flies (m/c) ln(1 + c u t / m) far.
double error_in_wind(Integrator integrator, double h) {
  constexpr double m = 2, c = 0.4, wind[2] = {3, 1}, v[2] = {1, -4};
  World<double> world(with(integrator));
  const int body = ball(world, 0, 0, v[0], v[1], m);
  world.add_joint({"wind", {body}, {{"pa", {0, 0}}, {"wind_velocity", {wind[0], wind[1]}}, {"c", {c}}}, {}});
  for (long k = 0; k < steps_of(2, h); ++k) EXPECT_TRUE(world.step(h));
  const double u = std::hypot(v[0] - wind[0], v[1] - wind[1]), far = m / c * std::log(1 + c * u * 2 / m) / u;
  return std::hypot(world.pose(body).x - 2 * wind[0] - (v[0] - wind[0]) * far,
                    world.pose(body).y - 2 * wind[1] - (v[1] - wind[1]) * far);
}

TEST(GeneratedEffects, ABallFliesInAWind) { expect_orders("wind", 0.05, 0.3, error_in_wind); }

// With a joint, whose impulses also change the rates of the effect.
double angle_in_wind(Integrator integrator, double h) {
  World<double> world(with(integrator, -9.81));
  const int rod = world.add_body({.x = 0.5, .mass = 2, .inertia = 0.2});
  revolute(world, world.ground(), rod, 0, 0, -0.5, 0);
  world.add_joint({"wind", {rod}, {{"pa", {0.5, 0}}, {"wind_velocity", {3, 1}}, {"c", {0.4}}}, {}});
  for (long k = 0; k < steps_of(1, h); ++k) EXPECT_TRUE(world.step(h));
  return world.pose(rod).angle;
}

TEST(GeneratedEffects, APendulumSwingsInAWind) {
  const double reference = angle_in_wind(Integrator::dop853, 1e-3);
  expect_orders("wind on a pendulum", 0.02, 0.1,
                [&](Integrator integrator, double h) { return std::abs(angle_in_wind(integrator, h) - reference); });
}

// Sweeps solve the rows of an effect one by one.
TEST(GeneratedEffects, SweepsFindWhatTheDirectSolverFinds) {
  for (const Integrator integrator : {Integrator::euler, Integrator::rattle}) {
    const auto place = [&](Solver solver) {
      Settings s = with(integrator);
      s.solver = solver;
      World<double> world(s);
      const int body = ball(world, 0, 0, 1, -4, 2);
      world.add_joint({"wind", {body}, {{"pa", {0.3, 0}}, {"wind_velocity", {3, 1}}, {"c", {0.4}}}, {}});
      for (int k = 0; k < 100; ++k) EXPECT_TRUE(world.step(0.01));
      return std::pair(world.pose(body).x, world.pose(body).y);
    };
    const auto [x, y] = place(Solver::direct);
    const auto [sweeps_x, sweeps_y] = place(Solver::iterative);
    EXPECT_NEAR(sweeps_x, x, 1e-5);
    EXPECT_NEAR(sweeps_y, y, 1e-5);
  }
}

// A thick fluid slows a light ball, v = v_0 exp(-d t / m): K = 1/m is far from 1.
double error_of_slowing(Integrator integrator, double h) {
  constexpr double m = 1e-6, d = 8e-7;
  World<double> world(with(integrator));
  const int body = ball(world, 0, 0, 30, 0, m);
  world.add_joint({"viscous_drag", {body}, {{"pa", {0, 0}}, {"d", {d}}}, {}});
  for (long n = 0; n < steps_of(1, h); ++n) EXPECT_TRUE(world.step(h));
  return std::abs(world.velocity(body).x / 30 - std::exp(-d / m));
}

TEST(GeneratedEffects, AThickFluidSlowsALightBall) { expect_orders("viscous_drag", 0.05, 0.1, error_of_slowing); }

// On its circle of radius m v/strength a charge is back after 2 pi m/strength.
double error_of_charge(Integrator integrator, double h) {
  constexpr double m = 0.5, strength = 2, period = 2 * pi * m / strength;
  World<double> world(with(integrator));
  const int body = ball(world, 1, 0, 0, 3, m);
  world.add_joint({"magnetic_field", {body}, {{"pa", {0, 0}}, {"strength", {strength}}}, {}});
  const long steps = steps_of(1, h);
  for (long n = 0; n < steps; ++n) EXPECT_TRUE(world.step(period / static_cast<double>(steps)));
  return std::hypot(world.pose(body).x - 1, world.pose(body).y);
}

TEST(GeneratedEffects, AChargeReturnsOnItsCircle) { expect_orders("magnetic_field", 0.01, 1, error_of_charge); }

// dt = I w_s ds / T(s) gives t = I w_s / (2 T_p) ((1 - s^2)/(2 s_p) + s_p ln(1/s)) from rest to the slip s.
double error_of_induction(Integrator integrator, double h) {
  constexpr double synchronous = 50, pull_out = 20, slip = 0.2, I = 0.5, target = 0.3;
  const double duration =
      I * synchronous / (2 * pull_out) * ((1 - target * target) / (2 * slip) + slip * std::log(1 / target));
  World<double> world(with(integrator));
  const int rotor = wheel(world, I);
  world.add_joint({"induction_motor",
                   {rotor, world.ground()},
                   {{"synchronous", {synchronous}}, {"pull_out", {pull_out}}, {"pull_out_slip", {slip}}},
                   {}});
  const long steps = steps_of(1, h);
  for (long k = 0; k < steps; ++k) EXPECT_TRUE(world.step(duration / static_cast<double>(steps)));
  return std::abs(world.velocity(rotor).w - synchronous * (1 - target));
}

TEST(GeneratedEffects, AnInductionMotorRunsUp) { expect_orders("induction_motor", 0.02, 3, error_of_induction); }

// A damped spring: x = x_0 exp(-a t) (cos w t + a / w sin w t), a = d / 2m, w^2 = k / m - a^2.
double error_of_spring(Integrator integrator, double h) {
  constexpr double k = 40, d = 0.8, m = 2, rest = 3, stretch = 0.5;
  World<double> world(with(integrator));
  const int mass = ball(world, rest + stretch, 0, 0, 0, m);
  world.add_joint({"spring",
                   {mass, world.ground()},
                   {{"pa", {0, 0}}, {"pb", {0, 0}}, {"k", {k}}, {"rest", {rest}}, {"d", {d}}},
                   {}});
  for (long n = 0; n < steps_of(1, h); ++n) EXPECT_TRUE(world.step(h));
  const double a = d / (2 * m), w = std::sqrt(k / m - a * a);
  return std::abs(world.pose(mass).x - rest - stretch * std::exp(-a) * (std::cos(w) + a / w * std::sin(w)));
}

TEST(GeneratedEffects, ASpringWithADamperSwings) { expect_orders("spring", 0.02, 0.1, error_of_spring); }

// A thruster turns with its body: with a spin w, x = F/(m w^2) (1 - cos wt, wt - sin wt).
template <class S>
double error_of_spiral(BasicWorld<S> world, int rocket, std::vector<double> at, std::vector<double> n, double h) {
  constexpr double w = 3, F = 5, unit = F / (2 * w * w);
  world.add_joint({"thruster", {rocket}, {{"pa", at}, {"n", n}, {"F", {F}}}, {}});
  for (long k = 0; k < steps_of(1, h); ++k) EXPECT_TRUE(world.step(h));
  return std::hypot(world.place(rocket).x - unit * (1 - std::cos(w)), world.place(rocket).y - unit * (w - std::sin(w)));
}

double error_in_plane(Integrator integrator, double h) {
  World<double> world(with(integrator));
  const int rocket = world.add_body({.w = 3, .mass = 2, .inertia = 1});
  return error_of_spiral(std::move(world), rocket, {-0.4, 0}, {2, 0}, h);
}

double error_in_space(Integrator integrator, double h) {
  SpatialWorld<double> world(with(integrator));
  const int rocket = world.add_body({.wz = 3, .mass = 2, .inertia = {1, 2, 3}});
  return error_of_spiral(std::move(world), rocket, {-0.4, 0, 0}, {2, 0, 0}, h);
}

TEST(GeneratedEffects, AThrusterTurnsWithItsBody) {
  expect_orders("thruster in the plane", 0.05, 0.1, error_in_plane);
  expect_orders("thruster in space", 0.05, 0.1, error_in_space);
}

// A planet on a circle: after one period it is where it was.
TEST(GeneratedEffects, APlanetReturnsAfterItsPeriod) {
  World<double> world(with(Integrator::dop853));
  const double mu = 3, m = 1.5, r = 2, speed = std::sqrt(mu / m / r), period = 2 * pi * r / speed;
  const int planet = ball(world, r, 0, 0, speed, m);
  world.add_joint({"gravity_well", {planet}, {{"pa", {0, 0}}, {"centre", {0, 0}}, {"mu", {mu}}}, {}});
  for (int k = 0; k < 50; ++k) ASSERT_TRUE(world.step(period / 50));
  fmt::print("off by {:.1e} m\n", std::hypot(world.pose(planet).x - r, world.pose(planet).y));
  EXPECT_NEAR(world.pose(planet).x, r, 1e-9);
  EXPECT_NEAR(world.pose(planet).y, 0, 1e-9);
}

// --- What forces without an energy put in and take is booked.

struct Pushed {
  const char* effect;
  std::vector<NamedValue> parameters;
};

TEST(GeneratedEffects, TheBalanceCloses) {
  const Pushed all[] = {
      {"drag", {{"pa", {0.3, 0}}, {"c", {0.4}}}},
      {"wind", {{"pa", {0.3, 0}}, {"wind_velocity", {3, 1}}, {"c", {0.4}}}},
      {"thruster", {{"pa", {-0.4, 0.1}}, {"n", {1, 0}}, {"F", {5}}}},
      {"magnetic_field", {{"pa", {0.3, 0}}, {"strength", {2}}}},
  };
  for (const Pushed& pushed : all) {
    for (const IntegratorRow& row : integrator_rows) {
      World<double> world(with(row.integrator));
      const int body = world.add_body({.vx = 1, .vy = -4, .w = 2, .mass = 2, .inertia = 0.5});
      world.add_joint({pushed.effect, {body}, pushed.parameters, {}});
      const double share = effects::unaccounted(world, 2, 0.01);
      fmt::print("  {}, {}: {:.1e} of the energy\n", pushed.effect, row.name, share);
      EXPECT_LT(share, row.order == 1 ? 0.05 : 1e-3) << pushed.effect << ", " << row.name;
    }
  }
}

// --- Steps of any length hold stiff effects, and no energy appears.

TEST(GeneratedEffects, StiffSpringsAndHeavyDragStayStable) {
  for (Integrator integrator : {Integrator::euler, Integrator::rattle, Integrator::implicit}) {
    World<double> world(with(integrator));
    const int mass = ball(world, 1.1, 0, 10, 0);
    // RATTLE's springs are explicit.
    const double k = integrator == Integrator::rattle ? 1e2 : 1e8;
    world.add_joint({"spring",
                     {mass, world.ground()},
                     {{"pa", {0, 0}}, {"pb", {0, 0}}, {"k", {k}}, {"rest", {1}}, {"d", {0}}},
                     {}});
    world.add_joint({"drag", {mass}, {{"pa", {0, 0}}, {"c", {1e4}}}, {}});
    const double start = world.energy();
    for (int n = 0; n < 600; ++n) {
      ASSERT_TRUE(world.step(1.0 / 60));
      ASSERT_LE(world.energy(), start * (1 + 1e-9));
    }
  }
}

// A coordinate need not be able to vanish, as the row of a joint; a law needs a value.
TEST(GeneratedEffects, AreRefusedWhereTheirLawHasNoValue) {
  for (int k = 0; k < 300; ++k) {
    World<double> world(with(Integrator::euler));
    const int a = world.add_body({.x = 3.0 + k, .angle = 0.7 * k, .mass = 1, .inertia = 1e-3});
    const int b = world.add_body({.y = -0.4 * k, .angle = 2.3 * k, .mass = 1e3, .inertia = 10});
    const std::vector<NamedValue> points = {{"pa", {0.3, -0.4}}, {"pb", {-2, 0.01 * k}}};
    std::vector<NamedValue> spring = points, gas = points;
    spring.insert(spring.end(), {{"k", {10}}, {"rest", {-1}}});
    gas.insert(gas.end(), {{"F", {10}}, {"rest", {-1}}});
    EXPECT_NO_THROW(world.add_joint({"spring", {a, b}, spring, {}})) << k;
    EXPECT_THROW(world.add_joint({"gas_spring", {a, b}, gas, {}}), Error) << k;
  }
}

TEST(GeneratedEffects, AnEffectCannotBeASpring) {
  World<double> world(with(Integrator::euler));
  const int body = ball(world, 0, 0);
  const Softness soft{.frequency = 2, .damping_ratio = 0.5};
  try {
    world.add_joint({"drag", {body}, {{"pa", {0, 0}}, {"c", {1}}}, soft});
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("`drag` is an effect"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace cdot::test
