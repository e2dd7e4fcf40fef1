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

// A bar of 1 m blocks an arm of 1 m at its tip: it takes the whole torque of the motor, and the arm stands.
TEST(Motor, PushesWithItsBoundAgainstWhatBlocksIt) {
  constexpr double most = 5;
  for (const auto& [name, integrator] : integrators) {
    Settings s = settings(Solver::direct);
    s.integrator = integrator;
    World<double> world(s);
    const int arm = world.add_body({.x = 0.5, .mass = 1, .inertia = 0.1});
    const int pin = revolute(world, world.ground(), arm, 0, 0, -0.5, 0);
    const int bar =
        world.add_joint({"distance", {world.ground(), arm}, {{"pa", {1, -1}}, {"pb", {0.5, 0}}, {"l", {1}}}, {}});
    add_motor(world, pin, "angle", {.speed = 1, .max_force = most});
    run(world, 0.5, 0.01);
    EXPECT_NEAR(world.reaction(bar, arm).force_y, -most, 1e-9) << name;
    EXPECT_NEAR(world.velocity(arm).w, 0, 1e-9) << name;
  }
}

// Each row alone would set the wheel's speed; against the load neither reaches it: the wheel turns by the rest of the
// torques. At rest the friction holds it. Both from the first step on.
TEST(Motor, PullsAWheelAgainstItsFrictionWithAllItHas) {
  constexpr double I = 0.18, load = -0.2, friction = 0.3, h = 0.001;
  constexpr struct {
    double start, most, rest;  // [rad/s], [N m], [N m]
  } cases[] = {{3, 0.4, 0.4 + load - friction}, {0, 0.25, 0}};
  for (const auto& [name, integrator] : integrators) {
    for (const auto& [start, most, rest] : cases) {
      Settings s = settings(Solver::direct);
      s.integrator = integrator;
      World<double> world(s);
      const int wheel = world.add_body({.w = start, .mass = 1, .inertia = I});
      const int joint = revolute(world, world.ground(), wheel, 0, 0, 0, 0);
      add_motor(world, joint, "angle", {.speed = 3, .max_force = most});
      add_friction(world, joint, "angle", {.max_force = friction});
      add_effect(world, joint, "angle", Load{load});
      for (const double duration : {h, 1.0}) {
        run(world, duration, h);
        EXPECT_NEAR(world.velocity(wheel).w, start + rest / I * world.time(), 1e-10)
            << name << " after " << duration << " s";
      }
    }
  }
}

// The stronger of the two wins, however slow the motor is: friction slips with all it has.
TEST(Motor, TurnsAWheelSlowlyAgainstWeakerFriction) {
  constexpr double I = 1. / 6, speed = 0.1, most = 10, friction = 4;
  for (const auto& [name, integrator] : integrators)
    for (const Solver solver : both) {
      if (solver == Solver::iterative && integrator != Integrator::euler) continue;
      Settings s = settings(solver);
      s.integrator = integrator;
      World<double> world(s);
      int wheel;
      const int joint = add_wheel(world, I, &wheel);
      add_motor(world, joint, "angle", {.speed = speed, .max_force = most});
      add_friction(world, joint, "angle", {.max_force = friction});
      run(world, 1, 1.0 / 60);
      // The motor reaches its speed after I speed / (most - friction), half of which is lost.
      EXPECT_NEAR(world.coordinate(joint, "angle"), speed, speed * speed * I / (most - friction) + 1e-3 * speed)
          << name;
      EXPECT_NEAR(world.coordinate_rate(joint, "angle"), speed, 1e-7) << name;
    }
}

// From the first step on, although friction holds the wheel before the motor starts.
TEST(Motor, OfUnlimitedForceStartsAgainstFriction) {
  for (const IntegratorRow& row : integrator_rows) {
    Settings s = settings(Solver::direct);
    s.integrator = row.integrator;
    World<double> world(s);
    int wheel;
    const int joint = add_wheel(world, 2, &wheel);
    add_motor(world, joint, "angle", {.speed = 3});
    add_friction(world, joint, "angle", {.max_force = 0.7});
    run(world, 0.5, 0.01);
    const bool at_once = row.order > 2;  // the others start within a step
    EXPECT_NEAR(world.coordinate(joint, "angle"), 1.5, at_once ? 1e-9 : 0.031) << row.name;
    EXPECT_NEAR(world.coordinate_rate(joint, "angle"), 3, 1e-9) << row.name;
    double sum = 0;
    for (const WorkOfSource& source : world.work_by_source()) sum += std::abs(source.work);
    EXPECT_NEAR(sum, 9 + 2 * 0.7 * 1.5, at_once ? 1e-9 : 0.05) << row.name;
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

// It drives the rod once and then loses against the limit, which takes that energy. Were the end let go, the motor
// would drive the rod into it again.
TEST(Motor, IsStoppedOnceByALimit) {
  for (const double local_error : {0.0, 1e-2, 1e-6}) {
    Settings s = settings(Solver::direct, Drift::projection, 0);
    s.integrator = Integrator::dop853, s.local_error = local_error;
    World<double> world(s);
    const int bar = world.add_body(rod(0.5, 0, 0));
    const int joint = revolute(world, world.ground(), bar, 0, 0, -0.5, 0);
    add_motor(world, joint, "angle", {.speed = 3});
    add_limit(world, joint, "angle", {.lower = -1, .upper = 0.4});
    ASSERT_TRUE(world.step(0.1));
    const double driven = world.energy();
    for (int k = 0; k < 10; ++k) ASSERT_TRUE(world.step(0.1));
    EXPECT_NEAR(world.coordinate(joint, "angle"), 0.4, 1e-8);
    EXPECT_NEAR(world.balance().put_in, driven, 1e-6) << local_error;
    EXPECT_EQ(world.step_counts().events, 1) << local_error;
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
