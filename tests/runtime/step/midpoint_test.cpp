// The implicit midpoint rule, at 1/60 s: it keeps momentum and energy, holds what is stiff from tension, and takes
// springs and dampers of any strength. RATTLE takes dampers of any strength.
#include <cmath>
#include <fmt/core.h>

#include <cdot/balance.hpp>

#include "tests/runtime/mechanisms.hpp"
#include "tests/runtime/spatial_support.hpp"

namespace cdot::test::midpoint_test {
namespace {

constexpr double g = 9.81, h = 1.0 / 60;

Settings by(Integrator integrator, double gravity = 0) {
  Settings s;
  s.integrator = integrator;
  s.gravity_y = gravity;
  return s;
}

struct Point {
  double x, y;
};

// Bars along the points, each joined to the next; masses[i] of bar i. Returns the first.
int add_bars(World<double>& world, const std::vector<Point>& points, const std::vector<double>& masses) {
  const int first = world.body_count();
  for (size_t i = 0; i + 1 < points.size(); ++i) {
    const Point a = points[i], b = points[i + 1];
    add_bar(world, {a.x, a.y, b.x, b.y}, masses[i]);
    if (i > 0) pin(world, world.body_count() - 2, world.body_count() - 1, a.x, a.y);
  }
  return first;
}

double kinetic(const World<double>& world) {
  double energy = 0;
  for (int i = 0; i < world.body_count(); ++i) {
    const auto m = world.inverse_mass(i);
    const auto v = world.velocity(i);
    if (m.m > 0) energy += 0.5 * (v.x * v.x + v.y * v.y) / m.m;
    if (m.I > 0) energy += 0.5 * v.w * v.w / m.I;
  }
  return energy;
}

// Runs for ten seconds. The largest rise of the energy and its largest fall, as shares of the largest kinetic energy.
struct Kept {
  double rise = 0, fall = 0, gap = 0;
};
Kept keeps_energy(World<double>& world) {
  const double start = world.energy();
  double most = 0, rise = 0, fall = 0, gap = 0;
  for (int k = 0; k < 600; ++k) {
    EXPECT_TRUE(world.step(h));
    most = std::max(most, kinetic(world));
    rise = std::max(rise, world.energy() - start);
    fall = std::max(fall, start - world.energy());
    gap = std::max(gap, world.worst_position_error().value);
  }
  return {rise / most, fall / most, gap};
}

// A ring of twelve bars, no circle, spins in free space for a minute.
TEST(Midpoint, AFreeRingKeepsMomentumAndEnergy) {
  World<double> world(by(Integrator::implicit));
  std::vector<Point> points;
  for (int i = 0; i <= 12; ++i) points.push_back({2.6 * std::cos(i * pi / 6), 1.7 * std::sin(i * pi / 6)});
  add_bars(world, points, std::vector<double>(12, 1.0));
  pin(world, 11, 0, points[0].x, points[0].y);
  const auto momentum = [&] {
    double spin = 0;
    for (int i = 0; i < 12; ++i) {
      const auto q = world.pose(i);
      const auto v = world.velocity(i);
      spin += q.x * v.y - q.y * v.x + v.w / world.inverse_mass(i).I;
    }
    return spin;
  };
  for (int i = 0; i < 12; ++i) world.set_velocity(i, {-3 * world.pose(i).y, 3 * world.pose(i).x, 3});
  world.apply_impulse(3, {2, -1, 0.3});
  world.project(1e-12);
  const double spin = momentum(), energy = world.energy();
  run(world, 60, h);
  fmt::print("  angular momentum {:.12g}, off by {:.2e}; energy {:.12g}, off by {:.2e}\n", spin, momentum() - spin,
             energy, world.energy() - energy);
  EXPECT_NEAR(momentum() / spin, 1, 1e-12);
  EXPECT_NEAR(world.energy() / energy, 1, 2e-3);
}

// A chain of spheres and universal joints tumbles in space.
TEST(Midpoint, AFreeChainInSpaceKeepsMomentum) {
  Settings s = by(Integrator::implicit);
  SpatialWorld<double> world(s);
  add_free_mechanism(world);
  const SpatialMomentum before = momentum(world);
  run(world, 10, h);
  const SpatialMomentum after = momentum(world);
  EXPECT_LT(norm(after.linear - before.linear), 1e-11);
  EXPECT_LT(norm(after.angular - before.angular), 1e-10);
}

// Nothing turns here, or can: the momentum that the step restores must not divide by an inertia of round-off.
TEST(Midpoint, ABodyThatDoesNotTurnFliesAlongItsParabola) {
  for (const bool fixed_rotation : {true, false}) {
    SpatialWorld<double> world(by(Integrator::implicit, -g));
    SpatialBodyDefinition body{
        .x = 0.421, .y = -0.341, .z = 0.873, .vx = 0.761, .vy = -0.77, .vz = 0.932, .mass = 1.53};
    body.fixed_rotation = fixed_rotation;
    if (!fixed_rotation) body.inertia = {1, 1, 1, 0, 0, 0};
    const int ball = world.add_body(body);
    for (int k = 1; k <= 60; ++k) {
      ASSERT_TRUE(world.step(h));
      const double t = k * h;
      EXPECT_NEAR(world.pose(ball).y, body.y + body.vy * t - g * t * t / 2, 1e-13) << t;
      EXPECT_NEAR(world.velocity(ball).y, body.vy - g * t, 1e-13) << t;
      EXPECT_NEAR(world.velocity(ball).x, body.vx, 1e-13) << t;
    }
    const Balance balance = world.balance();
    EXPECT_LT(balance.linear.error, 1e-13 * balance.linear.scale);
    EXPECT_LE(balance.angular.error, 1e-9 * balance.angular.scale);  // round-off of a body that does not spin
  }
}

// Light links between loads of some hundred kg, both ends fixed: 2 m of slack in 20 m.
TEST(Midpoint, ALoadedBridgeKeepsItsEnergy) {
  World<double> world(by(Integrator::implicit, -g));
  std::vector<Point> points;
  for (int i = 0; i <= 20; ++i) points.push_back({0.99 * i, -2 + 2 * std::pow((i - 10) / 10.0, 2)});
  add_bars(world, points, std::vector<double>(20, 1.0));
  pin(world, world.ground(), 0, points.front().x, points.front().y);
  pin(world, 19, world.ground(), points.back().x, points.back().y);
  for (const auto& [at, mass] : {std::pair{5, 300.0}, {10, 500.0}, {15, 200.0}}) {
    const int load = world.add_body({.x = points[at].x, .y = points[at].y - 0.5, .mass = mass, .inertia = 0.05 * mass});
    pin(world, at - 1, load, points[at].x, points[at].y);
  }
  const Kept kept = keeps_energy(world);
  fmt::print("  rise {:.2e}, fall {:.2e} of the kinetic energy, gap {:.1e} m\n", kept.rise, kept.fall, kept.gap);
  EXPECT_LT(kept.rise, 1e-3);
  EXPECT_LT(kept.fall, 0.1);
  EXPECT_LT(kept.gap, 1e-9);
}

// Masses of 1 : 10^6 in turn, hanging from one end or from both.
TEST(Midpoint, AlternatingMassesKeepTheirEnergy) {
  for (const bool both : {false, true}) {
    World<double> world(by(Integrator::implicit, -g));
    std::vector<Point> points;
    std::vector<double> masses;
    for (int i = 0; i <= 10; ++i) points.push_back({both ? 0.98 * i : i, both ? -std::sin(0.1 * pi * i) : 0.0});
    for (int i = 0; i < 10; ++i) masses.push_back(i % 2 == 0 ? 1e6 : 1);
    add_bars(world, points, masses);
    pin(world, world.ground(), 0, points.front().x, points.front().y);
    if (both) pin(world, 9, world.ground(), points.back().x, points.back().y);
    const Kept kept = keeps_energy(world);
    fmt::print("  {} ends: rise {:.2e}, fall {:.2e} of the kinetic energy, gap {:.1e} m\n", both ? 2 : 1, kept.rise,
               kept.fall, kept.gap);
    EXPECT_LT(kept.rise, 1e-3);
    EXPECT_LT(kept.fall, 0.1);
    EXPECT_LT(kept.gap, 1e-9);
  }
}

// A ball on a spring and a damper of any strength between points: the energy never rises, and it comes to rest where
// the spring carries it.
TEST(Midpoint, SpringsAndDampersOfAnyStrengthAreStable) {
  for (const Integrator integrator : {Integrator::euler, Integrator::implicit, Integrator::rattle}) {
    for (const double stiffness : {0.0, 1.0, 1e3, 1e6, 1e12}) {
      for (const double damping : {0.0, 1.0, 200.0, 1e6, 1e12}) {
        if (stiffness + damping == 0) continue;
        if (integrator == Integrator::rattle && stiffness > 1e3) continue;  // its springs are explicit
        World<double> world(by(integrator, -g));
        const int ball = world.add_body({.x = 0.3, .y = -1, .mass = 1, .inertia = 0.1});
        world.add_spring({.body_a = world.ground(),
                          .body_b = ball,
                          .stiffness = stiffness,
                          .rest_length = std::hypot(0.3, 1.0),
                          .damping = damping});
        double most = 0;
        for (int k = 0; k < 600; ++k) {
          ASSERT_TRUE(world.step(h));
          most = std::max(most, kinetic(world) + g * (world.pose(ball).y + 1));
        }
        EXPECT_LT(most, 0.05) << "J of 10 J, " << int(integrator) << ": k " << stiffness << ", d " << damping;
      }
    }
  }
}

// Springs with h^2 k / m = 2.8e4 and more. In the middle of every step they would turn the error into its opposite.
TEST(Midpoint, SpringsTooStiffForTheStepReachTheirLength) {
  for (const double stiffness : {1e8, 1e12}) {
    World<double> world(by(Integrator::implicit));
    const int ball = world.add_body({.x = 1.1, .mass = 1, .inertia = 0.1});
    world.add_spring({.body_a = world.ground(), .body_b = ball, .stiffness = stiffness, .rest_length = 1});
    run(world, 10 * h, h);
    EXPECT_NEAR(world.pose(ball).x, 1, 1e-4);
    EXPECT_NEAR(world.velocity(ball).x, 0, 1e-2);
  }
}

// x'' = -(d x' + k x) / m from x = 1 at rest, of second order in both methods; d from none to aperiodic.
TEST(Midpoint, DampedSpringsAreOfSecondOrder) {
  const double m = 2, k = 50, until = 1;
  for (const Integrator integrator : {Integrator::implicit, Integrator::rattle}) {
    for (const double d : {0.0, 2.0, 15.0, 40.0}) {
      const double decay = d / (2 * m), square = k / m - decay * decay, w = std::sqrt(std::abs(square));
      const double c = square > 0 ? std::cos(w * until) : std::cosh(w * until);
      const double s = square > 0 ? std::sin(w * until) : std::sinh(w * until);
      const double exact = std::exp(-decay * until) * (c + decay / w * s);
      double error[3];
      for (int n = 0; n < 3; ++n) {
        World<double> world(by(integrator));
        const int ball = world.add_body({.x = 3, .mass = m, .inertia = 1});
        world.add_spring({.body_a = world.ground(), .body_b = ball, .stiffness = k, .rest_length = 2, .damping = d});
        run(world, until, 0.01 / (1 << n));
        error[n] = std::abs(world.pose(ball).x - 2 - exact);
      }
      fmt::print("  {} d = {}: {:.2e} {:.2e} {:.2e}\n", int(integrator), d, error[0], error[1], error[2]);
      EXPECT_NEAR(std::log2(error[0] / error[1]), 2, 0.1);
      EXPECT_NEAR(std::log2(error[1] / error[2]), 2, 0.1);
    }
  }
}

// A spring of rest length 0 is linear in both directions: an ellipse about its point, through any length.
TEST(Midpoint, ASpringOfRestLengthZeroMovesOnAnEllipse) {
  World<double> world(by(Integrator::implicit));
  const int ball = world.add_body({.x = 1, .vy = 0.5, .mass = 2, .inertia = 1});
  world.add_spring({.body_a = world.ground(), .body_b = ball, .stiffness = 8});
  for (int k = 1; k <= 2000; ++k) {
    ASSERT_TRUE(world.step(1e-3));
    EXPECT_NEAR(world.pose(ball).x, std::cos(2 * k * 1e-3), 2e-6);  // (h w)^2 / 12 of the phase
    EXPECT_NEAR(world.pose(ball).y, 0.25 * std::sin(2 * k * 1e-3), 2e-6);
  }
}

// A rod thrown against the limit of its pin stops there, and does not bounce.
TEST(Midpoint, ALimitStopsWithoutABounce) {
  World<double> world(by(Integrator::implicit));
  const int bar = world.add_body(rod(0.5, 0, 0));
  const int joint = revolute(world, world.ground(), bar, 0, 0, -0.5, 0);
  add_limit(world, joint, "angle", {.lower = -1, .upper = 0.4});
  world.set_velocity(bar, {0, 1.5, 3});
  for (int k = 0; k < 60; ++k) {
    ASSERT_TRUE(world.step(h));
    EXPECT_LT(world.coordinate(joint, "angle"), 0.4 + 1e-9);
    EXPECT_GT(world.velocity(bar).w, -1e-9);
  }
  EXPECT_NEAR(world.coordinate(joint, "angle"), 0.4, 1e-9);
  EXPECT_NEAR(world.velocity(bar).w, 0, 1e-9);
}

// A fast rod needs steps in parts, whose sum is one step, whatever its length.
TEST(Midpoint, PartsOfAStepFillIt) {
  constexpr double spin = 40;
  double worst = 0;
  for (double step = 0.041; step < 0.095; step += 0.002) {
    World<double> world(by(Integrator::implicit));
    const int bar = world.add_body(rod(0.5, 0, 0));
    revolute(world, world.ground(), bar, 0, 0, -0.5, 0);
    world.set_velocity(bar, {0, spin / 2, spin});
    for (int k = 0; k < 20; ++k) {
      const double before = world.pose(bar).angle;
      ASSERT_TRUE(world.step(step));
      worst = std::max(worst, std::abs((world.pose(bar).angle - before) / (spin * step) - 1));
    }
  }
  fmt::print("  turns off by at most {:.1e} of a step\n", worst);
  EXPECT_LT(worst, 0.04);
}

// Nothing changes on a level rail but round-off, which is no work of the joint.
TEST(Midpoint, ACartOnARailTakesWholeSteps) {
  World<double> world(by(Integrator::implicit, -g));
  const int cart = world.add_body({.y = 2, .vx = 0.6, .mass = 3, .inertia = 0.05});
  world.add_joint({"prismatic", {world.ground(), cart}, {{"pa", {0, 2}}, {"pb", {0, 0}}, {"t", {0, 1}}}, {}});
  run(world, 0.7, 0.001);
  EXPECT_EQ(world.step_counts().rescued, 0);
  EXPECT_NEAR(world.place(cart).x, 0.6 * 0.7, 1e-13);
}

// From rest, a motor without a bound has its speed in the first step.
TEST(Midpoint, AMotorTurnsAtItsSpeed) {
  World<double> world(by(Integrator::implicit, -g));
  const int bar = world.add_body(rod(0.5, 0, 0));
  const int joint = revolute(world, world.ground(), bar, 0, 0, -0.5, 0);
  add_motor(world, joint, "angle", {.speed = 2});
  for (int k = 1; k <= 300; ++k) {
    ASSERT_TRUE(world.step(h));
    EXPECT_NEAR(world.coordinate(joint, "angle"), 2 * k * h, 1e-4);
  }
}

}  // namespace
}  // namespace cdot::test::midpoint_test
