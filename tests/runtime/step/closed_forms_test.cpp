// Motions whose exact solution is known, at several steps: the error must fall at first order.
#include <functional>

#include "tests/runtime/support.hpp"

namespace cdot::test {
namespace {

// error(h) at h, h/2, h/4, h/8: each halving must come near halving the error.
void expect_first_order(double h, const std::function<double(double)>& error, double lowest = 0.85,
                        double highest = 1.2) {
  double before = error(h);
  for (int k = 1; k < 4; ++k) {
    const double now = error(h / (1 << k));
    const double order = std::log2(before / now);
    EXPECT_GT(order, lowest) << "h = " << h / (1 << k) << ", error " << now;
    EXPECT_LT(order, highest) << "h = " << h / (1 << k) << ", error " << now;
    before = now;
  }
}

TEST(ClosedForms, FreeFallIsExactUpToTheKnownErrorOfSymplecticEuler) {
  const double h = 0.01, g = 9.81;
  World<double> world(settings(Solver::direct, Drift::projection, -g));
  const int ball = world.add_body({.vx = 2, .w = 3, .mass = 5, .inertia = 1});
  run(world, 1, h);
  // y_n = -g h^2 n (n + 1) / 2
  EXPECT_NEAR(world.pose(ball).y, -g * h * h * 100 * 101 / 2, 1e-12);
  EXPECT_NEAR(world.pose(ball).x, 2, 1e-12);
  EXPECT_NEAR(world.pose(ball).angle, 3, 1e-12);
  EXPECT_NEAR(world.velocity(ball).y, -g, 1e-12);
  EXPECT_NEAR(world.energy(), 0.5 * 5 * 4 + 0.5 * 9, 0.5 * 5 * g * g * h * 1.01);
}

TEST(ClosedForms, ConstantForceAndTorque) {
  World<double> world;
  const int body = world.add_body({.mass = 2, .inertia = 4, .force_x = 6, .force_y = -2, .torque = 8});
  run(world, 1, 1e-3);
  EXPECT_NEAR(world.velocity(body).x, 3, 1e-12);
  EXPECT_NEAR(world.velocity(body).y, -1, 1e-12);
  EXPECT_NEAR(world.velocity(body).w, 2, 1e-12);
}

TEST(ClosedForms, DragDecaysExponentially) {
  expect_first_order(0.02, [](double h) {
    World<double> world;
    const int body =
        world.add_body({.vx = 1, .w = 1, .mass = 2, .inertia = 4, .linear_damping = 0.7, .angular_damping = 1.3});
    run(world, 2, h);
    return std::abs(world.velocity(body).x - std::exp(-1.4)) + std::abs(world.velocity(body).w - std::exp(-2.6));
  });
}

// The methods of higher order reach exp(-d t) by their order.
TEST(ClosedForms, DragDecaysExponentiallyByEveryMethod) {
  for (const IntegratorRow& row : integrator_rows) {
    if (row.order < 2) continue;
    Settings s;
    s.integrator = row.integrator;
    World<double> world(s);
    const int body =
        world.add_body({.vx = 1, .w = 1, .mass = 2, .inertia = 4, .linear_damping = 0.7, .angular_damping = 1.3});
    SpatialWorld<double> space(s);
    SpatialBodyDefinition d{.vz = 1, .wx = 1, .mass = 2};
    d.inertia = {4, 4, 4}, d.linear_damping = 0.7, d.angular_damping = 1.3;
    space.add_body(d);
    run(world, 2, 0.01);
    run(space, 2, 0.01);
    const double bound = row.order == 2 ? 1e-4 : 1e-9;
    for (double v : {double(world.velocity(body).x), double(space.velocity(0).z)})
      EXPECT_NEAR(v, std::exp(-1.4), bound) << row.name;
    for (double w : {double(world.velocity(body).w), double(space.velocity(0).wx)})
      EXPECT_NEAR(w, std::exp(-2.6), bound) << row.name;
  }
}

// T = 4 sqrt(l/g) K(sin(A/2)); K through the arithmetic-geometric mean.
double pendulum_period(double length, double g, double amplitude) {
  double a = 1, b = std::cos(amplitude / 2);
  for (int i = 0; i < 20; ++i) {
    const double mean = (a + b) / 2;
    b = std::sqrt(a * b);
    a = mean;
  }
  return 2 * pi * std::sqrt(length / g) / a;
}

// Time between the first two passages through the vertical in the same direction, interpolated.
double measured_period(World<double>& world, int bob, double h) {
  std::vector<double> passages;
  double before = world.pose(bob).x;
  for (int i = 1; passages.size() < 2; ++i) {
    world.step(h);
    const double now = world.pose(bob).x;
    if (before > 0 && now <= 0) passages.push_back((i - 1 + before / (before - now)) * h);
    before = now;
  }
  return passages[1] - passages[0];
}

TEST(ClosedForms, PeriodOfTheSimplePendulum) {
  const double g = 9.81, amplitude = 1.2, exact = pendulum_period(1, g, amplitude);
  for (double h : {1e-2, 5e-3, 2.5e-3}) {
    World<double> world(settings(Solver::direct, Drift::projection, -g));
    const int bob = world.add_body({.x = std::sin(amplitude), .y = -std::cos(amplitude), .mass = 3, .inertia = 0});
    distance(world, world.ground(), bob, 1);
    // A period is even in h for a symplectic method: second order, although the trajectory is first
    // order.
    EXPECT_NEAR(measured_period(world, bob, h), exact, 3 * h * h);
  }
}

// x'' + d/m x' + k/m x = 0 from x = 1 at rest, underdamped.
double oscillator(double k, double d, double m, double t) {
  const double decay = d / (2 * m), w = std::sqrt(k / m - decay * decay);
  return std::exp(-decay * t) * (std::cos(w * t) + decay / w * std::sin(w * t));
}

// Four ways to define the same spring: k = 50, d = 2, m = 2.
TEST(ClosedForms, SoftDistanceByStiffnessIsTheDampedOscillator) {
  for (Solver solver : {Solver::direct, Solver::iterative}) {
    expect_first_order(2e-3, [&](double h) {
      World<double> world(settings(solver));
      const int body = world.add_body({.x = 3, .mass = 2, .inertia = 1});
      distance(world, world.ground(), body, 2, Softness{.by_frequency = false, .stiffness = 50, .damping = 2});
      run(world, 2, h);
      return std::abs(world.pose(body).x - 2 - oscillator(50, 2, 2, 2));
    });
  }
}

TEST(ClosedForms, SoftDistanceByFrequencyIsTheDampedOscillator) {
  const double w = std::sqrt(25.0);  // k/m
  expect_first_order(2e-3, [&](double h) {
    World<double> world;
    const int body = world.add_body({.x = 3, .mass = 2, .inertia = 1});
    distance(world, world.ground(), body, 2,
             Softness{.by_frequency = true, .frequency = w / (2 * pi), .damping_ratio = 0.1});
    run(world, 2, h);
    return std::abs(world.pose(body).x - 2 - oscillator(50, 2, 2, 2));
  });
}

TEST(ClosedForms, PointSpringIsTheDampedOscillator) {
  expect_first_order(2e-3, [&](double h) {
    World<double> world;
    const int body = world.add_body({.x = 3, .mass = 2, .inertia = 1});
    world.add_spring({.body_a = world.ground(), .body_b = body, .stiffness = 50, .rest_length = 2, .damping = 2});
    run(world, 2, h);
    return std::abs(world.pose(body).x - 2 - oscillator(50, 2, 2, 2));
  });
}

TEST(ClosedForms, CoordinateSpringIsTheDampedOscillator) {
  for (Solver solver : {Solver::direct, Solver::iterative}) {
    expect_first_order(2e-3, [&](double h) {
      World<double> world(settings(solver));
      const int wheel = world.add_body({.angle = 1, .mass = 1, .inertia = 2});
      const int joint = revolute(world, world.ground(), wheel, 0, 0, 0, 0);
      add_spring(world, joint, "angle",
                 {.softness = {.by_frequency = false, .stiffness = 50, .damping = 2}, .rest = 0});
      run(world, 2, h);
      return std::abs(world.pose(wheel).angle - oscillator(50, 2, 2, 2));
    });
  }
}

// The energy includes the spring: without damping the total of RATTLE's steps oscillates at second order but does not
// drift.
TEST(ClosedForms, EnergyOfSpringsIsCounted) {
  Settings s;
  s.integrator = Integrator::rattle;
  World<double> world(s);
  const int body = world.add_body({.x = 3, .mass = 2, .inertia = 1});
  world.add_spring({.body_a = world.ground(), .body_b = body, .stiffness = 50, .rest_length = 2});
  EXPECT_NEAR(world.energy(), 25, 1e-12);
  for (int i = 0; i < 20000; ++i) {
    world.step(1e-3);
    ASSERT_NEAR(world.energy(), 25, 25 * 0.25 * 25e-6 * 1.1);  // amplitude (h w)^2 / 4
  }
}

TEST(ClosedForms, SoftJointEnergyIsCounted) {
  World<double> world;
  const int body = world.add_body({.x = 3, .mass = 2, .inertia = 1});
  distance(world, world.ground(), body, 2, Softness{.by_frequency = false, .stiffness = 50, .damping = 0});
  EXPECT_NEAR(world.energy(), 25, 1e-12);
}

}  // namespace
}  // namespace cdot::test
