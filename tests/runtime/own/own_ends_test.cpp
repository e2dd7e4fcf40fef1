// Ends that begin to hold where they are passed, by a spec that no catalogue has.
#include <cdot/balance.hpp>
#include <cdot/integrators.hpp>
#include <cdot/methods.hpp>

#include "runtime/own/own.hpp"
#include "tests/runtime/support.hpp"

namespace cdot::test {
namespace {

std::string late_end() {
  const OwnType own = add_own_type(CDOT_SOURCE_DIR "/tests/derive/compile/scenes/late_end.effect");
  EXPECT_EQ(own.problems, "");
  return own.name;
}

struct Slider {
  int body, guide;
};
Slider slides(World<double>& world, int on, double v, double mass) {
  const int body = world.add_body({.vx = v, .mass = mass, .inertia = 1});
  const int guide = world.add_joint({"prismatic", {body, on}, {{"pa", {0, 0}}, {"pb", {0, 0}}, {"t", {0, 1}}}, {}});
  return {body, guide};
}

// A bob slides ahead on a carriage until its end begins to hold behind it. The bodies meet there without a bounce, as
// P = (M + m) V says, and their centre of mass goes on. A step that closed the end on its way threw the bob back, by
// Euler's method only beside a body that moves faster than the end is far.
TEST(OwnEnds, AnEndThatIsPassedAsItBeginsThrowsNoBody) {
  constexpr double M = 1000, m = 1, V = 10, v = 11, begin = 0.3, h = 0.01, meets = (M * V + m * v) / (M + m);
  const std::string type = late_end();
  for (const Solver solver : {Solver::direct, Solver::iterative})
    for (const IntegratorRow& row : integrator_rows)
      for (const double beyond : {0.2, 0.02, 0.001}) {
        if (solver == Solver::iterative && row.integrator == Integrator::radau5) continue;
        Settings by = settings(solver);
        by.integrator = row.integrator;
        World<double> world(by);
        const int carriage = slides(world, world.ground(), V, M).body;
        const auto [bob, guide] = slides(world, carriage, v, m);
        const double top = (v - V) * begin - beyond;
        add_effect(world, guide, "slide", SpecEffect{type, {{"top", {top}}, {"begin", {begin}}}});
        for (int k = 0; k < 50; ++k) ASSERT_TRUE(world.step(h));
        const double from = world.pose(carriage).x, to = world.pose(bob).x,
                     tolerance = solver == Solver::direct ? 1e-9 : 1e-5;
        EXPECT_NEAR(to - from, top, tolerance) << row.name << ", by " << beyond;
        EXPECT_NEAR((M * from + m * to) / (M + m), meets * world.time(), tolerance) << row.name << ", by " << beyond;
        EXPECT_NEAR(world.velocity(carriage).x, meets, tolerance) << row.name << ", by " << beyond;
        EXPECT_NEAR(world.velocity(bob).x, meets, tolerance) << row.name << ", by " << beyond;
        const Balance balance = world.balance();
        EXPECT_NEAR(balance.taken - balance.put_in, M * m / (M + m) * (v - V) * (v - V) / 2, 1e-5) << row.name;
      }
}

// A force presses the slider on beyond the end. By methods that locate the event it stands where it is until the step
// ends, which tells how far the end is passed; the next step moves it to the end.
TEST(OwnEnds, AnEndThatIsPassedAsItBeginsHoldsAgainstAForce) {
  constexpr double v = 1, force = 0.5, begin = 0.303, top = 0.1, h = 0.01;
  constexpr double stands = v * begin + force * begin * begin / 2;
  const std::string type = late_end();
  for (const Integrator by : {Integrator::rk4, Integrator::dop853, Integrator::radau5}) {
    World<double> world({.integrator = by});
    const int body = world.add_body({.vx = v, .mass = 1, .inertia = 1, .force_x = force});
    const int guide =
        world.add_joint({"prismatic", {body, world.ground()}, {{"pa", {0, 0}}, {"pb", {0, 0}}, {"t", {0, 1}}}, {}});
    add_effect(world, guide, "slide", SpecEffect{type, {{"top", {top}}, {"begin", {begin}}}});
    for (int k = 0; k < 31; ++k) ASSERT_TRUE(world.step(h));
    EXPECT_NEAR(world.pose(body).x, stands, 1e-9) << name_of(integrators, by);
    EXPECT_NEAR(world.worst_passed_end().by, stands - top, 1e-9) << name_of(integrators, by);
    for (int k = 0; k < 9; ++k) {
      ASSERT_TRUE(world.step(h));
      EXPECT_NEAR(world.pose(body).x, top, 1e-12) << name_of(integrators, by);
      EXPECT_NEAR(world.velocity(body).x, 0, 1e-12) << name_of(integrators, by);
    }
    EXPECT_EQ(world.step_counts().rescued, 0) << name_of(integrators, by);
  }
}

// The same end moves the slider back against the force, and does that work at once; it also takes the motion.
TEST(OwnEnds, AnEndThatMovesABodyBackDoesTheWork) {
  constexpr double v = 1, force = 0.5, begin = 0.303, top = 0.1, h = 0.01;
  const std::string type = late_end();
  for (const Solver solver : {Solver::direct, Solver::iterative})
    for (const IntegratorRow& row : integrator_rows) {
      if (solver == Solver::iterative && row.integrator == Integrator::radau5) continue;
      Settings by = settings(solver);
      by.integrator = row.integrator;
      World<double> world(by);
      const int body = world.add_body({.vx = v, .mass = 1, .inertia = 1, .force_x = force});
      const int guide =
          world.add_joint({"prismatic", {body, world.ground()}, {{"pa", {0, 0}}, {"pb", {0, 0}}, {"t", {0, 1}}}, {}});
      add_effect(world, guide, "slide", SpecEffect{type, {{"top", {top}}, {"begin", {begin}}}});
      for (int k = 0; k < 40; ++k) ASSERT_TRUE(world.step(h));
      double work = 0;
      for (const WorkOfSource& source : world.work_by_source()) work += source.name == type ? source.work : 0;
      // Methods that do not locate the event lose or gain the work of the force in half a step.
      const double half_step = force * (v + force * begin) * h / 2;
      const double tolerance = row.level != Level::acceleration ? half_step : solver == Solver::direct ? 1e-9 : 1e-5;
      EXPECT_NEAR(world.pose(body).x, top, 1e-5) << row.name;
      EXPECT_NEAR(work, -force * top - v * v / 2, tolerance) << row.name;
      EXPECT_NEAR(world.balance().method(), 0, tolerance) << row.name;
    }
}

// A rod of 1 m, or a taut rope, holds a slider at 0.8 m, where an end at 0.5 m begins to hold: no pose
// reaches it. Shared among all rows, its error would open the joints by decimetres.
TEST(OwnEnds, AnEndThatNoPoseReachesTearsNoJoint) {
  constexpr double begin = 0.3, h = 0.01;
  const std::string type = late_end();
  for (const IntegratorRow& row : integrator_rows) {
    for (const bool rope : {false, true}) {
      World<double> world({.integrator = row.integrator, .gravity_x = -10});
      const int body = world.add_body({.x = 0.8, .mass = 1, .inertia = 1}), ground = world.ground();
      const int guide =
          world.add_joint({"prismatic", {body, ground}, {{"pa", {0, 0}}, {"pb", {0, 0}}, {"t", {0, 1}}}, {}});
      const auto hook = rope ? std::vector{1.4, 0.8} : std::vector{0.0, 0.6};
      world.add_joint(
          {rope ? "max_distance" : "distance", {body, ground}, {{"pa", {0, 0}}, {"pb", hook}, {"l", {1}}}, {}});
      add_effect(world, guide, "slide", SpecEffect{type, {{"top", {0.5}}, {"begin", {begin}}}});
      StepResult result;
      for (int k = 0; k < 40 && result; ++k) result = world.step(h);
      EXPECT_EQ(result.problem, StepProblem::joints_apart) << row.name << ", " << rope;
      EXPECT_NEAR(result.time, begin, 1.5 * h) << row.name << ", " << rope;
      EXPECT_NEAR(world.pose(body).x, 0.8, 1e-9) << row.name << ", " << rope;
      EXPECT_LT(world.worst_position_error().value, 1e-9) << row.name << ", " << rope;
    }
  }
}

}  // namespace
}  // namespace cdot::test
