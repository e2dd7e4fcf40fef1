// Closed loops that nearly fit: one part is slightly too long, or one axis slightly tilted.
#include <cmath>
#include <fmt/core.h>

#include <cdot/methods.hpp>

#include "tests/runtime/mechanisms.hpp"
#include "tests/runtime/spatial_support.hpp"
#include "tests/runtime/support.hpp"

namespace cdot::test {
namespace {

constexpr Integrator all_integrators[] = {Integrator::euler, Integrator::implicit, Integrator::rattle,
                                          Integrator::rk4,   Integrator::dop853,   Integrator::radau5};

Settings method(Integrator integrator, double gravity_y) {
  Settings s = settings(Solver::direct, Drift::projection, gravity_y);
  s.integrator = integrator;
  return s;
}

// Two rods of 1 m, at `angle` above the line between two pivots that are `apart`.
void add_arch(World<double>& world, double angle, double apart) {
  const int left = world.add_body(rod(0, 0, angle)),
            right = world.add_body(rod(std::cos(angle), std::sin(angle), -angle));
  revolute(world, world.ground(), left, 0, 0, -0.5, 0);
  revolute(world, left, right, 0.5, 0, -0.5, 0);
  revolute(world, world.ground(), right, apart, 0, 0.5, 0);
}

TEST(Misfit, ProjectionIsRefusedIfItMovesBodiesFar) {
  for (const double misfit : {1e-2, 1e-3, 1e-4}) {
    World<double> world;
    add_arch(world, 0.2 * std::sqrt(misfit), 2 + misfit);
    const auto before = world.pose(1);
    const ProjectResult result = world.project(1e-9);
    EXPECT_FALSE(result);
    ASSERT_TRUE(result.refused) << misfit;
    EXPECT_GE(result.joint, 0);
    EXPECT_GE(result.body, 0);
    EXPECT_GT(result.moved, 200 * result.misfit);
    fmt::print("  {} m too far apart: joint {} off by {:.2e}, would move body {} by {:.2e} m\n", misfit, result.joint,
               result.misfit, result.body, result.moved);
    const auto after = world.pose(1);
    EXPECT_TRUE(finite(world));
    EXPECT_LT(std::hypot(after.x - before.x, after.y - before.y), 0.1) << misfit;
    EXPECT_LT(world.worst_position_error().value, 2 * misfit);
  }
}

// No pose closes this arch. Each round of Newton stays within its bound, but together they go too far.
TEST(Misfit, ARefusedProjectionOfManyRoundsMovesNothing) {
  constexpr double misfit = 6e-5;
  World<double> world;
  add_arch(world, 0.4 * std::sqrt(misfit), 2 + misfit);
  const planar::Place before[] = {world.place(0), world.place(1)};
  const ProjectResult result = world.project(1e-12);
  ASSERT_TRUE(result.refused);
  EXPECT_GT(result.moved, 200 * result.misfit);
  for (int body : {0, 1}) {
    EXPECT_EQ(world.place(body).x, before[body].x);
    EXPECT_EQ(world.place(body).y, before[body].y);
    EXPECT_EQ(world.place(body).angle, before[body].angle);
  }
}

// A regular projection moves the bodies by a few times the error, near a dead centre by many times.
TEST(Misfit, ProjectionOfASoundStartIsNotRefused) {
  for (const double angle : {1.0, 0.3, 0.1, 0.03}) {
    World<double> world;
    add_arch(world, angle, 2 * std::cos(1.01 * angle));
    const ProjectResult result = world.project(1e-12);
    EXPECT_TRUE(result);
    EXPECT_FALSE(result.refused);
    EXPECT_NEAR(world.pose(0).angle, 1.01 * angle, 1e-9);
  }
}

// Three parallel cranks that carry a beam, the middle pivot off by `misfit`. Upright they are in balance with gravity
// upwards; a push lets them swing.
void add_cranks(World<double>& world, double misfit, double spin) {
  std::vector<int> cranks;
  for (int k = 0; k < 3; ++k) {
    cranks.push_back(world.add_body(rod(k, 0, pi / 2)));
    world.set_velocity(cranks.back(), {-0.5 * spin, 0, spin});
  }
  const int beam = world.add_body({.x = 1, .y = 1, .mass = 2, .inertia = 2.0 * 4 / 12});
  world.set_velocity(beam, {-spin, 0, 0});
  for (int k = 0; k < 3; ++k) {
    revolute(world, world.ground(), cranks[k], k == 1 ? k + misfit : k, 0, -0.5, 0);
    revolute(world, cranks[k], beam, 0.5, 0, k - 1, 0);
  }
}

TEST(Misfit, OfCranksStaysAsItIs) {
  for (const Integrator integrator : all_integrators) {
    World<double> world(method(integrator, 9.81)), right(method(integrator, 9.81));
    add_cranks(world, 1e-3, 1);
    add_cranks(right, 0, 1);
    double rise = 0, gap = 0, off = 0;
    const double start = world.energy();
    for (int k = 0; k < 300; ++k) {
      ASSERT_TRUE(world.step(1.0 / 60)) << name_of(integrators, integrator);
      right.step(1.0 / 60);
      rise = std::max(rise, world.energy() - start);
      gap = std::max(gap, world.worst_position_error().value);
      off = std::max(off, std::abs(world.pose(1).angle - right.pose(1).angle));
    }
    fmt::print("  {:9} gap {:.2e} m, energy rises by {:.1e} of {:.2f} J, {:.1e} rad off the mechanism that fits\n",
               name_of(integrators, integrator), gap, rise, start, off);
    EXPECT_LT(gap, 1e-3);
    EXPECT_LT(off, 2e-2);
    EXPECT_EQ(world.step_counts().rescued, 0);
  }
}

// A ring of four hinges that turns as a parallelogram, the last axis tilted: rigid if taken literally. Its velocities
// violate a row by 1e-3 rad/s; to stop that the bodies would have to stop.
TEST(Misfit, ProjectionDoesNotStopAMotionForASmallError) {
  for (const double tilt : {1e-3, 1e-5}) {
    SpatialWorld<double> world;
    const auto [left, top, right] = add_tilted_ring(world, tilt);
    world.set_velocity(left, {0.5, 0, 0, 0, 1, 0});
    world.set_velocity(right, {0.5, 0, 0, 0, 1, 0});
    world.set_velocity(top, {1, 0, 0, 0, 0, 0});
    const double before = world.energy();
    const ProjectResult result = world.project(1e-9);
    EXPECT_TRUE(result.refused);
    EXPECT_FALSE(result);
    EXPECT_NEAR(result.misfit, tilt, 0.01 * tilt);
    EXPECT_NEAR(result.moved, 1, 0.5);
    EXPECT_NEAR(world.energy(), before, 1e-2 * before);
  }
}

}  // namespace
}  // namespace cdot::test
