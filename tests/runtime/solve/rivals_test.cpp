// Motors of unlimited force whose rates no motion has, by other motors or by joints: a World counts that. A motor that
// is limited yields, and one that an end stops is stopped as meant.
#include <cdot/effects.hpp>
#include <cdot/methods.hpp>
#include <cdot/world.hpp>

#include "tests/runtime/support.hpp"

namespace cdot::test {
namespace {

// Two wheels, joints 0 and 1, which a gear turns alike, joint 2.
struct Wheels {
  explicit Wheels(Settings s) : world(s) {
    for (int k = 0; k < 2; ++k) {
      wheel[k] = world.add_body({.x = 3. * k, .mass = 1, .inertia = 0.5});
      revolute(world, world.ground(), wheel[k], 3. * k, 0, 0, 0);
    }
    world.add_joint({"gear", {wheel[0], wheel[1]}, {{"ratio", {-1}}, {"phi", {0}}}, {}});
  }
  void motor(int joint, double speed, double most = unlimited) {
    add_motor(world, joint, "angle", {.speed = speed, .max_force = most});
  }
  const StepCounts& counts() {
    for (int n = 0; n < 10; ++n) world.step(0.01);
    return world.step_counts();
  }
  World<double> world;
  int wheel[2];
};

struct Way {
  Integrator integrator;
  Solver solver;
};

std::vector<Way> all_ways() {
  std::vector<Way> ways{{Integrator::euler, Solver::iterative}};
  for (const auto& row : integrator_rows) ways.push_back({row.integrator, Solver::direct});
  return ways;
}

Settings with(const Way& way) {
  Settings s = settings(way.solver);
  s.integrator = way.integrator;
  return s;
}

std::string name_of(const Way& way) {
  return std::string(cdot::name_of(integrators, way.integrator)) + ", " +
         std::string(cdot::name_of(solvers, way.solver));
}

TEST(Rivals, OnOneCoordinateAreTold) {
  for (const Way& way : all_ways()) {
    for (const double other : {2.0, 1.0}) {
      Wheels wheels(with(way));
      wheels.motor(0, 2);
      wheels.motor(0, other);
      const StepCounts& counts = wheels.counts();
      EXPECT_EQ(counts.contradicted > 0, other != 2) << name_of(way) << ", " << other << " rad/s beside 2";
      EXPECT_EQ(counts.contradicted_joint, other != 2 ? 0 : -1) << name_of(way);
      EXPECT_EQ(counts.contradicting_joint, other != 2 ? 0 : -1) << name_of(way);
    }
  }
}

// Sweeps see rows of the same bodies alone.
TEST(Rivals, ThatJointsConnectAreTold) {
  for (const Way& way : all_ways()) {
    if (way.solver == Solver::iterative) continue;
    for (const double other : {-2.0, 2.0}) {
      Wheels wheels(with(way));
      wheels.motor(0, 2);
      wheels.motor(1, other);
      const StepCounts& counts = wheels.counts();
      EXPECT_EQ(counts.contradicted > 0, other < 0) << name_of(way) << ", " << other << " rad/s";
      EXPECT_EQ(counts.contradicted_joint + counts.contradicting_joint, other < 0 ? 1 : -2) << name_of(way);
    }
  }
}

// Without a rival; sweeps leave the weld open, which is told otherwise.
TEST(Rivals, AreJointsThatHoldAMotor) {
  for (const Way& way : all_ways()) {
    if (way.solver == Solver::iterative) continue;
    for (const double speed : {2.0, 0.0}) {
      Wheels wheels(with(way));
      wheels.motor(1, speed);
      wheels.world.add_joint(
          {"weld", {wheels.world.ground(), wheels.wheel[0]}, {{"pa", {0.1, 0}}, {"pb", {0.1, 0}}}, {}});
      const StepCounts& counts = wheels.counts();
      EXPECT_EQ(counts.contradicted > 0, speed != 0) << name_of(way) << ", " << speed << " rad/s";
      EXPECT_EQ(counts.contradicted_joint, speed != 0 ? 1 : -1) << name_of(way);
      EXPECT_EQ(counts.contradicting_joint, -1) << name_of(way);
    }
  }
}

TEST(Rivals, ThatAreLimitedYield) {
  for (const Way& way : all_ways()) {
    Wheels wheels(with(way));
    wheels.motor(0, 2, 1000);
    wheels.motor(0, 1);
    wheels.motor(1, 5, 3);
    add_effect(wheels.world, 1, "angle", SpecEffect{"pin_friction", {{"mu", {0.3}}, {"radius", {0.05}}}});
    EXPECT_EQ(wheels.counts().contradicted, 0) << name_of(way);
  }
}

// A clutch lets its first body turn ahead of the second one, and keeps it from turning back, however fast a motor turns
// it. So a wheel may not turn back, or not ahead, if the ground comes first.
TEST(Rivals, AreAClutchAndAMotorThatTurnsAgainstIt) {
  for (const Way& way : all_ways()) {
    for (const double most : {unlimited, 50.0}) {
      for (const double speed : {1.0, -1.0}) {
        for (const bool wheel_first : {true, false}) {
          Wheels wheels(with(way));
          wheels.motor(0, speed);
          const int wheel = wheels.wheel[0], ground = wheels.world.ground();
          const int first = wheel_first ? wheel : ground, second = wheel_first ? ground : wheel;
          wheels.world.add_joint({"freewheel", {first, second}, {{"most", {most}}}, {}});
          EXPECT_EQ(wheels.counts().contradicted > 0, (speed < 0) == wheel_first && most == unlimited)
              << name_of(way) << ", " << speed << " rad/s, up to " << most << " N m" << (wheel_first ? "" : ", turned");
        }
      }
    }
  }
}

// A second axle breaks in the first step, and its motor goes with it: sweeps compare it no more.
TEST(Rivals, OfSweepsBreakWithTheirJoints) {
  Wheels wheels(with({Integrator::euler, Solver::iterative}));
  const int axle = revolute(wheels.world, wheels.world.ground(), wheels.wheel[0], 0, 0, 0, 0);
  wheels.motor(0, 2);
  wheels.motor(axle, 1);
  set_breaking_load(wheels.world, axle, 1e-3);
  wheels.world.set_force(wheels.wheel[0], {100, 0, 0});
  const long long at_first = wheels.counts().contradicted;
  ASSERT_TRUE(wheels.world.broken(axle));
  EXPECT_EQ(wheels.counts().contradicted, at_first);
}

// A motor of 1 N m turns a rod about the end that a pin holds, and drags a point 0.75 m away out of a seat along the
// rod. The rod stops where its work, the angle, is that of friction of 300 N/m over the depth d, from 0.15 m on:
//
//   angle = 300 (0.15^2 - d^2) / 2,  d = 0.75 cos(angle) - 0.6.
//
// At the start the pin alone holds the point along the seat.
TEST(Rivals, AreNoneWhereFrictionHoldsWhatAPinHoldsNearly) {
  constexpr double at_rest = 0.0595405355796;
  const double d = 0.75 * std::cos(at_rest) - 0.6;
  ASSERT_NEAR(at_rest, 150 * (0.15 * 0.15 - d * d), 1e-12);
  for (const Way& way : all_ways()) {
    World<double> world(with(way));
    const int rod = world.add_body({.mass = 1, .inertia = 1. / 12});
    const int pin = revolute(world, world.ground(), rod, -0.5, 0, -0.5, 0);
    add_motor(world, pin, "angle", {.speed = 2.2, .max_force = 1});
    world.add_joint(
        {"press_fit", {rod, world.ground()}, {{"pa", {0.25, 0}}, {"pb", {0.1, 0}}, {"t", {1, 0}}, {"c", {300}}}, {}});
    for (int n = 0; n < 500; ++n) world.step(0.001);
    EXPECT_EQ(world.step_counts().contradicted, 0) << name_of(way);
    EXPECT_NEAR(world.pose(rod).angle, at_rest, way.solver == Solver::direct ? 1e-4 : 2e-3) << name_of(way);
  }
}

TEST(Rivals, AreNoneAtAnEnd) {
  for (const Way& way : all_ways()) {
    Wheels wheels(with(way));
    wheels.motor(0, 2);
    wheels.motor(1, 2);
    add_limit(wheels.world, 0, "angle", {.lower = -1, .upper = 0.05});
    EXPECT_EQ(wheels.counts().contradicted, 0) << name_of(way);
  }
}

}  // namespace
}  // namespace cdot::test
