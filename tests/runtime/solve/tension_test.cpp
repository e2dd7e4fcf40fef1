// Stiffness from tension between bodies in the linearly implicit step: beads on bars, without the bodies' own
// rotations. First closed forms, then a heavy load on a light chain at 1/60 s.
#include <cmath>
#include <fmt/core.h>
#include <utility>
#include <vector>

#include "tests/runtime/spatial_support.hpp"

namespace cdot::test {
namespace {

constexpr double g = 9.81, h = 1.0 / 60;

Settings implicit(Drift drift = Drift::projection) {
  Settings s = settings(Solver::direct, drift, -g);
  s.integrator = Integrator::implicit;
  return s;
}

int bar(World<double>& world, int a, int b, std::vector<double> pa = {0, 0}, std::vector<double> pb = {0, 0}) {
  return world.add_joint({"distance", {a, b}, {{"pa", pa}, {"pb", pb}}, {}});
}

// A pendulum at rest has the tension m g, for every length of the last step. After a transverse push the force is m g /
// l times the way of the step: v' = v / (1 + h^2 g / l).
TEST(Tension, OfABarSlowsTheMotionAcrossIt) {
  for (const double length : {0.5, 2.0}) {
    World<double> world(implicit(Drift::none));
    const int bead = world.add_body({.y = -length, .mass = 3});
    const int joint = bar(world, world.ground(), bead);
    world.step(0.3 * h);
    EXPECT_NEAR(-world.reaction(joint, world.ground()).force_y, 3 * g, 1e-12);
    world.apply_impulse(bead, {3 * 0.2, 0, 0});
    world.step(h);
    EXPECT_NEAR(world.velocity(bead).x, 0.2 / (1 + h * h * g / length), 1e-14);
    EXPECT_NEAR(world.velocity(bead).y, 0, 1e-14);
    // The bar's force in its new direction changed the momentum.
    EXPECT_NEAR(-world.reaction(joint, world.ground()).force_x, 3 * (world.velocity(bead).x - 0.2) / h, 1e-4);
  }
}

// The same in space, in both transverse directions, with the bar at an arm of a body with fixed rotation.
TEST(Tension, OfABarSlowsTheMotionAcrossItInSpace) {
  Settings s = implicit(Drift::none);
  s.gravity_y = 0, s.gravity_z = -g;
  SpatialWorld<double> world(s);
  SpatialBodyDefinition d;
  d.z = -1.5, d.mass = 3, d.inertia = {1, 1, 1}, d.fixed_rotation = true;
  const int box = world.add_body(d);
  join(world, "distance", world.ground(), box, {{"pa", {0, 0, 0}}, {"pb", {0, 0, 0.5}}});
  world.step(h);
  world.apply_impulse(box, {3 * 0.2, -3 * 0.1, 0, 0, 0, 0});
  world.step(h);
  const double slowed = 1 / (1 + h * h * g / 1.0);
  EXPECT_NEAR(world.velocity(box).x, 0.2 * slowed, 1e-14);
  EXPECT_NEAR(world.velocity(box).y, -0.1 * slowed, 1e-14);
}

// A rod of mass m hangs by its end, r above its centre, on a bar of length l. After a push the step solves the 2 x 2
// system of both rotations,
//   m (x' - x) = -h^2 m g / l (x' - r w'),   I (w' - w) = h^2 m g r / l (x' - r w') - h^2 m g r w'.
TEST(Tension, OfABarActsAtItsArm) {
  const double m = 2, I = 0.3, l = 0.7, r = 0.4, k = h * h * m * g;
  World<double> world(implicit(Drift::none));
  const int rod = world.add_body({.y = -l - r, .mass = m, .inertia = I});
  bar(world, world.ground(), rod, {0, 0}, {0, r});
  world.step(h);
  world.apply_impulse(rod, {m * 0.3, 0, I * 0.5});
  world.step(h);
  const double xx = m + k / l, xw = -k * r / l, ww = I + k * r * r / l + k * r, det = xx * ww - xw * xw;
  EXPECT_NEAR(world.velocity(rod).x, (ww * m * 0.3 - xw * I * 0.5) / det, 1e-13);
  EXPECT_NEAR(world.velocity(rod).w, (xx * I * 0.5 - xw * m * 0.3) / det, 1e-13);
}

// Ten beads of 1 kg, the last on the load. Returns the load.
template <class T>
int add_beads(World<T>& world, double load) {
  int above = world.ground();
  for (int i = 1; i <= 11; ++i) {
    const int bead = world.add_body({.y = -double(i), .mass = i == 11 ? load : 1, .inertia = 0.1});
    distance(world, above, bead, 1);
    above = bead;
  }
  return above;
}

// A second, equal bar adds no stiffness, and its row is redundant.
TEST(Tension, LeavesRedundantRowsToTheJoints) {
  World<double> once(implicit()), twice(implicit());
  for (World<double>* world : {&once, &twice}) {
    const int load = add_beads(*world, 1e3);
    if (world == &twice) distance(*world, load - 1, load, 1);
    run(*world, 0.2, h);
    world->apply_impulse(load, {1e3, 0, 0});
    run(*world, 2, h);
  }
  EXPECT_EQ(once.redundant_rows(), 0);
  EXPECT_EQ(twice.redundant_rows(), 1);
  EXPECT_LT(apart(once, twice), 1e-9);
}

// At 1e14 N a bar's transverse stiffness equals rigidity up to round-off; the transverse bar is rigid.
TEST(Tension, DoesNotCountAsRedundant) {
  World<double> world(implicit());
  const int bead = world.add_body({.y = -1, .mass = 1, .inertia = 1, .force_y = -1e14});
  bar(world, world.ground(), bead, {-1, 0});
  bar(world, world.ground(), bead, {1, 0});
  run(world, 0.5, h);
  EXPECT_EQ(world.redundant_rows(), 0);
  EXPECT_NEAR(world.reaction(0, world.ground()).force_y / -0.5e14, 1, 1e-9);
  EXPECT_NEAR(world.pose(bead).y, -1, 1e-12);
}

TEST(Tension, HoldsAHeavyLoadOnBeads) {
  for (const double mass : {1e3, 1e6}) {
    World<double> world(implicit());
    const int load = add_beads(world, mass);
    run(world, 0.2, h);
    EXPECT_NEAR(-world.reaction(0, world.ground()).force_y / ((10 + mass) * g), 1, 1e-9);
    world.apply_impulse(load, {mass, 0, 0});
    const double start = world.energy();
    double gap = 0, rise = 0;
    for (int i = 0; i < 600; ++i) {
      world.step(h);
      gap = std::max(gap, world.worst_position_error().value);
      rise = std::max(rise, world.energy() - start);
    }
    fmt::print("  {:.0e} kg: gap {:.1e} m, gained {:.1e} of the kick's energy\n", mass, gap, rise / (0.5 * mass));
    EXPECT_LT(gap, 1e-3);
    EXPECT_LT(rise, 1e-3 * 0.5 * mass);
  }
}

// 100 beads on 101 bars between two points, in equilibrium: the force in bar k is (H, m g (k - 50)), where H follows
// from the distance of the points.
TEST(Tension, LeavesAHangingChainWhereItIs) {
  constexpr int beads = 100;
  constexpr double length = 0.1, mass = 0.1, span = 6;
  const auto direction = [&](int bar, double H) {
    const double V = mass * g * (bar - 0.5 * beads), force = std::hypot(H, V);
    return std::pair{length * H / force, length * V / force};
  };
  double low = 1e-3, high = 1e3;
  for (int round = 0; round < 200; ++round) {
    const double middle = 0.5 * (low + high);
    double reach = 0;
    for (int bar = 0; bar <= beads; ++bar) reach += direction(bar, middle).first;
    (reach < span ? low : high) = middle;
  }
  World<double> world(implicit());
  int before = world.ground();
  double x = 0, y = 0;
  for (int k = 0; k < beads; ++k) {
    x += direction(k, low).first, y += direction(k, low).second;
    const int bead = world.add_body({.x = x, .y = y, .mass = mass, .inertia = 1e-5});
    distance(world, before, bead, length);
    before = bead;
  }
  world.add_joint({"distance", {before, world.ground()}, {{"pa", {0, 0}}, {"pb", {span, 0}}, {"l", {length}}}, {}});
  const World<double>& seen = world;
  std::vector<std::pair<double, double>> start;
  for (int i = 0; i < world.body_count(); ++i) start.emplace_back(seen.pose(i).x, seen.pose(i).y);
  run(world, 10, h);
  double moved = 0;
  for (int i = 0; i < world.body_count(); ++i)
    moved = std::max(moved, std::hypot(seen.pose(i).x - start[i].first, seen.pose(i).y - start[i].second));
  fmt::print("  moved by {:.1e} m in 10 s, H = {:.6f} N\n", moved, low);
  EXPECT_LT(moved, 1e-6);
  EXPECT_NEAR(world.reaction(0, world.ground()).force_x / low, 1, 1e-6);
}

// A point of b on a surface of a that hardly bends, both free: b turns, and pulls a by round-off alone.
TEST(Tension, OfAHardlyBentSurfaceHoldsNoRotation) {
  Settings s = implicit(Drift::baumgarte);
  s.gravity_y = 0;
  SpatialWorld<float> world(s);
  SpatialBodyDefinition a, b;
  a.mass = b.mass = 1;
  a.x = -0.001, a.y = 0.0004, a.z = -0.0002;
  a.inertia = {9e-8, 7e-8, 7e-8, 2e-8, 1e-8, -3e-8};
  b.x = -0.0009, b.y = -0.002, b.z = -0.0006, b.wx = 0.5, b.wy = 0.06, b.wz = 0.1;
  b.inertia = {2e-7, 3e-7, 3e-7, -3e-8, 4e-8, 5e-8};
  const std::vector<int> bodies = {world.add_body(a), world.add_body(b)};
  world.add_joint({"surface",
                   bodies,
                   {{"pa", {-8e-5, -0.0004, -4e-6}},
                    {"pb", {0.0003, -0.0004, -0.0003}},
                    {"fa", {-0.8, -0.3, -0.6, -0.2, 1, -0.2}},
                    {"height", {0.0008}},
                    {"k", {0.5}}},
                   {}});
  world.project(1e-5);
  const double start = world.energy();
  run(world, 4 * 0.03, 0.03);
  EXPECT_NEAR(world.energy() / start, 1, 1e-3);
}

// A fixed angle holds a pendulum against a constant torque. The joint exerts that torque, although tension adds 5.4
// times the body's inertia.
TEST(Tension, KeepsATorqueAtRest) {
  World<double> world(implicit());
  const int body = world.add_body({.y = -2, .mass = 1000, .inertia = 1, .torque = 5});
  const int pin = revolute(world, world.ground(), body, 0, 0, 0, 2);
  const int angle = world.add_joint({"angle", {world.ground(), body}, {}, {}});
  run(world, 10 * h, h);
  EXPECT_NEAR(world.reaction(angle, body).torque, -5, 1e-9);
  EXPECT_NEAR(world.reaction(pin, body).force_y, 1000 * g, 1e-6);
  EXPECT_NEAR(world.velocity(body).w, 0, 1e-12);
}

}  // namespace
}  // namespace cdot::test
