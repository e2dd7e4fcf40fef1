// Compares effects on coordinates with results by hand.
#include <algorithm>
#include <cmath>
#include <fmt/core.h>

#include <cdot/methods.hpp>

#include "tests/runtime/support.hpp"

namespace cdot::test {
namespace {

constexpr Solver both[] = {Solver::direct, Solver::iterative};

// A wheel on a fixed axle. The angle of a revolute is that of b seen from a, so the wheel is b.
template <class T>
int add_wheel(World<T>& world, double inertia, int* wheel, double torque = 0) {
  *wheel = world.add_body({.mass = 1, .inertia = inertia, .torque = torque});
  return revolute(world, world.ground(), *wheel, 0, 0, 0, 0);
}

TEST(Motor, ReachesItsSpeedAtOnceIfItsForceIsUnlimited) {
  for (Solver solver : both) {
    World<double> world(settings(solver));
    int wheel;
    const int joint = add_wheel(world, 2, &wheel);
    add_motor(world, joint, "angle", {.speed = 3});
    world.step(0.01);
    EXPECT_NEAR(world.velocity(wheel).w, 3, 1e-12);
    EXPECT_NEAR(world.coordinate_rate(joint, "angle"), 3, 1e-12);
  }
}

TEST(Motor, AcceleratesWithItsLargestForceUntilItHasItsSpeed) {
  for (Solver solver : both) {
    World<double> world(settings(solver));
    int wheel;
    const int joint = add_wheel(world, 2, &wheel);
    add_motor(world, joint, "angle", {.speed = 3, .max_force = 0.5});
    run(world, 4, 0.01);
    EXPECT_NEAR(world.velocity(wheel).w, 0.5 * 4 / 2, 1e-9);
    run(world, 20, 0.01);
    EXPECT_NEAR(world.velocity(wheel).w, 3, 1e-9);
  }
}

// The limit wins against any force: the rod stands, and reports no speed.
TEST(Motor, StandsStillAtTheLimitThatItRunsInto) {
  for (const auto& [name, integrator] : integrators) {
    for (const double gravity : {0.0, -9.81}) {
      Settings s = settings(Solver::direct, Drift::projection, gravity);
      s.integrator = integrator;
      World<double> world(s);
      const int bar = world.add_body(rod(0.5, 0, 0));
      const int joint = revolute(world, world.ground(), bar, 0, 0, -0.5, 0);
      add_motor(world, joint, "angle", {.speed = 3});
      add_limit(world, joint, "angle", {.lower = -1, .upper = 0.4});
      run(world, 1, 1.0 / 60);
      double fastest = 0, off = 0;
      for (int k = 0; k < 60; ++k) {
        ASSERT_TRUE(world.step(1.0 / 60));
        fastest = std::max(fastest, std::abs(world.velocity(bar).w));
        off = std::max(off, std::abs(world.coordinate(joint, "angle") - 0.4));
      }
      fmt::print("  {}: at most {:.1e} rad/s, {:.1e} rad off\n", name, fastest, off);
      EXPECT_LT(fastest, 0.01) << name;
      EXPECT_LT(off, 1e-3) << name;
    }
  }
}

TEST(DryFriction, HoldsUpToItsForceAndBrakesAboveIt) {
  for (Solver solver : both) {
    for (double torque : {0.4, 0.7}) {
      World<double> world(settings(solver));
      int wheel;
      add_friction(world, add_wheel(world, 2, &wheel, torque), "angle", {.max_force = 0.5});
      run(world, 1, 0.01);
      EXPECT_NEAR(world.velocity(wheel).w, torque < 0.5 ? 0 : 0.2 / 2, 1e-9);
    }
  }
}

TEST(DryFriction, StopsARunningWheelAfterTheTimeThatMomentumGives) {
  for (Solver solver : both) {
    World<double> world(settings(solver));
    int wheel;
    add_friction(world, add_wheel(world, 2, &wheel), "angle", {.max_force = 0.5});
    world.set_velocity(wheel, {0, 0, 1});
    run(world, 2, 0.01);
    EXPECT_NEAR(world.velocity(wheel).w, 0.5, 1e-9);
    run(world, 3, 0.01);
    EXPECT_NEAR(world.velocity(wheel).w, 0, 1e-12);
    EXPECT_NEAR(world.pose(wheel).angle, 2, 0.02);  // w^2 I / (2 torque)
  }
}

TEST(Limit, StopsEachSideWhereItIs) {
  for (Solver solver : both) {
    for (Drift drift : {Drift::none, Drift::baumgarte, Drift::projection}) {
      for (double torque : {5.0, -5.0}) {
        World<double> world(settings(solver, drift));
        int wheel;
        const int joint = add_wheel(world, 2, &wheel, torque);
        add_limit(world, joint, "angle", {.lower = -200 * pi / 180, .upper = 45 * pi / 180});
        double farthest = 0;
        for (int i = 0; i < 600; ++i) {
          world.step(1.0 / 60);
          const double angle = world.coordinate(joint, "angle") * 180 / pi;
          farthest = std::max(farthest, torque > 0 ? angle - 45 : -200 - angle);
        }
        EXPECT_LT(farthest, 1e-3);
        EXPECT_NEAR(world.pose(wheel).angle * 180 / pi, torque > 0 ? 45 : -200, 1e-3);
      }
    }
  }
}

TEST(Limit, OneSideOnlyAndNoPullFromIt) {
  for (Solver solver : both) {
    World<double> world(settings(solver));
    int wheel;
    const int joint = add_wheel(world, 2, &wheel);
    add_limit(world, joint, "angle", {.lower = -1, .upper = {}});
    world.set_velocity(wheel, {0, 0, 4});
    run(world, 3, 0.01);
    EXPECT_NEAR(world.pose(wheel).angle, 12, 1e-9);  // counts turns
    world.set_velocity(wheel, {0, 0, -4});
    run(world, 3, 0.01);
    EXPECT_NEAR(world.pose(wheel).angle, 0, 1e-9);
    run(world, 1, 0.01);
    EXPECT_NEAR(world.pose(wheel).angle, -1, 1e-9);
  }
}

// Equal ends lock the coordinate in both directions.
TEST(Limit, WithoutRoomLocks) {
  for (Solver solver : both) {
    for (Drift drift : {Drift::baumgarte, Drift::projection}) {
      World<double> world(settings(solver, drift));
      int wheel;
      const int joint = add_wheel(world, 2, &wheel, 5);
      add_limit(world, joint, "angle", {.lower = 0.25, .upper = 0.25});
      world.set_velocity(wheel, {0, 0, -3});
      run(world, 2, 1.0 / 60);
      for (int i = 0; i < 60; ++i) {
        world.set_velocity(wheel, {0, 0, i % 2 ? 3.0 : -3.0});
        world.step(1.0 / 60);
        EXPECT_NEAR(world.coordinate(joint, "angle"), 0.25, 1e-9);
        EXPECT_NEAR(world.velocity(wheel).w, 0, 1e-9);
      }
    }
  }
}

TEST(Limit, ThousandTurnsAreCounted) {
  World<double> world;
  int wheel;
  const int joint = add_wheel(world, 2, &wheel);
  world.set_velocity(wheel, {0, 0, 2 * pi});
  run(world, 1000, 0.01);
  EXPECT_NEAR(world.coordinate(joint, "angle"), 2000 * pi, 1e-6);
}

// A slider on a slope: limit, motor and spring on the slide of a prismatic joint.
TEST(Prismatic, BlockSlidesDownAndStopsAtItsLimit) {
  for (Solver solver : both) {
    const double slope = pi / 6, g = 9.81;
    World<double> world(settings(solver, Drift::projection, -g));
    const int block = world.add_body({.mass = 1, .inertia = 0.1});
    // The normal of the incline that falls to the right.
    const int joint = world.add_joint({"prismatic",
                                       {block, world.ground()},
                                       {{"pa", {0, 0}}, {"pb", {0, 0}}, {"t", {std::sin(slope), std::cos(slope)}}},
                                       {}});
    const double h = 1e-3;
    run(world, 1, h);
    const double down = std::hypot(world.pose(block).x, world.pose(block).y);
    EXPECT_NEAR(down, g * std::sin(slope) * 0.5 * (1 + h), 1e-9);
    const double sign = world.coordinate(joint, "slide") > 0 ? 1 : -1;
    EXPECT_NEAR(world.coordinate(joint, "slide") * sign, down, 1e-12);
    add_limit(world, joint, "slide", {.lower = -4, .upper = 4});
    run(world, 2, h);
    EXPECT_NEAR(world.coordinate(joint, "slide") * sign, 4, 1e-9);
    EXPECT_NEAR(std::hypot(world.velocity(block).x, world.velocity(block).y), 0, 1e-9);
  }
}

TEST(Effects, SeveralOnOneCoordinate) {
  for (Solver solver : both) {
    World<double> world(settings(solver));
    int wheel;
    const int joint = add_wheel(world, 2, &wheel);
    add_motor(world, joint, "angle", {.speed = 2, .max_force = 1});
    add_friction(world, joint, "angle", {.max_force = 0.4});
    add_limit(world, joint, "angle", {.lower = {}, .upper = 1});
    run(world, 1, 0.01);
    EXPECT_NEAR(world.velocity(wheel).w, 0.6 / 2, 1e-6);
    run(world, 9, 0.01);
    EXPECT_NEAR(world.pose(wheel).angle, 1, 1e-9);
  }
}

TEST(BreakingLoad, BreaksJustAboveIt) {
  for (Solver solver : both) {
    for (double load : {99.0, 101.0}) {
      Settings s = settings(solver, Drift::projection, -10);
      s.iterations = 200;
      World<double> world(s);
      const auto rods = add_chain(world, 5, -pi / 2, 2);
      set_breaking_load(world, 0, load);
      run(world, 1, 0.01);
      EXPECT_EQ(world.broken(0), load < 100);
      EXPECT_NEAR(world.pose(rods[4]).y, load < 100 ? -4.5 - 5 : -4.5, 0.11);
      EXPECT_FALSE(world.broken(1));
      EXPECT_LT(world.worst_position_error().value, 1e-6);
    }
  }
}

TEST(BreakingLoad, OfOneJointAmongMany) {
  for (Solver solver : both) {
    Settings s = settings(solver, Drift::projection, -10);
    s.iterations = 100;
    World<double> world(s);
    const auto rods = add_chain(world, 5, 0.0, 2);
    add_spring(world, 2, "angle", {.softness = {.by_frequency = false, .damping = 0.1}});
    set_breaking_load(world, 2, 5);
    run(world, 0.5, 0.005);
    EXPECT_TRUE(world.broken(2));
    const auto impulse = world.impulse(2);
    EXPECT_EQ(impulse[0], 0);
    EXPECT_LT(world.worst_position_error().value, 1e-3);
    world.add_body({.mass = 1});  // analyses the islands again, without the broken joint
    run(world, 0.5, 0.005);
    EXPECT_EQ(world.island_count(), 3);
    EXPECT_LT(world.pose(rods[4]).y, -2);
  }
}

// A soft rope with much damping, hardly stretched, whose end comes back fast: -k C - d dC/dt would push it outwards.
TEST(SoftRope, NeverPushes) {
  for (const IntegratorRow& row : integrator_rows) {
    Settings s;
    s.integrator = row.integrator;
    World<double> world(s);
    const int body = world.add_body({.x = 1.01, .vx = -5, .mass = 1});
    world.add_joint({"max_distance",
                     {world.ground(), body},
                     {{"pa", {0, 0}}, {"pb", {0, 0}}, {"l", {1}}},
                     Softness{.by_frequency = false, .stiffness = 10, .damping = 100}});
    run(world, 0.1, 1e-3);
    EXPECT_LE(world.velocity(body).x, -5 + 1e-12) << row.name;
    EXPECT_NEAR(world.velocity(body).x, -5, 1e-3) << row.name;  // the stretch pulls with 0.1 N, for 2 ms
  }
}

// The springs of a joint that is gone store nothing.
TEST(BreakingLoad, TheSpringsOfABrokenJointHaveNoEnergy) {
  for (const bool breaks : {false, true}) {
    World<double> world(settings(Solver::direct, Drift::projection, -10));
    const int rod_of_it = add_chain(world, 1, 0.0).front();
    add_spring(world, 0, "angle", {.softness = {.by_frequency = false, .stiffness = 100}, .rest = 0.3});
    const double stretched = 0.5 * 100 * 0.3 * 0.3;
    EXPECT_NEAR(world.energy(), stretched, 1e-12);
    if (breaks) set_breaking_load(world, 0, 1e-3);
    else world.remove_joint(0);
    world.step(1e-9);
    ASSERT_TRUE(world.broken(0));
    EXPECT_NEAR(world.energy(), 0, 1e-6) << rod_of_it;
  }
}

// A weight on two pins at one place. Each carries half of it. Without one of them the other carries all.
struct WeightOnTwoPins {
  WeightOnTwoPins(Integrator integrator, double load_1, double load_2)
      : WeightOnTwoPins(method(integrator), load_1, load_2) {}
  WeightOnTwoPins(const Settings& settings, double load_1, double load_2) : world(settings) {
    body = world.add_body({.mass = 1, .inertia = 1});
    for (double load : {load_1, load_2})
      set_breaking_load(world, revolute(world, world.ground(), body, 0, 0, 0, 0), load);
    run(world, 0.2, 0.01);
  }
  static Settings method(Integrator integrator) {
    Settings s = settings(Solver::direct, Drift::projection, -10);
    s.integrator = integrator;
    return s;
  }
  World<double> world;
  int body;
};

TEST(BreakingLoad, RedundantJointsShareTheLoad) {
  for (const IntegratorRow& row : integrator_rows) {
    WeightOnTwoPins both_hold(row.integrator, 6, 6);
    EXPECT_FALSE(both_hold.world.broken(0)) << row.name;
    EXPECT_FALSE(both_hold.world.broken(1)) << row.name;
    for (int joint : {0, 1}) EXPECT_NEAR(both_hold.world.reaction(joint, both_hold.body).force_y, 5, 1e-9) << row.name;
    EXPECT_NEAR(both_hold.world.pose(both_hold.body).y, 0, 1e-9);
  }
}

TEST(BreakingLoad, OneJointBreaksWhereTheOtherCarriesAll) {
  for (const IntegratorRow& row : integrator_rows) {
    for (int weak : {0, 1}) {
      WeightOnTwoPins one_holds(row.integrator, weak == 0 ? 4 : 11, weak == 0 ? 11 : 4);
      EXPECT_EQ(one_holds.world.broken(0), weak == 0) << row.name;
      EXPECT_EQ(one_holds.world.broken(1), weak == 1) << row.name;
      EXPECT_NEAR(one_holds.world.pose(one_holds.body).y, 0, 1e-9);
      WeightOnTwoPins none_holds(row.integrator, weak == 0 ? 4 : 9, weak == 0 ? 9 : 4);
      EXPECT_TRUE(none_holds.world.broken(0) && none_holds.world.broken(1)) << row.name;
    }
  }
}

// Sweeps load the first of two pins alone.
TEST(BreakingLoad, BySweepsRedundantJointsShareTheLoadToo) {
  for (Drift drift : {Drift::soft, Drift::baumgarte, Drift::projection, Drift::none})
    for (const IntegratorRow& row : integrator_rows) {
      Settings s = settings(Solver::iterative, drift, -10);
      s.integrator = row.integrator;
      if (mistake_in_methods(s)) continue;
      for (double load : {9.0, 11.0}) {  // what both can carry
        WeightOnTwoPins pins(s, load / 2, load / 2);
        EXPECT_EQ(pins.world.broken(0) && pins.world.broken(1), load < 10) << row.name;
        EXPECT_EQ(pins.world.broken(0), pins.world.broken(1)) << row.name;
      }
    }
}

// By sweeps, two pins that misfit pull at each other ever harder. They carry nothing, so they share nothing.
TEST(BreakingLoad, JointsThatWorkAgainstEachOtherDoNotBreak) {
  World<double> world(settings(Solver::iterative, Drift::baumgarte));
  const int body = world.add_body({.mass = 1, .inertia = 1});
  for (double x : {-1e-5, 1e-5}) set_breaking_load(world, revolute(world, world.ground(), body, x, 0, 0, 0), 0.1);
  run(world, 1, 0.01);
  EXPECT_FALSE(world.broken(0) || world.broken(1));
}

// Both pins of two hanging rods carry too much. Without the upper one, the rods fall and the lower one carries nothing.
TEST(BreakingLoad, OfJointsInARowOneBreaks) {
  for (Solver solver : both) {
    World<double> world(settings(solver, Drift::projection, -10));
    add_chain(world, 2, -pi / 2);
    for (int joint : {0, 1}) set_breaking_load(world, joint, 5);
    run(world, 0.2, 0.01);
    EXPECT_TRUE(world.broken(0));
    EXPECT_FALSE(world.broken(1));
  }
}

TEST(Effects, MistakesAreRefused) {
  World<double> world;
  int wheel;
  const int joint = add_wheel(world, 2, &wheel);
  EXPECT_THROW(add_limit(world, joint, "slide", {.lower = 0, .upper = 1}), Error);
  EXPECT_THROW(add_limit(world, joint, "angle", {.lower = 2, .upper = 1}), Error);
  EXPECT_THROW(add_limit(world, joint, "angle", {}), Error);
  EXPECT_THROW(add_limit(world, joint + 1, "angle", {.lower = 0, .upper = 1}), Error);
  EXPECT_THROW(add_motor(world, joint, "angle", {.speed = NAN}), Error);
  EXPECT_THROW(add_motor(world, joint, "angle", {.speed = 1, .max_force = -1}), Error);
  EXPECT_THROW(add_friction(world, joint, "angle", {.max_force = -1}), Error);
  EXPECT_THROW(add_spring(world, joint, "angle", {}), Error);
  EXPECT_THROW(add_effect(world, joint, "angle", Load{INFINITY}), Error);
  EXPECT_THROW(set_breaking_load(world, joint, 0), Error);
  try {
    add_motor(world, joint, "slide", {.speed = 1});
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "joint `revolute` has no free coordinate `slide`; it has `angle`");
  }
}

// dw/dt = F / I with every method. F C counts as energy, which methods of second and higher order conserve.
TEST(Load, TurnsAWheelByAllMethodsAndKeepsTheEnergy) {
  for (Solver solver : both)
    for (const auto& [name, integrator] : integrators) {
      Settings s = settings(solver, Drift::projection);
      s.integrator = integrator;
      if (mistake_in_methods(s)) continue;
      World<double> world(s);
      int wheel;
      const int joint = add_wheel(world, 2, &wheel);
      const int load = add_effect(world, joint, "angle", Load{0.5});
      run(world, 4, 0.01);
      EXPECT_NEAR(world.velocity(wheel).w, 0.5 * 4 / 2, 1e-9) << name;
      const bool first_order = integrator == Integrator::euler || integrator == Integrator::implicit;
      EXPECT_NEAR(world.energy(), 0, first_order ? 0.01 : 1e-9) << name;
      set_effect(world, joint, load, Load{-0.25});
      run(world, 4, 0.01);
      EXPECT_NEAR(world.velocity(wheel).w, 0.5, 1e-9) << name;
    }
}

TEST(Load, HangsAMassOnASpring) {
  World<double> world(settings(Solver::direct));
  int wheel;
  const int joint = add_wheel(world, 2, &wheel);
  add_effect(world, joint, "angle", Load{3});
  add_spring(world, joint, "angle", {.softness = {.by_frequency = false, .stiffness = 10, .damping = 4}});
  run(world, 40, 0.01);
  EXPECT_NEAR(world.coordinate(joint, "angle"), 0.3, 1e-9);
}

// A damped spring on an angle: all methods of second and higher order give the same motion.
TEST(Effects, ADampedSpringMovesTheSameByEveryIntegrator) {
  const auto end_by = [](Integrator integrator, Solver solver) {
    Settings s = settings(solver, Drift::projection, -9.81);
    s.integrator = integrator;
    World<double> world(s);
    add_chain(world, 1, 0);
    add_spring(world, 0, "angle", {.softness = {.by_frequency = false, .stiffness = 30, .damping = 2}, .rest = 0.5});
    run(world, 1, 0.0025);
    return world.pose(1).angle;
  };
  const double exact = end_by(Integrator::dop853, Solver::direct);
  for (Solver solver : {Solver::direct, Solver::iterative})
    for (Integrator integrator : {Integrator::rattle, Integrator::rk4})
      EXPECT_NEAR(end_by(integrator, solver), exact, 1e-5);
}

}  // namespace
}  // namespace cdot::test
