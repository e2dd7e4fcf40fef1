// Mechanisms with redundant rows: every step counts and drops the same number of rows, and the motion is that without
// them.
#include <Eigen/QR>
#include <fmt/core.h>
#include <set>

#include <cdot/integrators.hpp>
#include <cdot/methods.hpp>

#include "tests/runtime/mechanisms.hpp"
#include "tests/runtime/support.hpp"

namespace cdot::test {
namespace {

// Numbers of dropped rows over all steps of a run.
template <class S>
std::set<int> dropped_rows(BasicWorld<S>& world, double duration, double h) {
  std::set<int> counts;
  const long steps = std::lround(duration / h);
  for (long i = 0; i < steps; ++i) {
    world.step(h);
    counts.insert(world.redundant_rows());
  }
  return counts;
}

// 82 rows, 9 of them redundant, through the flat pose and out at the other side.
TEST(Redundancy, RotatingSquaresThroughTheFlatPose) {
  for (double h : {1.0 / 240, 1.0 / 960}) {
    for (Drift drift : {Drift::none, Drift::baumgarte, Drift::projection}) {
      World<double> world(settings(Solver::direct, drift));
      add_rotating_squares(world, 5, 0.3, -1);
      EXPECT_EQ(dropped_rows(world, 0.6, h), std::set<int>{9}) << h;
      EXPECT_LT(world.pose(0).angle, -0.2);
      for (int i = 2; i < 25; ++i)  // equal on all black squares of a chessboard, and on all white ones
        EXPECT_NEAR(world.pose(i).angle, world.pose(i % 2).angle, 1e-10);
    }
  }
}

// The same mechanism after an asymmetric impulse. Its motion passes near singular poses: single rows are almost
// redundant, and round-off grows in later rows.
TEST(Redundancy, RotatingSquaresNearPosesWithoutRank) {
  for (double h : {1.0 / 60, 1.0 / 240, 1.0 / 960}) {
    for (Drift drift : {Drift::none, Drift::baumgarte, Drift::projection}) {
      Settings s = settings(Solver::direct, drift, -9.81);
      s.gravity_x = 3;
      World<double> world(s);
      add_rotating_squares(world, 5, 0.3, -1);
      world.apply_impulse(7, {0.3, 0.2, 0.1});
      EXPECT_EQ(dropped_rows(world, 2, h), std::set<int>{9}) << h;
      if (drift == Drift::projection) {
        EXPECT_LT(world.worst_position_error().value, 1e-10);
      }
    }
  }
}

// A planar four-bar and its twin with hinges in space, where 3 of 20 rows are redundant. An impulse out of the plane
// opens the joints and tilts the axes. All 20 rows together would then lock the mechanism.
TEST(Redundancy, HingeLoopMovesLikeItsPlanarTwin) {
  for (Drift drift : {Drift::baumgarte, Drift::projection}) {
    SpatialWorld<double> space(settings(Solver::direct, drift, -9.81));
    add_hinge_loop(space);
    World<double> plane(settings(Solver::direct, drift, -9.81));
    add_planar_hinge_loop(plane);
    plane.apply_impulse(1, {0.3, 0.2, 3});
    space.apply_impulse(1, {0.3, 0.2, 0.1, 1, 1, 3});
    const double start = plane.pose(1).y;
    EXPECT_EQ(dropped_rows(space, 0.5, 1.0 / 60), std::set<int>{3});
    run(plane, 0.5, 1.0 / 60);
    fmt::print("moved {:.4f} m, its twin {:.4f} m\n", space.pose(1).y - start, plane.pose(1).y - start);
    EXPECT_NEAR(space.pose(1).y, plane.pose(1).y, 0.01);
  }
}

// Four equal bars carry a platform: 2 of 16 rows are redundant, and 3 if all bars lie flat.
template <class T>
void add_parallel_bars(World<T>& world) {
  const int ground = world.ground();
  const int platform = world.add_body({.x = 0.5, .y = 1, .mass = 1, .inertia = 0.1});
  for (int i = 0; i < 4; ++i) {
    const int bar = world.add_body({.x = 0.3 * i, .y = 0.5, .mass = 0.3, .inertia = 0.03});
    revolute(world, ground, bar, 0.3 * i, 0, 0, -0.5);
    revolute(world, bar, platform, 0, 0.5, 0.3 * i - 0.5, 0);
  }
  world.apply_impulse(platform, {1, 0, 0});
}

template <class T>
double gap_of_parallel_bars(Drift drift, double h) {
  Settings s = settings(Solver::direct, drift, -9.81);
  s.gravity_x = 3;
  World<T> world(s);
  add_parallel_bars(world);
  double gap = 0;
  for (int i = 0; i < std::lround(2 / h); ++i) {
    world.step(h);
    gap = std::max(gap, world.worst_position_error().value);
  }
  EXPECT_EQ(world.redundant_rows(), 2);
  return gap;
}

TEST(Redundancy, ParallelBarsThroughTheFlatPose) {
  for (double h : {1.0 / 60, 1.0 / 240, 1.0 / 960}) {
    const double exact = gap_of_parallel_bars<double>(Drift::projection, h);
    const double coarse = gap_of_parallel_bars<float>(Drift::projection, h);
    const double fed_back = gap_of_parallel_bars<float>(Drift::baumgarte, h);
    fmt::print("h = {:.5f} s: gaps {:.2g} m, in floats {:.2g} m, by Baumgarte {:.2g} m\n", h, exact, coarse, fed_back);
    EXPECT_LT(exact, 1e-11);
    EXPECT_LT(coarse, 1e-3);
    EXPECT_LT(fed_back, 100 * h * h);
  }
}

// Elimination drops the row of the rope, which is that of the rod. That is no contradiction: a slack rope pulls
// nothing.
template <class T>
void expect_no_pull_of_a_slack_rope(Integrator integrator) {
  const auto spun = [&](bool with_rope) {
    Settings s = settings(Solver::direct, Drift::projection);
    s.integrator = integrator;
    World<T> world(s);
    const int a = world.add_body({.x = 0, .vy = -1, .w = 3, .mass = 1, .inertia = 0.1});
    const int b = world.add_body({.x = 1, .vy = 2, .w = 3, .mass = 2, .inertia = 0.2});
    const std::vector<NamedValue> points = {{"pa", {0, 0}}, {"pb", {0, 0}}};
    world.add_joint({"distance", {a, b}, points, {}});
    std::vector<NamedValue> slack = points;
    slack.push_back({"l", {1.3}});
    if (with_rope) world.add_joint({"max_distance", {a, b}, slack, {}});
    for (int k = 0; k < 100; ++k) EXPECT_TRUE(world.step(0.01));
    return world;
  };
  const World<T> plain = spun(false), roped = spun(true);
  for (int body : {0, 1}) {
    EXPECT_NEAR(roped.pose(body).x, plain.pose(body).x, by_precision<T>(1e-5, 1e-12));
    EXPECT_NEAR(roped.velocity(body).y, plain.velocity(body).y, by_precision<T>(1e-5, 1e-11));
  }
}

TEST(Redundancy, ASlackRopeBesideARodPullsNothing) {
  for (const IntegratorRow& row : integrator_rows) {
    expect_no_pull_of_a_slack_rope<double>(row.integrator);
    expect_no_pull_of_a_slack_rope<float>(row.integrator);
  }
}

// A rod on a pin, whose end a slot guides across: at rest in the pose where both lie on the normal of the slot, which
// is no longer free to first order only. A lock breaks there under the rod's weight. Rows that were redundant in that
// pose have to act again beside it. RATTLE cannot step there, and tells it.
TEST(Redundancy, ALockBreaksAtADeadCentre) {
  for (const IntegratorRow& row : integrator_rows) {
    Settings s = settings(Solver::direct, Drift::projection, -9.81);
    s.integrator = row.integrator;
    World<double> world(s);
    const int rod = world.add_body({.x = 0.3, .y = 0.5, .mass = 1, .inertia = 0.1});
    revolute(world, rod, world.ground(), -0.3, -0.5, 0, 0);
    world.add_joint({"line", {rod, world.ground()}, {{"pa", {-0.3, 0.5}}, {"pb", {0, 1}}, {"t", {0, 1}}}, {}});
    set_breaking_load(world, world.add_joint({"angle", {world.ground(), rod}, {}, {}}), 1);
    bool steps = true;
    for (int k = 0; k < 100 && steps; ++k) {
      steps = bool(world.step(0.01));
      EXPECT_LT(world.worst_position_error().value, 1e-11) << row.name << " " << k;
      EXPECT_LT(std::abs(world.pose(rod).angle), 1e-5) << row.name << " " << k;
    }
    EXPECT_TRUE(steps || row.integrator == Integrator::rattle) << row.name;
  }
}

// Three bodies and three hinges are a rigid triangle, which spins freely. A rope between two of them is as long as the
// distance of its ends, so that any pull of it is possible.
struct RopeInATriangle {
  static constexpr double spin = 8, mass[3] = {1, 3, 0.5}, x[3] = {0, 1.3, 0.4}, y[3] = {0, 0.2, 1.1};
  // Of hinge i between the bodies i and i + 1, and of the rope from body 0 to body 2: its ends from both bodies.
  static constexpr double from[4][2] = {{0.7, -0.1}, {-0.2, 0.8}, {-0.3, -0.6}, {0.1, 0.3}};
  static constexpr double to[4][2] = {{-0.6, -0.3}, {0.7, -0.1}, {0.1, 0.5}, {0.2, 0.4}};

