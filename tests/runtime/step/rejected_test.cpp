// Steps whose error is too large are taken anew: those before leave no trace.
#include <cmath>

#include <cdot/methods.hpp>

#include "tests/runtime/mechanisms.hpp"
#include "tests/runtime/support.hpp"

namespace cdot::test {
namespace {

// A slider crank at its dead centre: crank and rod lie in line, and turn by w and the other way round.
int add_flat_slider_crank(World<double>& world, double w) {
  const double crank_length = 0.15, rod_length = 0.3, end = crank_length + rod_length;
  const int crank = add_bar(world, {0, 0, crank_length, 0}), rod = add_bar(world, {crank_length, 0, end, 0});
  const int slider = world.add_body({.x = end, .mass = 1, .inertia = 1e-3});
  pin(world, world.ground(), crank, 0, 0);
  pin(world, crank, rod, crank_length, 0);
  pin(world, rod, slider, end, 0);
  world.add_joint({"prismatic", {slider, world.ground()}, {{"pa", {0, 0}}, {"pb", {0, 0}}, {"t", {0, 1}}}, {}});
  world.set_velocity(crank, {0, w * crank_length / 2, w});
  world.set_velocity(rod, {0, w * crank_length / 2, -w * crank_length / rod_length});
  return crank;
}

// The first attempt goes 30 rad in one step. Its forces are no start for the sweeps of the next one.
TEST(RejectedSteps, LeaveSweepsNoForces) {
  for (const Integrator integrator : {Integrator::rk4, Integrator::dop853}) {
    SCOPED_TRACE(name_of(integrators, integrator));
    double angle[2];
    for (const double step : {0.2, 1e-3}) {
      Settings s = settings(Solver::iterative, Drift::projection, 0);
      s.integrator = integrator, s.local_error = 3e-4;
      World<double> world(s);
      const int crank = add_flat_slider_crank(world, 150);
      for (int k = 0; k < std::lround(0.2 / step); ++k) ASSERT_TRUE(world.step(step));
      EXPECT_EQ(world.step_counts().rescued, 0);
      EXPECT_LT(world.worst_position_error().value, 1e-6);
      angle[step < 0.2] = world.place(crank).angle;
    }
    EXPECT_NEAR(angle[0], angle[1], 0.05);
  }
}

}  // namespace
}  // namespace cdot::test
