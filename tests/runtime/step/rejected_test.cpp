// Steps whose error is too large are taken anew: those before leave no trace.
#include <cmath>

#include <cdot/methods.hpp>

#include "tests/runtime/mechanisms.hpp"
#include "tests/runtime/spatial_support.hpp"

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

// In 0.2 s, by steps of its own. A first attempt of that length goes 30 rad.
double angle_after(const Settings& settings, double step, double mu) {
  World<double> world(settings);
  const int crank = add_flat_slider_crank(world, 150);
  if (mu > 0) add_effect(world, 0, "angle", SpecEffect{"pin_friction", {{"mu", {mu}}, {"radius", {0.01}}}});
  for (int k = 0; k < std::lround(0.2 / step); ++k) EXPECT_TRUE(world.step(step));
  EXPECT_EQ(world.step_counts().rescued, 0);
  EXPECT_LT(world.worst_position_error().value, 1e-6);
  return world.place(crank).angle;
}

void leave_no_forces(Solver solver, double mu) {
  for (const Integrator integrator : {Integrator::rk4, Integrator::dop853}) {
    SCOPED_TRACE(name_of(integrators, integrator));
    Settings s = settings(solver, Drift::projection, 0);
    s.integrator = integrator, s.local_error = 3e-4;
    EXPECT_NEAR(angle_after(s, 0.2, mu), angle_after(s, 1e-3, mu), 0.05);
  }
}

// The forces of a step that was far too long are no start for what searches those of the next one.
TEST(RejectedSteps, LeaveSweepsNoForces) { leave_no_forces(Solver::iterative, 0); }
TEST(RejectedSteps, LeaveFrictionNoLoads) { leave_no_forces(Solver::direct, 0.1); }

// The same crank in space, where 3 of 20 rows are redundant.
void add_flat_slider_crank(SpatialWorld<double>& world, double w) {
  const auto bar = [&](double begin, double end, double spin, double inertia) {
    SpatialBodyDefinition d{.x = (begin + end) / 2, .vz = 0.153 * w / 2, .wy = -spin, .mass = 0.038};
    d.inertia = {inertia / 10, inertia, inertia, 0, 0, 0};
    return world.add_body(d);
  };
  const int crank = bar(0, 0.153, w, 7.4e-5), rod = bar(0.153, 0.459, -w / 2, 5.9e-4);
  SpatialBodyDefinition d{.x = 0.459, .mass = 0.076};
  d.inertia = {2.7e-7, 2.7e-6, 2.7e-6, 0, 0, 0};
  const int slider = world.add_body(d);
  const std::vector<double> axis = {0, -1, 0};
  join(world, "revolute", world.ground(), crank, {{"pa", {0, 0, 0}}, {"fa", axis}});
  join(world, "revolute", crank, rod, {{"pa", {0.0765, 0, 0}}, {"fa", axis}});
  join(world, "revolute", rod, slider, {{"pa", {0.153, 0, 0}}, {"fa", axis}});
  join(world, "prismatic", slider, world.ground(), {{"pa", {0, 0, 0}}, {"fa", {1, 0, 0}}});
}

// Rows of joints that are torn apart are of any size. Beside it, those of the right poses would seem to vanish.
TEST(RejectedSteps, LeaveRowsTheirSize) {
  for (const double step : {0.2, 0.1, 0.01}) {
    Settings s = settings(Solver::direct, Drift::projection, 0);
    s.integrator = Integrator::dop853, s.local_error = 3e-4, s.gravity_z = -9.81;
    SpatialWorld<double> world(s);
    add_flat_slider_crank(world, 150);
    for (int k = 0; k < std::lround(0.2 / step); ++k) ASSERT_TRUE(world.step(step));
    EXPECT_LT(std::abs(world.balance().method()), 0.01) << step;
  }
}

}  // namespace
}  // namespace cdot::test