  // The pull of the rope with the least sum of squares of all forces that let the triangle spin about its centre of
  // mass.
  static double least_pull() {
    Eigen::Matrix<double, 9, 6> hinges = Eigen::Matrix<double, 9, 6>::Zero();
    Eigen::Matrix<double, 9, 1> rope = Eigen::Matrix<double, 9, 1>::Zero(), needed = rope;
    const auto add = [](auto column, int body, const double* arm, double fx, double fy) {
      column(3 * body) += fx, column(3 * body + 1) += fy, column(3 * body + 2) += arm[0] * fy - arm[1] * fx;
    };
    for (int i = 0; i < 3; ++i)
      for (int c = 0; c < 2; ++c) {
        add(hinges.col(2 * i + c), i, from[i], c == 0, c == 1);
        add(hinges.col(2 * i + c), (i + 1) % 3, to[i], -(c == 0), -(c == 1));
      }
    const double along[2] = {x[2] + to[3][0] - from[3][0], y[2] + to[3][1] - from[3][1]},
                 l = std::hypot(along[0], along[1]);
    add(rope.col(0), 0, from[3], along[0] / l, along[1] / l);
    add(rope.col(0), 2, to[3], -along[0] / l, -along[1] / l);
    const double all = mass[0] + mass[1] + mass[2];
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) {
        needed(3 * i) += -spin * spin * mass[i] * mass[k] / all * (x[i] - x[k]);
        needed(3 * i + 1) += -spin * spin * mass[i] * mass[k] / all * (y[i] - y[k]);
      }
    const auto solved = hinges.colPivHouseholderQr();
    const Eigen::Matrix<double, 6, 1> without = solved.solve(needed), less = solved.solve(rope);
    EXPECT_LT((hinges * without - needed).norm(), 1e-9);
    return without.dot(less) / (1 + less.dot(less));
  }

