// Steps that follow those of an earlier run: the control's arithmetic, and fewer rejections at the same error.
#include "runtime/state/pace.hpp"

#include <cmath>
#include <fmt/core.h>

#include "runtime/state/world_data.hpp"
#include "tests/runtime/mechanisms.hpp"
#include "tests/runtime/spatial_support.hpp"

namespace cdot::test::pace_test {
namespace {

// A step tells about the end of its first third.
TEST(Pace, InterpolatesBetweenSteps) {
  Pace pace;
  pace.note(0, 1, 2);
  pace.note(1, 2, 4);
  EXPECT_EQ(pace.at(0), 2);
  EXPECT_NEAR(pace.at(1.0 / 3), 2, 1e-15);
  EXPECT_NEAR(pace.at(1), 3, 1e-15);
  EXPECT_EQ(pace.at(9), 4);
  pace.note(1, 0.5, 6);  // the step from 1 on was cut, and taken again
  EXPECT_EQ(pace.at(1.4), 6);
  EXPECT_EQ(pace.at(9), 6);
  EXPECT_EQ(pace.at(0), 2);
}

TEST(Pace, IsKeptByIslands) {
  Paces paces(1e-3);
  paces.note(4, 0, 1, 7);
  EXPECT_EQ(paces.find(3), nullptr);
  ASSERT_NE(paces.find(4), nullptr);
  EXPECT_EQ(paces.find(4)->at(0), 7);
}

// Best lengths b = 1 + t / 2. Those of the further run are c b in the middle of the step: x = c (1 + (t + x / 2) / 2),
// so x = c (1 + t / 2) / (1 - c / 4).
TEST(PacedStep, HasTheLengthThatItsMiddleAllows) {
  Pace pace;
  constexpr double safety = 0.8, brief = 1e-12;
  pace.note(0, brief, 1);
  pace.note(100, brief, 51);
  const auto exact = [](double c, double t) { return c * (1 + t / 2) / (1 - c / 4); };
  const double c = 0.3;
  PacedStep step = PacedStep::first(pace, safety, 4, c);
  EXPECT_NEAR(step.proposed(), safety * exact(c, 4), 2e-3);
  // The next step understands the length that this one proposes: c is the same.
  const double next = step.next(5, exact(c, 5));
  EXPECT_NEAR(next, safety * exact(c, 5), 1e-12);
  PacedStep further(pace, safety, 5, next);
  EXPECT_NEAR(further.next(8, exact(c, 8)), safety * exact(c, 8), 1e-12);
  // A try that could have been twice as long raises c, one that could have been half as long lowers it.
  const auto learnt = [&](double times) {
    PacedStep tried = further;
    tried.learn(0.5, times * c * pace.at(5.25));
    return tried.next(8, exact(c, 8));
  };
  EXPECT_NEAR(learnt(1), further.next(8, exact(c, 8)), 1e-12);
  EXPECT_GT(learnt(2), 1.1 * learnt(1));
  EXPECT_LT(learnt(0.5), 0.95 * learnt(1));
}

struct Taken {
  long long evaluations, rejected;
  std::vector<double> ends;
  Paces paces;
};

// A slider crank that falls to and fro for 4 s: quick and slow by turns.
Taken run(double local_error, double safety, const Paces* paced_by) {
  Settings s = settings(Solver::direct, Drift::projection, -9.81);
  s.integrator = Integrator::dop853, s.local_error = local_error;
  World<double> world(s);
  add_slider_crank(world);
  Taken taken{0, 0, {}, Paces(local_error, safety)};
  world.data().paced_by = paced_by, world.data().paces = &taken.paces;
  for (int k = 0; k < 64; ++k) {
    EXPECT_TRUE(world.step(4.0 / 64));
    taken.ends.push_back(world.pose(2).x);
  }
  taken.evaluations = world.step_counts().evaluations, taken.rejected = world.step_counts().rejected;
  return taken;
}

double apart(const Taken& a, const Taken& b) {
  double most = 0;
  for (std::size_t k = 0; k < a.ends.size(); ++k) most = std::max(most, std::abs(a.ends[k] - b.ends[k]));
  return most;
}

TEST(PacedSteps, AreRejectedLessAtTheSameError) {
  const Taken loose = run(1e-3, 0.8, nullptr), strict = run(1e-12, 0.9, nullptr);
  for (const double local_error : {1e-5, 1e-6, 1e-8}) {
    const Taken alone = run(local_error, 0.9, nullptr), paced = run(local_error, 0.8, &loose.paces);
    fmt::print("  {:.0e}: {} evaluations, {} rejected, off by {:.1e}; alone {}, {}, {:.1e}\n", local_error,
               paced.evaluations, paced.rejected, apart(paced, strict), alone.evaluations, alone.rejected,
               apart(alone, strict));
    EXPECT_LT(paced.rejected, 0.5 * static_cast<double>(alone.rejected));
    EXPECT_LT(static_cast<double>(paced.evaluations), 0.92 * static_cast<double>(alone.evaluations));
    EXPECT_LT(apart(paced, strict), 3 * apart(alone, strict));
  }
}

// A body without forces could go all the way at once.
TEST(PacedSteps, HaveABound) {
  Settings s = settings(Solver::direct, Drift::projection, 0);
  s.integrator = Integrator::dop853, s.local_error = 1e-6;
  World<double> world(s);
  const int body = world.add_body({.mass = 1, .inertia = 1});
  world.set_velocity(body, {1, 0, 0});
  Paces paces(1e-6, usual_safety, 0.2);
  world.data().paces = &paces;
  for (int k = 0; k < 4; ++k) ASSERT_TRUE(world.step(0.25));
  EXPECT_LE(world.step_counts().longest, 0.2);
  EXPECT_EQ(world.step_counts().taken, 5);
  EXPECT_NEAR(world.pose(body).x, 1, 1e-12);
}

// Notes alone change no bit, and a paced run has the same bits again.
TEST(PacedSteps, AreTheSameOnEveryRun) {
  const Taken noted = run(1e-6, usual_safety, nullptr);
  Settings s = settings(Solver::direct, Drift::projection, -9.81);
  s.integrator = Integrator::dop853, s.local_error = 1e-6;
  World<double> world(s);
  add_slider_crank(world);
  for (const double end : noted.ends) {
    ASSERT_TRUE(world.step(4.0 / 64));
    ASSERT_EQ(world.pose(2).x, end);
  }
  EXPECT_EQ(run(1e-8, 0.8, &noted.paces).ends, run(1e-8, 0.8, &noted.paces).ends);
}

}  // namespace
}  // namespace cdot::test::pace_test
