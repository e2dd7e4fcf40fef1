// Energy is checked without any joint: bodies that only springs, dampers, forces and torques move.
#include <fmt/core.h>

#include <cdot/balance.hpp>

#include "tests/runtime/balance/method.hpp"
#include "tests/runtime/spatial_support.hpp"

namespace cdot::test::free_bodies_test {
namespace {

// Three bodies on springs beside their centres, one of them tied to the ground; a force and a torque on another.
template <class W>
void hang(W& world) {
  const int first = world.add_body({.x = 1, .y = 0.2, .vx = 0.5, .w = 2, .mass = 1, .inertia = 0.3});
  const int second =
      world.add_body({.x = 2.2, .y = -0.4, .mass = 3, .inertia = 0.5, .force_x = 4, .force_y = 1, .torque = 0.7});
  const int third = world.add_body({.x = 3, .y = 1, .w = -3, .mass = 0.5, .inertia = 0.1});
  world.add_spring({.body_a = world.ground(), .body_b = first, .bx = -0.3, .by = 0.1, .stiffness = 60, .damping = 1.5});
  world.add_spring(
      {.body_a = first, .body_b = second, .ax = 0.4, .bx = -0.2, .by = 0.3, .stiffness = 25, .rest_length = 1});
  world.add_spring(
      {.body_a = second, .body_b = third, .ax = 0.2, .bx = 0.1, .stiffness = 40, .rest_length = 0.8, .damping = 3});
}

TEST(FreeBodies, EnergyIsAccountedFor) {
  for (const Method& method : methods()) {
    World<double> world(method.settings(-9.81));
    hang(world);
    BalanceWatch watch;
    watch.look(world.balance());
    for (int k = 0; k < 2000; ++k) {
      ASSERT_TRUE(world.step(1e-3));
      watch.look(world.balance());
    }
    fmt::print("  {}: {:.1e} of the energies, {:.3g} J taken\n", method.name(), watch.energy.share(), watch.last.taken);
    EXPECT_LT(watch.energy.share(), method.order() == 1 ? 2.5e-2 : 1e-4) << method.name();
    EXPECT_GT(watch.last.taken, 1) << method.name();
  }
}

// Two bodies turn about each other on a soft pin that opens.
Balance turn_on_a_pin(const Method& method, const Softness& soft) {
  World<double> world(method.settings());
  const int a = world.add_body({.x = -1, .vy = -0.5, .mass = 1, .inertia = 0.4});
  const int b = world.add_body({.x = 1, .vy = 1, .w = 2, .mass = 2, .inertia = 0.3});
  world.add_joint({"revolute", {a, b}, {{"pa", {1, 0}}, {"pb", {-1, 0}}}, soft});
  for (int k = 0; k < 500; ++k) EXPECT_TRUE(world.step(1e-3));
  return world.balance();
}

// The rows x and y of a pin have the force -k_x C_x, -k_y C_y, along C only if k_x = k_y. By frequency k_r = w^2 /
// K_rr.
TEST(FreeBodies, OnlyEqualSpringsOfAVectorKeepTheSpin) {
  for (const Method& method : methods()) {
    if (method.solver == Solver::iterative) continue;
    const Balance equal = turn_on_a_pin(method, {.by_frequency = false, .stiffness = 20});
    EXPECT_EQ(equal.angular.body, 0) << method.name();
    const double torque = method.order() == 1 ? 3e-3 : 1e-5;
    EXPECT_LT(equal.angular.error, torque * equal.angular.scale) << method.name();
    EXPECT_EQ(turn_on_a_pin(method, {.frequency = 1}).angular.body, -1) << method.name();
  }
}

// The stiffness of tension holds back what turns, but not the whole mechanism. The midpoint rule needs no such care.
TEST(FreeBodies, TurnAsFastUnderEveryImplicitStep) {
  for (const Method& method : methods()) {
    if (method.integrator != Integrator::implicit) continue;
    for (const Drift drift : {Drift::none, Drift::baumgarte, Drift::projection}) {
      World<double> world(Settings{.solver = method.solver, .integrator = method.integrator, .drift = drift});
      const int a = world.add_body({.x = -1, .vy = -2, .w = 2, .mass = 1, .inertia = 0.4});
      const int b = world.add_body({.x = 1, .vy = 2, .w = 2, .mass = 1, .inertia = 0.3});
      world.add_joint({"weld", {a, b}, {{"pa", {1, 0}}, {"pb", {-1, 0}}}, {}});
      for (int k = 0; k < 200; ++k) ASSERT_TRUE(world.step(0.02));
      const Balance balance = world.balance();
      EXPECT_EQ(balance.angular.body, a);
      EXPECT_LT(balance.angular.error, 1e-11 * balance.angular.scale) << method.name() << name_of(drifts, drift);
    }
  }
}

// A chain of three bodies turns in the air. Sweeps without drift correction leave gaps, and then the last body is let
// go: the others still turn freely. A World that takes the state back finds the same, though its own joints are closed.
// Soft joints open as well.
void turn_beside_a_gap(const std::optional<Softness>& soft) {
  const Settings settings{.solver = Solver::iterative, .integrator = Integrator::implicit, .drift = Drift::none};
  const auto chain = [&] {
    World<double> world(settings);
    for (int k = 0; k < 3; ++k) world.add_body({.x = k - 0.4, .vy = 2.0 * k, .w = 2, .mass = 1.0 + k, .inertia = 0.2});
    for (int k = 0; k < 2; ++k) world.add_joint({"revolute", {k, k + 1}, {{"pa", {0.5, 0}}, {"pb", {-0.5, 0}}}, soft});
    return world;
  };
  const auto spin_of_two = [](const World<double>& world) {
    double x = 0, y = 0, vx = 0, vy = 0, spin = 0;
    for (int k = 0; k < 2; ++k) {
      const auto q = world.pose(k);
      const auto v = world.velocity(k);
      const double share = (1.0 + k) / 3;
      x += share * q.x, y += share * q.y, vx += share * v.x, vy += share * v.y;
      spin += (1.0 + k) * (q.x * v.y - q.y * v.x) + 0.2 * v.w;
    }
    return spin - 3 * (x * vy - y * vx);
  };
  World<double> world = chain();
  for (int k = 0; k < 20; ++k) ASSERT_TRUE(world.step(0.02));
  world.remove_joint(1);
  ASSERT_TRUE(world.step(0.02));
  ASSERT_GT(std::hypot(world.position_error(0)[0], world.position_error(0)[1]), 1e-4);
  World<double> other = chain();
  other.restore(Snapshot::read(world.snapshot().text()));
  const double start = spin_of_two(world);
  for (int k = 0; k < 100; ++k) ASSERT_TRUE(world.step(0.02) && other.step(0.02));
  EXPECT_EQ(world.snapshot().differences(other.snapshot()), std::vector<std::string>{});
  EXPECT_NEAR(spin_of_two(world) / start, 1, 1e-2);
}

TEST(FreeBodies, TurnAsFastBesideAGap) {
  turn_beside_a_gap({});
  turn_beside_a_gap(Softness{.by_frequency = false, .stiffness = 50});
}

// A gear against the ground holds its wheels, however far off it starts.
TEST(FreeBodies, AGearBesideAGapIsHeld) {
  World<double> world(Settings{.drift = Drift::none});
  for (int k = 0; k < 2; ++k) world.add_body({.x = 1.0 * k, .w = 1, .mass = 1, .inertia = 0.1});
  world.add_joint({"gear", {0, 1}, {{"ratio", {-0.9}}, {"phi", {0.5}}}, {}});
  ASSERT_TRUE(world.step(1e-3));
  EXPECT_EQ(world.balance().angular.body, -1);
}

// A ball is held by the liquid below it, although no force acts as long as it flies.
TEST(FreeBodies, ABallAboveALiquidIsNotFree) {
  SpatialWorld<double> world({.gravity_z = -9.81});
  const int ball = world.add_body({.z = 1, .mass = 1, .inertia = {0.01, 0.01, 0.01}});
  const int stone = world.add_body({.x = 2, .z = 1, .mass = 1, .inertia = {0.01, 0.01, 0.01}});
  world.add_joint({"buoyancy", {ball}, {{"surface", {0, 0, 0}}, {"radius", {0.1}}, {"weight", {30}}}, {}});
  for (int k = 0; k < 600; ++k) ASSERT_TRUE(world.step(1e-3));
  EXPECT_GT(world.velocity(ball).z, world.velocity(stone).z + 1);
  const Balance balance = world.balance();
  EXPECT_EQ(balance.linear.body, stone);
  EXPECT_LT(balance.linear.error, 1e-9);
}

}  // namespace
}  // namespace cdot::test::free_bodies_test