  // The largest pull in 0.4 s, in which the triangle turns by half a turn.
  static double largest_pull(Integrator integrator, double h) {
    Settings s = settings(Solver::direct);
    s.integrator = integrator;
    World<double> world(s);
    for (int i = 0; i < 3; ++i)
      world.add_body({.x = x[i],
                      .y = y[i],
                      .vx = -spin * y[i],
                      .vy = spin * x[i],
                      .w = spin,
                      .mass = mass[i],
                      .inertia = 0.2 * mass[i]});
    for (int i = 0; i < 3; ++i) revolute(world, i, (i + 1) % 3, from[i][0], from[i][1], to[i][0], to[i][1]);
    const double l = std::hypot(x[2] + to[3][0] - from[3][0], y[2] + to[3][1] - from[3][1]);
    const int rope = world.add_joint(
        {"rope", {0, 2}, {{"pa", {from[3][0], from[3][1]}}, {"pb", {to[3][0], to[3][1]}}, {"l", {l}}}, {}});
    const double energy = world.energy();
    double largest = 0;
    for (int k = 0; k < std::lround(0.4 / h); ++k) {
      EXPECT_TRUE(world.step(h));
      largest = std::max(largest, std::abs(world.impulse(rope)[0]) / h);
    }
    EXPECT_NEAR(world.energy() / energy, 1, 1e-8) << name_of(integrators, integrator) << " by " << h;
    return largest;
  }
};

TEST(Redundancy, ARopeAlongARigidTrianglePullsAtMostItsShare) {
  const double share = RopeInATriangle::least_pull();
  EXPECT_GT(share, 10);
  for (const Integrator integrator :
       {Integrator::euler, Integrator::implicit, Integrator::rattle, Integrator::dop853, Integrator::radau5})
    for (const double h : {1e-4, 1e-3, 0.01})
      EXPECT_LT(RopeInATriangle::largest_pull(integrator, h), 1.2 * share)
          << name_of(integrators, integrator) << " by " << h;
  EXPECT_NEAR(RopeInATriangle::largest_pull(Integrator::dop853, 1e-3), share, 1e-6 * share);
}

// Conjugate gradients share the loads. Their squares may lose all digits where loads themselves have theirs.
TEST(Redundancy, SharesLoadsWhoseSquaresVanish) {
  for (const IntegratorRow& row : integrator_rows)
    for (double g = 1e-150; g > 1e-170; g *= 0.93) {
      Settings s = settings(Solver::direct, Drift::projection, -g);
      s.integrator = row.integrator;
      World<double> world(s);
      const int rod = world.add_body({.x = 0.5, .mass = 1, .inertia = 1.0 / 12});
      for (int k = 0; k < 2; ++k) set_breaking_load(world, revolute(world, world.ground(), rod, 0, 0, -0.5, 0), 1);
      for (int k = 0; k < 2; ++k) ASSERT_TRUE(world.step(0.01)) << row.name << " under " << g << " m/s^2, step " << k;
      EXPECT_NEAR(world.velocity(rod).w / (-1.5 * g * 0.02), 1, 1e-6) << row.name << " under " << g << " m/s^2";
    }
}

}  // namespace
}  // namespace cdot::test
