// The first event within a step, and steps that leap over none: neither must be missed, nor seen where there is none.
#include <cmath>
#include <fmt/core.h>

#include "tests/runtime/sines.hpp"
#include "tests/runtime/support.hpp"

namespace cdot::test::first_events_test {
namespace {

Settings chosen_by_error(Integrator integrator, double local_error) {
  Settings s = settings(Solver::direct);
  s.integrator = integrator, s.local_error = local_error;
  return s;
}

// A rod on a pin, at rest.
struct Pinned {
  World<double> world;
  int body, joint;
  explicit Pinned(const Settings& s, double angle = 0) : world(s) {
    body = world.add_body(rod(0, 0, angle));
    joint = revolute(world, world.ground(), body, 0, 0, -0.5, 0);
  }
  void turn(double w) {
    const auto q = world.pose(body);
    world.set_velocity(body, {-w * q.y, w * q.x, w});
  }
};

// A motor of 1 N m turns a rod over the notches of a detent that hold with up to 1.05 N m, and slips at the first one.
// While it turns evenly no step has an error, so steps get so long that their ends are beyond later notches.
TEST(FirstEvent, OfAForceThatPassesItsBoundMoreThanOnce) {
  const auto turned = [](const Settings& s, double speed, double h) {
    Pinned one(s);
    add_effect(one.world, one.joint, "angle", SpecEffect{"motor", {{"speed", {speed}}, {"max", {1}}}});
    add_effect(one.world, one.joint, "angle", SpecEffect{"detent", {{"count", {8}}, {"most", {1.05}}}});
    while (one.world.time() < 2 - 1e-9) EXPECT_TRUE(one.world.step(h));
    return one.world.coordinate(one.joint, "angle");
  };
  double worst = 0;
  for (const double local_error : {1e-6, 1e-9})
    for (int k = 0; k < 12; ++k) {
      const double speed = 0.9 + 0.1 * k;
      const Settings s = chosen_by_error(Integrator::dop853, local_error);
      const double off = std::abs(turned(s, speed, 2) - turned(s, speed, 5e-3));
      EXPECT_LT(off, 100 * local_error) << speed << " rad/s, local error " << local_error;
      worst = std::max(worst, off);
    }
  fmt::print("  off by at most {:.1e} rad\n", worst);
}

// A motor whose speed rises slowly is overpowered from rest: nothing is met and left again, so no step is shortened.
TEST(FirstEvent, IsNoneWhereADriveIsOverpowered) {
  Pinned one(chosen_by_error(Integrator::dop853, 1e-9));
  add_effect(one.world, one.joint, "angle", SpecEffect{"motor", {in_time("speed", {sine(0, 0.36, 1)}), {"max", {1}}}});
  add_effect(one.world, one.joint, "angle", SpecEffect{"load", {{"push", {3}}}});
  ASSERT_TRUE(one.world.step(0.02));
  EXPECT_EQ(one.world.step_counts().rejected, 0);
  EXPECT_LT(one.world.step_counts().taken, 20);
}

// A kink of a table ends the first step after a picosecond: there a rod that slips in its brake moves by less than the
// last digit of its angle.
TEST(FirstEvent, IsNoneInTheShortestStep) {
  Pinned one(chosen_by_error(Integrator::dop853, 1e-9), 0.2);
  one.turn(1e-6);
  const Profile kinked = Profile::table({.times = {0, 1e-12, 1}, .values = {0, 1e-15, 0}});
  add_effect(one.world, one.joint, "angle", SpecEffect{"friction", {{"max", {1}}}});
  add_effect(one.world, one.joint, "angle", SpecEffect{"load", {in_time("push", {kinked})}});
  ASSERT_TRUE(one.world.step(1e-7));
  EXPECT_EQ(one.world.step_counts().rejected, 0);
  EXPECT_EQ(one.world.step_counts().rescued, 0);
  EXPECT_NEAR(one.world.coordinate_rate(one.joint, "angle"), 1e-6 - 3e-7, 1e-12);
}

// A motor turns a rod evenly against nearly all that it has: that force stays where it is.
TEST(FirstEvent, IsNoneWhereAForceIsSteady) {
  Pinned one(chosen_by_error(Integrator::dop853, 1e-9));
  one.turn(1);
  add_effect(one.world, one.joint, "angle", SpecEffect{"motor", {{"speed", {1}}, {"max", {1}}}});
  add_effect(one.world, one.joint, "angle", SpecEffect{"load", {{"push", {-0.99}}}});
  ASSERT_TRUE(one.world.step(1));
  EXPECT_LE(one.world.step_counts().rejected, 1);
  EXPECT_NEAR(one.world.coordinate(one.joint, "angle"), 1, 1e-12);
}

// A push speeds a slide up. A pin on it carries no torque, and its brake grips from time 0 on: with nothing at first,
// so that the pin slips by round-off. Then the brake holds it.
TEST(FirstEvent, IsTheLastOfABrakeWithoutALoad) {
  for (const IntegratorRow& row : integrator_rows)
    for (const double local_error : {0.0, 1e-8}) {
      if (row.level != Level::acceleration) continue;
      World<double> world(chosen_by_error(row.integrator, local_error));
      const int slider = world.add_body(rod(0, 0, 0)), tip = world.add_body(rod(1, 0, 0));
      world.add_joint({"prismatic", {slider, world.ground()}, {{"pa", {0, 0}}, {"pb", {0, 0}}, {"t", {0, 1}}}, {}});
      const int pin = revolute(world, slider, tip, 0.5, 0, -0.5, 0);
      add_effect(world, pin, "angle", SpecEffect{"air_brake", {{"torque", {0.5}}, {"rise", {0.5}}}});
      world.add_joint({"push", {slider}, {{"pa", {0, 0}}, {"F", {10, 0}}}, {}});
      for (int k = 0; k < 20; ++k) ASSERT_TRUE(world.step(1e-3)) << row.name;
      EXPECT_EQ(world.step_counts().rescued, 0) << row.name << ", local error " << local_error;
      EXPECT_LE(world.step_counts().events, 2) << row.name << ", local error " << local_error;
      EXPECT_NEAR(world.velocity(tip).x, 0.1, 1e-12) << row.name;
    }
}

}  // namespace
}  // namespace cdot::test::first_events_test
