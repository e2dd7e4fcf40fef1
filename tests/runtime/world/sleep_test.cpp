// Islands at rest fall asleep, and every change of an island wakes it. (cost_test.cpp tests that sleep costs nothing.)
#include "tests/runtime/support.hpp"

namespace cdot::test {
namespace {

Settings sleepy(Solver solver) {
  Settings s = settings(solver, Drift::projection, -9.81);
  s.sleep_after = 0.5;
  return s;
}

// A pendulum that hangs at rest, and one that swings.
struct TwoPendulums {
  explicit TwoPendulums(Solver solver) : world(sleepy(solver)) {
    resting = add_chain(world, 2, -pi / 2).back();
    swinging = add_chain(world, 2, -0.3).back();
  }
  World<double> world;
  int resting, swinging;
};

TEST(Sleep, OnlyIslandsAtRestFallAsleep) {
  for (Solver solver : {Solver::direct, Solver::iterative}) {
    TwoPendulums two(solver);
    run(two.world, 0.4, 0.01);
    EXPECT_EQ(two.world.sleeping_islands(), 0);
    run(two.world, 1, 0.01);
    EXPECT_TRUE(two.world.asleep(two.resting));
    EXPECT_FALSE(two.world.asleep(two.swinging));
    EXPECT_EQ(two.world.sleeping_islands(), 1);
    const auto before = two.world.pose(two.resting);
    run(two.world, 1, 0.01);
    EXPECT_EQ(two.world.pose(two.resting).x, before.x);
    EXPECT_EQ(two.world.pose(two.resting).y, before.y);
  }
}

TEST(Sleep, NeverUnlessAskedFor) {
  World<double> world(settings(Solver::direct, Drift::projection, -9.81));
  add_chain(world, 2, -pi / 2);
  run(world, 5, 0.01);
  EXPECT_EQ(world.sleeping_islands(), 0);
}

TEST(Sleep, EveryTouchWakes) {
  for (int touch = 0; touch < 6; ++touch) {
    TwoPendulums two(Solver::direct);
    run(two.world, 1, 0.01);
    ASSERT_TRUE(two.world.asleep(two.resting));
    const auto q = two.world.pose(two.resting);
    if (touch == 0) two.world.apply_impulse(two.resting, {1, 0, 0});
    if (touch == 1) two.world.set_velocity(two.resting, {1, 0, 0});
    if (touch == 2) two.world.set_force(two.resting, {3, 0, 0});
    if (touch == 3) two.world.set_pose(two.resting, {q.x + 0.1, q.y, q.angle});
    if (touch == 4) two.world.set_pose(two.world.ground(), {0.1, 0, 0});
    if (touch == 5)  // a spring to a moving body
      two.world.add_spring({.body_a = two.resting, .body_b = two.swinging, .stiffness = 20});
    two.world.step(0.01);
    EXPECT_FALSE(two.world.asleep(two.resting)) << touch;
    run(two.world, 0.2, 0.01);
    EXPECT_GT(std::abs(two.world.velocity(two.resting).x), 1e-2) << touch;
  }
}

TEST(Sleep, ATouchOfOneIslandLeavesTheOthersAsleep) {
  World<double> world(sleepy(Solver::direct));
  std::vector<int> ends;
  for (int i = 0; i < 5; ++i) ends.push_back(add_chain(world, 2, -pi / 2).back());
  run(world, 1, 0.01);
  EXPECT_EQ(world.sleeping_islands(), 5);
  world.apply_impulse(ends[2], {1, 0, 0});
  EXPECT_EQ(world.sleeping_islands(), 4);
  world.step(0.01);
  EXPECT_FALSE(world.asleep(ends[2]));
  EXPECT_TRUE(world.asleep(ends[1]));
}

TEST(Sleep, WakingGoesOnAsIfItHadNotSlept) {
  TwoPendulums slept(Solver::direct);
  World<double> awake(settings(Solver::direct, Drift::projection, -9.81));
  const int resting = add_chain(awake, 2, -pi / 2).back();
  run(slept.world, 2, 0.01);
  run(awake, 2, 0.01);
  slept.world.apply_impulse(slept.resting, {1, 0, 0});
  awake.apply_impulse(resting, {1, 0, 0});
  run(slept.world, 1, 0.01);
  run(awake, 1, 0.01);
  EXPECT_NEAR(slept.world.pose(slept.resting).x, awake.pose(resting).x, 1e-9);
}

// --- Slow is not at rest: an island sleeps only where it would stay by itself.

struct Method {
  Solver solver;
  Integrator integrator;
};
const Method all_methods[] = {{Solver::direct, Integrator::euler},    {Solver::direct, Integrator::implicit},
                              {Solver::direct, Integrator::rattle},   {Solver::direct, Integrator::rk4},
                              {Solver::direct, Integrator::dop853},   {Solver::iterative, Integrator::euler},
                              {Solver::iterative, Integrator::rattle}};

Settings weightless(const Method& method) {
  Settings s = settings(method.solver, Drift::projection, 0);
  s.integrator = method.integrator;
  s.sleep_after = 0.2;
  return s;
}

// A rod on the ground, so heavy that its effects need longer than sleep_after to move it.
template <class T = double>
struct HeavyRod {
  explicit HeavyRod(const Settings& settings) : world(settings) {
    rod = world.add_body({.x = 0.5, .mass = 1e4, .inertia = 1e4 / 12});
    joint = world.add_joint({"revolute", {world.ground(), rod}, {{"pa", {0, 0}}, {"pb", {-0.5, 0}}}, {}});
  }
  World<T> world;
  int rod, joint;
};
constexpr double inertia_of_heavy_rod = 1e4 / 3;  // about the ground's pin

TEST(Sleep, NeverUnderAForceThatNothingBalances) {
  for (const Method& method : all_methods) {
    World<double> world(weightless(method));
    const int body = world.add_body({.mass = 1e4, .inertia = 1e3, .force_x = 5});
    run(world, 10, 0.01);
    EXPECT_NEAR(world.pose(body).x, 0.5 * 5e-4 * 10 * 10, 3e-5);
    HeavyRod<> loaded(weightless(method));
    add_effect(loaded.world, loaded.joint, "angle", Load{.force = 1});
    run(loaded.world, 10, 0.01);
    EXPECT_NEAR(loaded.world.pose(loaded.rod).angle, 0.5 / inertia_of_heavy_rod * 100, 3e-5);
  }
}

TEST(Sleep, NeverUnderAMotorThatCanTurn) {
  for (const Method& method : all_methods) {
    HeavyRod<> weak(weightless(method));
    add_motor(weak.world, weak.joint, "angle", {.speed = 1, .max_force = 2});
    run(weak.world, 10, 0.01);
    EXPECT_NEAR(weak.world.pose(weak.rod).angle, 0.5 * 2 / inertia_of_heavy_rod * 100, 5e-5);
    HeavyRod<> slow(weightless(method));
    add_motor(slow.world, slow.joint, "angle", {.speed = 5e-4, .max_force = 1e6});
    run(slow.world, 10, 0.01);
    EXPECT_NEAR(slow.world.pose(slow.rod).angle, 5e-3, 1e-5);
  }
}

// Also at a rate of 0, which may grow.
TEST(Sleep, NeverWhileAJointDependsOnTime) {
  for (const Method& method : all_methods) {
    for (const double rate : {5e-4, 0.0}) {
      World<double> world(weightless(method));
      const int crank = world.add_body({.x = 0.5, .vy = 0.5 * rate, .w = rate, .mass = 1, .inertia = 0.1});
      world.add_joint(
          {"driven_crank", {world.ground(), crank}, {{"pa", {0, 0}}, {"pb", {-0.5, 0}}, {"rate", {rate}}}, {}});
      run(world, 2, 0.01);
      EXPECT_FALSE(world.asleep(crank));
      EXPECT_NEAR(world.pose(crank).angle, 2 * rate, 1e-9);
    }
  }
}

TEST(Sleep, UnderForcesThatBalance) {
  for (const Method& method : all_methods) {
    HeavyRod<> stalled(weightless(method));
    add_motor(stalled.world, stalled.joint, "angle", {.speed = 1, .max_force = 2});
    add_limit(stalled.world, stalled.joint, "angle", {.lower = {}, .upper = 0});
    HeavyRod<> stuck(weightless(method));
    add_effect(stuck.world, stuck.joint, "angle", Load{.force = 1});
    add_friction(stuck.world, stuck.joint, "angle", {.max_force = 2});
    for (HeavyRod<>* one : {&stalled, &stuck}) {
      run(one->world, 1, 0.01);
      EXPECT_TRUE(one->world.asleep(one->rod)) << name_of(integrators, method.integrator);
      EXPECT_NEAR(one->world.pose(one->rod).angle, 0, 1e-6);
    }
  }
}

// The bound of "slower" is sleep_speed, for every body and in every direction.
TEST(Sleep, AtSpeedsBelowTheLimitOnly) {
  for (const double speed : {0.9e-3, 1.1e-3}) {
    for (int direction = 0; direction < 3; ++direction) {
      World<double> world(weightless({Solver::direct, Integrator::euler}));
      const double v[3] = {direction == 0 ? speed : 0, direction == 1 ? speed : 0, direction == 2 ? speed : 0};
      const int body = world.add_body({.vx = v[0], .vy = v[1], .w = v[2], .mass = 1, .inertia = 1});
      run(world, 1, 0.01);
      EXPECT_EQ(world.asleep(body), speed < 1e-3) << direction;
    }
  }
}

// A touch ends the rest, even one that leaves the body slower than sleep_speed.
TEST(Sleep, ATouchedIslandRestsAnew) {
  World<double> world(weightless({Solver::direct, Integrator::euler}));
  const int body = world.add_body({.mass = 1, .inertia = 1});
  run(world, 1, 0.01);
  ASSERT_TRUE(world.asleep(body));
  world.apply_impulse(body, {5e-4, 0, 0});
  run(world, 0.15, 0.01);
  EXPECT_FALSE(world.asleep(body));
  run(world, 0.1, 0.01);
  EXPECT_TRUE(world.asleep(body));
}

// Round-off of single precision is no motion, and a small force is.
TEST(Sleep, InSinglePrecision) {
  Settings s = sleepy(Solver::direct);
  World<float> hanging(s);
  int before = hanging.ground();
  for (int i = 0; i < 3; ++i) {
    const int link =
        hanging.add_body({.x = 0.5 * std::sin(0.0), .y = -0.5 - i, .angle = -pi / 2, .mass = 1, .inertia = 1.0 / 12});
    hanging.add_joint({"revolute", {before, link}, {{"pa", {i ? 0.5 : 0.0, 0}}, {"pb", {-0.5, 0}}}, {}});
    before = link;
  }
  run(hanging, 3, 0.01);
  EXPECT_TRUE(hanging.asleep(before));
  World<float> pushed(weightless({Solver::direct, Integrator::euler}));
  const int body = pushed.add_body({.mass = 1e4, .inertia = 1e3, .force_x = 5});
  run(pushed, 10, 0.01);
  EXPECT_NEAR(pushed.pose(body).x, 0.025, 1e-4);
}

// A body that turns in space wakes with the spin 0 that it slept with.
TEST(Sleep, ABodyThatTurnsInSpaceLosesItsSpin) {
  Settings s = weightless({Solver::direct, Integrator::euler});
  SpatialWorld<double> world(s);
  const int body = world.add_body({.wx = 5e-4, .wy = 5e-4, .mass = 1, .inertia = {1, 2, 3}});
  for (int i = 0; i < 50; ++i) world.step(0.01);
  ASSERT_TRUE(world.asleep(body));
  world.set_force(body, {1e-3, 0, 0});
  world.step(0.01);
  EXPECT_EQ(world.velocity(body).wx, 0);
  EXPECT_EQ(world.velocity(body).wy, 0);
}

}  // namespace
}  // namespace cdot::test
