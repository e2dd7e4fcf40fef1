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

}  // namespace
}  // namespace cdot::test::between_test
