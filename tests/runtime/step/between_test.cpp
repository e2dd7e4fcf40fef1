// Events within a step: found between its ends, each for few evaluations, and met as exactly as the steps are.
#include <cmath>
#include <fmt/core.h>

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

}  // namespace
}  // namespace cdot::test::between_test
