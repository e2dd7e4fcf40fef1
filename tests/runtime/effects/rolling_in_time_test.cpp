// Friction along rows without a position whose numbers follow functions of time, by closed forms with every integrator.
#include <cmath>

#include "tests/runtime/effects/spatial_effects.hpp"

namespace cdot::test::in_space {
namespace {

Profile linear(double at_start, double at_end, double duration) {
  return Profile::table({.times = {0, duration}, .values = {at_start, at_end}, .interpolation = Interpolation::linear});
}

constexpr double duration = 1, angle = 0.2, until = 0.5;

// A small ball with a spin rolls across and down a large one. It does not slip until it is about to lift, later, so its
// coefficient of friction makes no difference.
double height_on_ball(Integrator integrator, const NamedValue& mu) {
  SpatialWorld<double> world(free_fall(integrator, g));
  const Vector<double> n{std::sin(angle), 0, std::cos(angle)}, v{0, 1.5, 0};
  constexpr double spin = 3;
  const int small =
      ball(world, {.x = {3 * n.x, 0, 3 * n.z}, .v = v, .w = {-n.z * v.y + spin * n.x, 0, n.x * v.y + spin * n.z}});
  world.add_joint({"ball_on_ball",
                   {small, world.ground()},
                   {{"pb", {0, 0, 0}}, {"f", {0, 0, 1}}, {"radius_a", {1}}, {"radius_b", {2}}, mu},
                   {}});
  run(world, until, 2e-3);
  return world.pose(small).z;
}

TEST(RollingInTime, AHeldRowDoesNotFeelHowItsBoundMoves) {
  for (const IntegratorRow& row : integrator_rows) {
    const double moves = height_on_ball(row.integrator, in_time("mu", {linear(5, 6, duration)})),
                 stays = height_on_ball(row.integrator, {"mu", {5}});
    EXPECT_NEAR(moves, stays, 1e-12) << row.name;
    EXPECT_LT(stays, 3 * std::cos(angle) - 0.1) << row.name;
  }
}

// A ball whose radius grows, r = 1 + t, rolls on a plane: v = w r, m dv/dt = -I dw/dt / r, so that
// w^2 (m r^2 + I) stays. At the run's end the radius has a kink: in the last step the plane still lifts the ball.
TEST(RollingInTime, ABallThatGrowsRollsMoreSlowly) {
  constexpr double m = 2, I = 0.8, w0 = 1.5;
  for (const IntegratorRow& row : integrator_rows) {
    SpatialWorld<double> world(free_fall(row.integrator, g));
    const int growing = ball(world, {.x = {0, 0, 1}, .v = {w0, 0, 1}, .w = {0, w0, 0}, .mass = m, .inertia = I});
    world.add_joint({"rough_plane",
                     {growing, world.ground()},
                     {{"pb", {0, 0, 0}}, {"f", {0, 0, 1}}, in_time("radius", {linear(1, 2, duration)}), {"mu", {5}}},
                     {}});
    run(world, duration, 1e-3);
    // Linearly implicit Euler holds rates with the radius at the start of a step.
    const double w = w0 * std::sqrt((m + I) / (m * 4 + I)), tolerance = row.order == 1 ? 2e-3 : 1e-6;
    EXPECT_NEAR(world.velocity(growing).wy, w, tolerance) << row.name;
    EXPECT_NEAR(world.velocity(growing).x, 2 * w, 2 * tolerance) << row.name;
    EXPECT_NEAR(world.velocity(growing).z, 1, 1e-9) << row.name;
  }
}

}  // namespace
}  // namespace cdot::test::in_space
