// The balance of energy against closed forms: what drag, friction and impacts take, what motors and joints in time put
// in, and what is left to the method.
#include <functional>

#include <cdot/methods.hpp>

#include "tests/runtime/balance/method.hpp"
#include "tests/runtime/balance/watch.hpp"
#include "tests/runtime/spatial_support.hpp"

namespace cdot::test {
namespace {

// v' = -d v - g: v = (v0 + g / d) exp(-d t) - g / d.
TEST(Balance, DragTakesWhatAFallLoses) {
  const double d = 0.7, g = 9.81, duration = 1;
  const double end = g / d * (std::exp(-d * duration) - 1);
  const double y = -g / d * duration + g / d / d * (1 - std::exp(-d * duration));
  const double lost = -(g * y + end * end / 2);
  for (const Method& method : methods()) {
    World<double> world(method.settings(-g));
    world.add_body({.mass = 1, .inertia = 1, .linear_damping = d});
    const BalanceWatch seen = watch(world, duration, 1e-3);
    EXPECT_NEAR(seen.last.taken, lost, 5 * allowed(method) * lost) << method.name();
    EXPECT_LT(seen.energy.share(), 2 * allowed(method)) << method.name();

    SpatialWorld<double> space([&] {
      Settings s = method.settings();
      s.gravity_z = -g;
      return s;
    }());
    SpatialBodyDefinition brick_in_space = brick(0, 0, 0);
    brick_in_space.linear_damping = d;
    space.add_body(brick_in_space);
    EXPECT_LT(watch(space, duration, 1e-3).energy.share(), 2 * allowed(method)) << method.name();
    EXPECT_NEAR(space.balance().taken, lost, 5 * allowed(method) * lost) << method.name();
  }
}

// A motor turns a rod about its end against gravity by half a turn: m g l, and the energy of the motion.
TEST(Balance, AMotorPutsInWeightTimesHeight) {
  const double g = 9.81, speed = 1, duration = pi / speed;
  for (const Method& method : methods()) {
    World<double> world(method.settings(-g));
    const int body = world.add_body(rod(0, 0, -pi / 2));
    const int joint = revolute(world, world.ground(), body, 0, 0, -0.5, 0);
    add_motor(world, joint, "angle", {.speed = speed});
    const long steps = 3142;
    const BalanceWatch seen = watch(world, duration, duration / steps);
    const double kinetic = 0.5 * (1.0 / 12 + 0.25) * speed * speed;
    EXPECT_NEAR(seen.last.put_in, g + kinetic, 5 * allowed(method)) << method.name();
    EXPECT_NEAR(seen.last.taken, 0, 1e-9) << method.name();
    EXPECT_LT(seen.energy.share(), 3 * allowed(method)) << method.name();
  }
}

// The same by a joint that depends on time.
TEST(Balance, AJointInTimePutsInWeightTimesHeight) {
  const double g = 9.81, rate = 1, duration = pi / rate;
  for (const Method& method : methods()) {
    World<double> world(method.settings(-g));
    BodyDefinition start = rod(0, 0, -pi / 2);
    start.w = rate, start.vx = 0.5 * rate;
    const int body = world.add_body(start);
    world.add_joint(
        {"driven_crank", {world.ground(), body}, {{"pa", {0, 0}}, {"pb", {-0.5, 0}}, {"rate", {rate}}}, {}});
    const long steps = 3142;
    const BalanceWatch seen = watch(world, duration, duration / steps);
    EXPECT_NEAR(seen.last.put_in, g, 5 * allowed(method)) << method.name();
    EXPECT_NEAR(seen.last.taken, 0, 1e-9) << method.name();
    EXPECT_LT(seen.energy.share(), 2 * allowed(method)) << method.name();
  }
}

// Each substep has its own time: the crank stands where the joint wants it at the end of the step.
TEST(Balance, AJointInTimeFollowsEverySubstep) {
  const double rate = 1, h = 0.1;
  for (const Method& method : methods()) {
    Settings settings = method.settings();
    settings.substeps = 4;
    World<double> world(settings);
    BodyDefinition start = rod(0, 0, 0);
    start.w = rate, start.vy = 0.5 * rate;
    const int body = world.add_body(start);
    world.add_joint(
        {"driven_crank", {world.ground(), body}, {{"pa", {0, 0}}, {"pb", {-0.5, 0}}, {"rate", {rate}}}, {}});
    for (int k = 1; k <= 10; ++k) {
      ASSERT_TRUE(world.step(h)) << method.name();
      EXPECT_NEAR(world.place(body).angle, rate * h * k, 0.01) << method.name() << ", step " << k;
    }
  }
}

// A wheel of inertia 2 at 1 rad/s under a friction of 0.5 N m stops after 4 s: 1 J.
TEST(Balance, FrictionTakesTheEnergyOfAWheel) {
  for (const Method& method : methods()) {
    World<double> world(method.settings());
    const int wheel = world.add_body({.w = 1, .mass = 1, .inertia = 2});
    const int joint = revolute(world, world.ground(), wheel, 0, 0, 0, 0);
    add_friction(world, joint, "angle", {.max_force = 0.5});
    const BalanceWatch seen = watch(world, 5, 1e-2);
    EXPECT_NEAR(seen.last.taken, 1, 1e-3) << method.name();
    EXPECT_LT(seen.energy.share(), 1e-3) << method.name();
    EXPECT_NEAR(world.energy(), 0, 1e-9) << method.name();
  }
}

// A ball falls past the end of its rope, which then is straight: the impact takes the speed along the rope.
TEST(Balance, ARopeTakesTheSpeedAlongIt) {
  const double g = 9.81, length = 1, side = 0.6;
  const double fall = std::sqrt(length * length - side * side), along = fall / length;
  const double lost = g * fall * along * along;  // m v^2 / 2 = m g fall
  for (const Method& method : methods()) {
    World<double> world(method.settings(-g));
    const int ball = world.add_body({.x = side, .mass = 1, .inertia = 1});
    world.add_joint({"max_distance", {world.ground(), ball}, {{"pa", {0, 0}}, {"pb", {0, 0}}, {"l", {length}}}, {}});
    const BalanceWatch seen = watch(world, 0.6, 1e-4);
    EXPECT_NEAR(seen.last.taken, lost, 0.01 * lost) << method.name();
    EXPECT_LT(seen.energy.share(), 3e-3) << method.name();
  }
}

TEST(Balance, ALimitTakesTheSpeedOfWhatHitsIt) {
  for (const Method& method : methods()) {
    World<double> world(method.settings());
    const int wheel = world.add_body({.w = 1, .mass = 1, .inertia = 2});
    const int joint = revolute(world, world.ground(), wheel, 0, 0, 0, 0);
    add_limit(world, joint, "angle", {.lower = {}, .upper = 0.5});
    const BalanceWatch seen = watch(world, 1, 1e-2);
    EXPECT_NEAR(seen.last.taken, 1, 1e-9) << method.name();
    EXPECT_LT(seen.energy.share(), 1e-9) << method.name();
  }
}

// A constant torque in space has no potential: after n turns about its axis it has put in n 2 pi times itself.
TEST(Balance, ATorqueInSpacePutsInWhatItTurns) {
  for (const Method& method : methods()) {
    SpatialWorld<double> world(method.settings());
    SpatialBodyDefinition d;
    d.mass = 1, d.inertia = {2, 2, 2}, d.torque_z = 4;
    const int body = world.add_body(d);
    const BalanceWatch seen = watch(world, 4, 1e-3);  // w = 2 t, 16 rad
    EXPECT_NEAR(seen.last.put_in, 64, 0.1) << method.name();
    EXPECT_NEAR(world.velocity(body).wz, 8, 1e-9) << method.name();
    EXPECT_LT(seen.energy.share(), 1e-3) << method.name();
  }
}

// Changes from outside put in what they change, not the method.
TEST(Balance, ChangesFromOutsidePutIn) {
  for (const Method& method : methods()) {
    World<double> world(method.settings(-9.81));
    const auto rods = add_chain(world, 2, -1);
    run(world, 0.1, 1e-3);
    const double before = world.balance().put_in, energy = world.energy();
    EXPECT_EQ(before, 0) << method.name();
    const auto v = world.velocity(rods[1]);
    world.set_velocity(rods[0], {0, 0, 0});
    world.set_velocity(rods[1], {0, 0, 0});
    EXPECT_NEAR(world.balance().put_in, world.energy() - energy, 1e-12) << method.name();
    EXPECT_LT(world.balance().put_in, -1e-3);
    EXPECT_GT(std::abs(v.w), 0);
    run(world, 0.1, 1e-3);
    world.set_force(rods[1], {10, 0, 0});
    world.add_spring({.body_a = world.ground(), .body_b = rods[1], .ax = 3, .stiffness = 20, .rest_length = 1});
    run(world, 0.1, 1e-3);
    const Balance now = world.balance();
    EXPECT_LT(std::abs(now.method()), 0.1) << method.name();
    EXPECT_GT(now.put_in, 1) << method.name();
  }
}

// The balance is state: a snapshot restores it, and a failed step leaves it as it was.
TEST(Balance, GoesBackWithTheState) {
  int failed = 0;
  for (const Method& method : methods()) {
    World<double> world(method.settings(-9.81));
    const auto rods = add_chain(world, 2, -1);
    add_friction(world, 1, "angle", {.max_force = 0.5});
    run(world, 0.3, 1e-2);
    const Snapshot middle = world.snapshot();
    const Balance then = world.balance();
    EXPECT_GT(then.taken, 1e-3) << method.name();
    run(world, 0.3, 1e-2);
    const Balance end = world.balance();
    EXPECT_GT(end.taken, then.taken) << method.name();
    world.restore(middle);
    EXPECT_EQ(world.balance().taken, then.taken) << method.name();
    run(world, 0.3, 1e-2);
    EXPECT_EQ(world.balance().taken, end.taken) << method.name();
    EXPECT_EQ(world.balance().method(), end.method()) << method.name();
    if (world.step(1e200)) continue;
    ++failed;
    EXPECT_EQ(world.balance().taken, end.taken) << method.name();
  }
  EXPECT_GE(failed, 4);
}

// Momentum: of bodies that nothing holds, and only of these.
TEST(Balance, KnowsWhoseMomentumIsConserved) {
  for (const Method& method : methods()) {
    World<double> world(method.settings(-9.81));
    std::vector<int> rods;
    for (int i = 0; i < 3; ++i) rods.push_back(world.add_body(rod(i, 0, 0, 1 + i)));
    revolute(world, rods[0], rods[1], 0.5, 0, -0.5, 0);
    const int last = revolute(world, rods[1], rods[2], 0.5, 0, -0.5, 0);
    add_motor(world, last, "angle", {.speed = 2, .max_force = 0.5});
    world.apply_impulse(rods[0], {1, 2, 0.5});
    run(world, 1, 1e-3);
    Balance now = world.balance();
    EXPECT_EQ(now.linear.body, rods[0]) << method.name();
    EXPECT_GT(now.linear.scale, 10);
    EXPECT_LT(now.linear.error, 1e-9) << method.name();
    EXPECT_EQ(now.angular.body, rods[0]) << method.name();
    EXPECT_GT(now.angular.scale, 0.1);
    // The implicit method turns too slowly under tension; sweeps leave gaps, which are lever arms.
    const double angular = method.integrator == Integrator::implicit ? 1
                           : method.solver == Solver::iterative      ? 1e-3
                                                                     : 1e-6;
    EXPECT_LT(now.angular.error, angular) << method.name();
    // A push from outside starts anew; a hold in the world ends it.
    world.apply_impulse(rods[0], {5, 0, 0});
    run(world, 0.1, 1e-3);
    EXPECT_LT(world.balance().linear.error, 1e-9) << method.name();
    world.add_spring({.body_a = world.ground(), .body_b = rods[0], .stiffness = 1});
    world.step(1e-3);
    now = world.balance();
    EXPECT_EQ(now.linear.body, -1) << method.name();
    EXPECT_EQ(now.angular.body, -1) << method.name();
  }
}

// A pulley over two points of the world holds no body and still gives momentum.
TEST(Balance, APulleyGivesMomentum) {
  World<double> world(methods().front().settings(-9.81));
  const int a = world.add_body({.x = -1, .y = -1, .mass = 1, .inertia = 1});
  const int b = world.add_body({.x = 1, .y = -1, .mass = 2, .inertia = 1});
  world.add_joint({"pulley", {a, b}, {{"pa", {0, 0}}, {"pb", {0, 0}}, {"ga", {-1, 0}}, {"gb", {1, 0}}}, {}});
  run(world, 0.1, 1e-3);
  EXPECT_EQ(world.balance().linear.body, -1);
}

// Without forces that take or put in, the method is left with the error of the energy, which has the method's order.
TEST(Balance, WhatIsLeftToTheMethodHasItsOrder) {
  for (const Method& method : methods()) {
    if (method.solver == Solver::iterative || method.local_error > 0 || method.order() > 4) continue;
    if (method.integrator == Integrator::implicit) continue;
    double before = 0;
    for (double h : {4e-3, 2e-3, 1e-3}) {
      World<double> world(method.settings(-9.81));
      add_chain(world, 2, -1);
      const int last = world.joint_count() - 1;
      add_spring(world, last, "angle",
                 {.softness = {.by_frequency = false, .stiffness = 3, .damping = 0.3}, .rest = 0});
      world.add_spring({.body_a = world.ground(), .body_b = 2, .ax = 1, .ay = 1, .stiffness = 7, .damping = 0.4});
      const double now = watch(world, 1, h).energy.share();
      if (before > 0) {
        EXPECT_NEAR(std::log2(before / now), method.order(), 0.35) << method.name() << " at " << h;
      }
      before = now;
    }
  }
}

}  // namespace
}  // namespace cdot::test
