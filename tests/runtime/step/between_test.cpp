// Events within a step: found between its ends, each for few evaluations, and met as exactly as the steps are.
#include <cmath>
#include <fmt/core.h>

#include "tests/runtime/sines.hpp"
#include "tests/runtime/support.hpp"

namespace cdot::test::between_test {
namespace {

struct Method {
  const char* name;
  Integrator integrator;
  int stages;
  double local_error, most;  // evaluations for an event
};

struct Swing {
  long long evaluations, of_steps, events;
  double angle;  // at the end
};

// A rod swings through its lowest pose, is stopped by a limit and swings back.
Swing swing(const Method& method, double start, double local_error) {
  Settings s = settings(Solver::direct, Drift::projection, -9.81);
  s.integrator = method.integrator, s.local_error = local_error;
  World<double> world(s);
  const int joint = revolute(world, world.ground(), world.add_body(rod(0, 0, start)), 0, 0, -0.5, 0);
  add_limit(world, joint, "angle", {.lower = -4, .upper = 0.4 - pi / 2});
  for (int k = 0; k < 4; ++k) EXPECT_TRUE(world.step(0.3));
  const StepCounts& counts = world.step_counts();
  return {counts.evaluations, method.stages * (counts.taken + counts.rejected), counts.events,
          world.coordinate(joint, "angle")};
}

TEST(EventsBetween, CostLessThanAStepAtEachLook) {
  for (const Method& method : {Method{"dop853", Integrator::dop853, 12, 1e-2, 48},
                               {"dop853", Integrator::dop853, 12, 1e-4, 48},
                               {"dop853", Integrator::dop853, 12, 1e-6, 48},
                               {"dop853", Integrator::dop853, 12, 1e-10, 48},
                               {"rk4", Integrator::rk4, 4, 1e-2, 24},
                               {"rk4", Integrator::rk4, 4, 1e-4, 24},
                               {"rk4", Integrator::rk4, 4, 1e-6, 24}}) {
    Swing all{};
    double off = 0;
    for (int k = 0; k < 20; ++k) {
      const double start = -2.2 - 0.04 * k;
      const Swing now = swing(method, start, method.local_error);
      EXPECT_EQ(now.events, 1);
      all.evaluations += now.evaluations, all.of_steps += now.of_steps, all.events += now.events;
      off = std::max(off, std::abs(now.angle - swing(method, start, 1e-13).angle));
    }
    const double each = static_cast<double>(all.evaluations - all.of_steps) / static_cast<double>(all.events);
    fmt::print("  {} {:.0e}: {:.1f} evaluations for each of {} events, off by {:.1e} rad\n", method.name,
               method.local_error, each, all.events, off);
    EXPECT_LT(each, method.most);
    EXPECT_LT(off, std::max(20 * method.local_error, 1e-7));
  }
}

// A box on two ropes, each taut in turns. The times between impacts shrink to a tenth with each two of them, so that
// all are over at a time, from which on both ropes are taut. Closing one rope's gap, as small as events resolve, must
// not let the other one hop for ever.
TEST(EventsBetween, OfEndsThatAreMetInTurnsEnd) {
  for (const Method& method :
       {Method{"dop853", Integrator::dop853, 12, 1e-4, 0}, Method{"dop853", Integrator::dop853, 12, 1e-10, 0},
        Method{"radau5", Integrator::radau5, 0, 1e-6, 0}, Method{"rk4", Integrator::rk4, 4, 0, 0}}) {
    Settings s = settings(Solver::direct, Drift::projection, -9.81);
    s.integrator = method.integrator, s.local_error = method.local_error;
    World<double> world(s);
    const int box = world.add_body({.y = -2.25, .mass = 1, .inertia = 1.25 / 12});
    world.set_velocity(box, {3, 0, 2});
    for (const double side : {-1.0, 1.0})
      world.add_joint(
          {"max_distance", {world.ground(), box}, {{"pa", {side, 0}}, {"pb", {0.5 * side, 0.25}}, {"l", {2.2}}}, {}});
    for (int k = 0; k < 25; ++k) ASSERT_TRUE(world.step(0.01));
    const long long events = world.step_counts().events;
    fmt::print("  {} {:.0e}: {} events, {} steps left to another method\n", method.name, method.local_error, events,
               world.step_counts().rescued);
    EXPECT_EQ(world.step_counts().rescued, 0);
    EXPECT_GE(events, 6);
    EXPECT_LE(events, 20);
    for (int k = 0; k < 2; ++k) {
      ASSERT_TRUE(world.step(0.01));
      const auto q = world.pose(box);
      for (const double side : {-1.0, 1.0})
        EXPECT_NEAR(std::hypot(q.x + q.c * 0.5 * side - q.s * 0.25 - side, q.y + q.s * 0.5 * side + q.c * 0.25), 2.2,
                    1e-8);
    }
  }
}

constexpr Method of_every_order[] = {{"dop853", Integrator::dop853, 12, 1e-4, 0},
                                     {"dop853", Integrator::dop853, 12, 1e-10, 0},
                                     {"radau5", Integrator::radau5, 0, 1e-8, 0},
                                     {"rk4", Integrator::rk4, 4, 1e-6, 0}};

// A rod at rest under functions of time asks for no short steps: the error is none. It must move when they move it.
struct Rest {
  World<double> world;
  int joint;
  explicit Rest(const Method& method, double gravity) : world(of(method, gravity)) {
    joint = revolute(world, world.ground(), world.add_body(rod(0.5, 0, 0)), 0, 0, -0.5, 0);
  }
  static Settings of(const Method& method, double gravity) {
    Settings s = settings(Solver::direct, Drift::projection, gravity);
    s.integrator = method.integrator, s.local_error = method.local_error;
    return s;
  }
  double angle() const { return world.coordinate(joint, "angle"); }
};

// A motor with at most 1 N m stands against a spring. Its speed turns round at 0.3 pi and 0.5 pi s: between them it
// pushes to the other side.
TEST(EventsBetween, AStandingMotorTurnsBackWithItsSpeed) {
  for (const Method& method : of_every_order) {
    Rest rest(method, 0);
    add_effect(rest.world, rest.joint, "angle",
               SpecEffect{"motor", {in_time("speed", {sine(0, -1.7, 5)}), {"max", {1}}}});
    add_effect(rest.world, rest.joint, "angle",
               CoordinateSpring{{.by_frequency = false, .stiffness = 50, .damping = 5}, 0});
    const auto at = [&](double t) {
      while (rest.world.time() < t - 1e-9) EXPECT_TRUE(rest.world.step(0.05));
      return rest.angle();
    };
    EXPECT_NEAR(at(0.6), -1. / 50, 5e-4) << method.name << ' ' << method.local_error;
    EXPECT_NEAR(at(1.25), 1. / 50, 5e-4) << method.name << ' ' << method.local_error;
    EXPECT_NEAR(at(1.85), -1. / 50, 5e-4) << method.name << ' ' << method.local_error;
  }
}

// A load lifts a rod off its end for 0.07 s in a second and a half: sin(7 t) > 0.966.
TEST(EventsBetween, AnEndLetsGoForAShortTime) {
  for (const Method& method : of_every_order) {
    Rest rest(method, -9.81);
    add_limit(rest.world, rest.joint, "angle", {.lower = 0, .upper = 2});
    add_effect(rest.world, rest.joint, "angle", SpecEffect{"load", {in_time("push", {sine(0, 5.08, 7)})}});
    double highest = 0;
    for (int k = 0; k < 30; ++k) {
      ASSERT_TRUE(rest.world.step(0.05));
      if (rest.world.time() > 0.9) highest = std::max(highest, rest.angle());
    }
    EXPECT_GT(highest, 1e-4) << method.name << ' ' << method.local_error;
    EXPECT_NEAR(rest.angle(), 0, 1e-7) << method.name << ' ' << method.local_error;
  }
}

// A block moves at 0.1 m/s, also in its last step, and an end comes to meet it between 1.11 and 1.18 s, and goes away.
TEST(EventsBetween, AnEndThatComesAndGoesIsMet) {
  const auto place = [](const Method& method, double h) {
    World<double> world(Rest::of(method, 0));
    const int block = world.add_body({.vx = 0.1, .mass = 1, .inertia = 1});
    const int rail =
        world.add_joint({"prismatic", {block, world.ground()}, {{"pa", {0, 0}}, {"pb", {0, 0}}, {"t", {0, 1}}}, {}});
    add_effect(world, rail, "slide", SpecEffect{"limit", {in_time("upper", {sine(0.262, 0.15, 4)})}});
    while (world.time() < 1.5 - 1e-9) EXPECT_TRUE(world.step(h));
    return world.coordinate(rail, "slide");
  };
  const double at_short_steps = place({"rk4", Integrator::rk4, 4, 0, 0}, 0.001);
  EXPECT_LT(at_short_steps, 0.13);
  for (const Method& method : of_every_order)
    EXPECT_NEAR(place(method, 0.5), at_short_steps, std::max(1e-5, method.local_error)) << method.name;
}

// A motor of 1 N m brakes a wheel; for the times when its speed is above that of the wheel it drives it.
TEST(EventsBetween, AMotorDrivesForAShortTime) {
  const auto rate = [](const Method& method, double h) {
    World<double> world(Rest::of(method, 0));
    const int wheel = world.add_body({.w = 2.6, .mass = 1, .inertia = 1});
    const int axle = revolute(world, world.ground(), wheel, 0, 0, 0, 0);
    add_effect(world, axle, "angle", SpecEffect{"motor", {in_time("speed", {sine(0, 1.4, 5)}), {"max", {1}}}});
    while (world.time() < 1.9 - 1e-9) EXPECT_TRUE(world.step(h));
    return world.coordinate_rate(axle, "angle");
  };
  const double at_short_steps = rate({"rk4", Integrator::rk4, 4, 0, 0}, 0.001);
  EXPECT_GT(at_short_steps, 2.6 - 1.9 + 0.1);
  for (const Method& method : of_every_order)
    EXPECT_NEAR(rate(method, 0.95), at_short_steps, std::max(1e-5, method.local_error)) << method.name;
}

}  // namespace
}  // namespace cdot::test::between_test
