// Contradicting joints: the bodies rest at the least sum of squares of C for every order of elimination, and the other
// motion is undisturbed.
#include <cmath>
#include <fmt/core.h>

#include <cdot/methods.hpp>

#include "runtime/state/world_data.hpp"
#include "tests/runtime/mechanisms.hpp"
#include "tests/runtime/support.hpp"

namespace cdot::test {
namespace {

constexpr Integrator all_integrators[] = {Integrator::euler, Integrator::implicit, Integrator::rattle,
                                          Integrator::rk4,   Integrator::dop853,   Integrator::radau5};

// Three rods of 1, 1 and 2.02 m in a line.
void add_triangle(World<double>& world) {
  const auto rod_of = [&](double x, double length) {
    return world.add_body({.x = x, .mass = length, .inertia = length * length * length / 12});
  };
  const int a = rod_of(0.5, 1), b = rod_of(1.5, 1), c = rod_of(1, 2.02);
  revolute(world, a, b, 0.5, 0, -0.5, 0);
  revolute(world, b, c, 0.5, 0, 1.01, 0);
  revolute(world, c, a, -1.01, 0, -0.5, 0);
}

template <class S>
double sum_of_squares(const BasicWorld<S>& world) {
  double sum = 0;
  for (int joint = 0; joint < world.joint_count(); ++joint)
    for (double error : world.position_error(joint)) sum += error * error;
  return sum;
}

TEST(Contradiction, IsSharedByTheJointsOfATriangle) {
  for (const Integrator integrator : all_integrators) {
    Settings s = settings(Solver::direct);
    s.integrator = integrator;
    World<double> world(s);
    add_triangle(world);
    for (int k = 0; k < 60; ++k) world.step(1.0 / 60);
    for (int joint = 0; joint < 3; ++joint) {
      const auto error = world.position_error(joint);
      EXPECT_NEAR(std::hypot(error[0], error[1]), 0.02 / 3, 1e-9) << joint;
    }
    EXPECT_LT(world.energy(), 1e-12);
  }
}

// The triangle's centre of mass falls freely: the contradiction adds no momentum.
TEST(Contradiction, MovesNoCentreOfMass) {
  for (const Integrator integrator : all_integrators) {
    Settings s = settings(Solver::direct, Drift::projection, -9.81);
    s.integrator = integrator;
    World<double> world(s);
    add_triangle(world);
    for (int k = 0; k < 60; ++k) world.step(1.0 / 60);
    double momentum = 0, mass = 0;
    for (int body = 0; body < 3; ++body) {
      const double m = 1 / world.inverse_mass(body).m;
      momentum += m * world.velocity(body).y;
      mass += m;
    }
    EXPECT_NEAR(momentum / mass, -9.81, 1e-9);
  }
}

// A door whose four hinges do not line up: no small displacement or rotation of the door reduces the sum of squares.
TEST(Contradiction, OfADoorOnCrookedHingesIsLeast) {
  for (const Integrator integrator : all_integrators) {
    Settings s = settings(Solver::direct, Drift::projection, -9.81);
    s.integrator = integrator;
    SpatialWorld<double> world(s);
    const int door = world.add_body({.x = 0.5, .z = 1, .mass = 20, .inertia = {.xx = 6.7, .yy = 8.3, .zz = 1.7}});
    const double off[4][2] = {{1e-3, 0}, {-2e-3, 1e-3}, {0, -1e-3}, {2e-3, 3e-3}};
    for (int k = 0; k < 4; ++k)
      world.add_joint({"spherical",
                       {world.ground(), door},
                       {{"pa", {off[k][0], off[k][1], 0.2 + 0.5 * k}}, {"pb", {-0.5, 0, -0.8 + 0.5 * k}}},
                       {}});
    for (int k = 0; k < 30; ++k) world.step(1.0 / 60);
    const auto rest = world.pose(door);
    const double least = sum_of_squares(world);
    EXPECT_GT(least, 1e-6);
    for (int i = 0; i < 6; ++i) {
      for (const double by : {1e-4, -1e-4}) {
        double d[6] = {};
        d[i] = by;
        world.set_pose(door, {rest.x + d[0], rest.y + d[1], rest.z + d[2],
                              rest.e0 - (d[3] * rest.e1 + d[4] * rest.e2 + d[5] * rest.e3) / 2,
                              rest.e1 + (d[3] * rest.e0 + d[4] * rest.e3 - d[5] * rest.e2) / 2,
                              rest.e2 + (d[4] * rest.e0 + d[5] * rest.e1 - d[3] * rest.e3) / 2,
                              rest.e3 + (d[5] * rest.e0 + d[3] * rest.e2 - d[4] * rest.e1) / 2});
        EXPECT_GE(sum_of_squares(world), least) << "direction " << i << " by " << by;
      }
    }
    fmt::print("  sum of squares {:.6e} m^2\n", least);
  }
}

// A bob flies past two ends of one coordinate in a step: at 1.4 m a rope ends, at 1.3 m a limit of its length. As
// equations they contradict each other, as ends they do not: the nearer one holds.
TEST(Contradiction, OfTwoEndsOfOneLengthIsNone) {
  Settings s = settings(Solver::direct);
  s.integrator = Integrator::euler;
  World<double> world(s);
  const int bob = world.add_body({.x = 1.25, .vy = 30, .mass = 1, .inertia = 0.1});
  const int rope = world.add_joint({"rope", {world.ground(), bob}, {{"pa", {0, 0}}, {"pb", {0, 0}}, {"l", {1.4}}}, {}});
  add_limit(world, rope, "length", {.lower = 0.2, .upper = 1.3});
  ASSERT_TRUE(world.step(0.03));
  EXPECT_LE(std::hypot(world.pose(bob).x, world.pose(bob).y), 1.3 + 1e-12);
  EXPECT_LE(world.worst_passed_end().by, 1e-12);
}

// A body that two welds hold in places 0.1 m apart carries a pendulum. The welds share their error, the hinge has none.
// Another body keeps the angle of the first and flies away at `speed`: its pose blurs no row of the others.
template <class T>
double gap_beside_a_misfit(Integrator integrator, double speed) {
  Settings s = settings(Solver::direct, Drift::projection, -10);
  s.integrator = integrator;
  World<T> world(s);
  const int held = world.add_body({.mass = 1, .inertia = 1}), bob = world.add_body({.x = 1, .mass = 1, .inertia = 0.1});
  for (const double off : {0.0, 0.1})
    world.add_joint({"weld", {held, world.ground()}, {{"pa", {0, 0}}, {"pb", {off, 0}}, {"phi", {0}}}, {}});
  const int hinge = world.add_joint({"revolute", {held, bob}, {{"pa", {0, 0}}, {"pb", {-1, 0}}}, {}});
  const int flies = world.add_body({.y = 1, .vx = speed, .mass = 1, .inertia = 0.1});
  world.add_joint({"angle", {held, flies}, {}, {}});
  double largest = 0;
  for (int k = 0; k < 200; ++k) {
    EXPECT_TRUE(world.step(0.01));
    for (const double C : world.position_error(hinge)) largest = std::max(largest, std::abs(C));
  }
  EXPECT_NEAR(world.pose(held).x, 0.05, by_precision<T>(1e-3, 1e-9));
  return largest;
}

TEST(Contradiction, OpensNoOtherJoint) {
  for (const Integrator integrator : all_integrators) {
    for (const double speed : {0.0, 1e10}) {
      EXPECT_LT(gap_beside_a_misfit<double>(integrator, speed), 1e-10) << name_of(integrators, integrator);
      EXPECT_LT(gap_beside_a_misfit<float>(integrator, 1e-3 * speed), 5e-6) << name_of(integrators, integrator);
    }
  }
}

// The rows of `count` welds of one body, with any b. What is left of b then is orthogonal to all that the rows can
// reach, K times it is 0, whether the solver takes them as equations or within bounds, and how many of them are
// redundant.
void expect_least_error(int count) {
  Settings s = settings(Solver::direct);
  World<double> world(s);
  const int held = world.add_body({.mass = 1, .inertia = 1}), bob = world.add_body({.x = 1, .mass = 1, .inertia = 0.1});
  for (int k = 0; k < count; ++k)
    world.add_joint(
        {"weld", {held, world.ground()}, {{"pa", {0.3 * k, 0.1}}, {"pb", {0.3 * k, 0.1}}, {"phi", {0}}}, {}});
  revolute(world, held, bob, 0, 0, -1, 0);
  ASSERT_TRUE(world.step(0.01));
  auto& system = world.data().islands[0].system;
  const int rows = system.rows();
  system.choose([](const auto&, int) { return true; });
  ASSERT_EQ(system.factor(), 3 * (count - 1));
  for (int r = 0; r < rows; ++r) system.b[r] = std::sin(1.0 + r);
  system.solve();
  std::vector<double> unmet(rows), image(rows), lambda = system.lambda;
  double largest = 0;
  for (int r = 0; r < rows; ++r) unmet[r] = system.unmet(r), largest = std::max(largest, std::abs(unmet[r]));
  EXPECT_GT(largest, 0.1);
  system.multiply(unmet.data(), image.data());
  for (const double x : image) EXPECT_NEAR(x, 0, 1e-12);
  system.multiply(lambda.data(), image.data());
  for (int r = 0; r < rows; ++r) EXPECT_NEAR(image[r] + unmet[r], system.b[r], 1e-12);
  system.solve_bounded();
  system.multiply(system.lambda.data(), image.data());
  for (int r = 0; r < rows; ++r) EXPECT_NEAR(image[r] + unmet[r], system.b[r], 1e-12) << "row " << r << ", bounded";
}

TEST(Contradiction, LeavesTheLeastErrorOfManyRowsAndOfFew) {
  for (const int count : {2, 3, 4, 8}) expect_least_error(count);
}

}  // namespace
}  // namespace cdot::test
