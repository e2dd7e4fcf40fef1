// The error that a run estimates of itself, against its distance from a run of much higher accuracy.
#include "runtime/tool/run/error_estimate.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cdot/methods.hpp>
#include <cdot/spaces.hpp>

#include "runtime/state/world_data.hpp"
#include "runtime/tool/run/error_report.hpp"
#include "runtime/tool/run/simulate.hpp"
#include "runtime/tool/search/advice.hpp"
#include "tests/runtime/tool/support.hpp"

namespace cdot::test::error_estimate_test {
namespace {

TrajectoryError estimate(const Scene& scene) {
  std::string warnings;
  return simulate(scene, {}, warnings).error;
}

Scene mechanism(const char* name, Integrator integrator, double step) {
  Scene scene = scene_named(name);
  scene.duration = std::min(scene.duration, 5.0);
  scene.step = step;
  scene.settings.integrator = integrator;
  return scene;
}

// Errors of four methods over seven decades. Beyond half a radian the phase is lost, and an error has no size. A few
// samples of an oscillating error overestimate its sum.
TEST(ErrorEstimate, IsNeverMuchBelowTheErrorNorHopelesslyAbove) {
  for (const char* name : {"compound_pendulum", "double_pendulum", "four_bar", "slider_crank", "machine",
                           "spatial/chain_10", "spatial/gyroscope"})
    for (const Integrator integrator : {Integrator::euler, Integrator::implicit, Integrator::rattle, Integrator::rk4}) {
      const Scene scene = mechanism(name, integrator, 0.01);
      const Apart is = true_error(scene);
      const TrajectoryError said = estimate(scene);
      fmt::print("{:18} {:8}  off by {:.1e} m, {:.1e} rad; estimated {:.1e} m, {:.1e} rad from {} samples\n", name,
                 name_of(integrators, integrator), is.position, is.angle, said.position, said.angle, said.samples);
      EXPECT_GE(std::max(said.position, said.angle), 0.15 * std::min(0.5, is.larger()))
          << name << " " << name_of(integrators, integrator);
      EXPECT_LE(said.position, 100 * is.position) << name << " " << name_of(integrators, integrator);
    }
}

TEST(ErrorEstimate, FollowsTheOrderOfTheMethod) {
  for (const auto& [integrator, order] :
       {std::pair{Integrator::euler, 1}, {Integrator::rattle, 2}, {Integrator::implicit, 2}, {Integrator::rk4, 4}}) {
    const double coarse = estimate(mechanism("double_pendulum", integrator, 0.01)).position,
                 fine = estimate(mechanism("double_pendulum", integrator, 0.005)).position;
    EXPECT_NEAR(std::log2(coarse / fine), order, 0.6) << name_of(integrators, integrator);
  }
}

// The midpoint rule halves a step that it cannot solve: the parts of a half would be the same.
TEST(ErrorEstimate, SeesStepsThatTheMethodDivides) {
  Scene scene = mechanism("spatial/gyroscope", Integrator::implicit, 1.0 / 60);
  const double is = true_error(scene).larger(), said = estimate(scene).share;
  fmt::print("off by {:.1e}, estimated {:.1e}\n", is, said);
  EXPECT_GE(said, 0.15 * is);
}

// Sweeps without end leave the error of the steps alone: more sweeps would not show it.
TEST(ErrorEstimate, SeesLongStepsBySweeps) {
  Scene scene = mechanism("double_pendulum", Integrator::euler, 0.01);
  scene.settings.solver = Solver::iterative;
  scene.settings.iterations = 200;
  const double is = true_error(scene).larger(), said = estimate(scene).share;
  fmt::print("off by {:.1e}, estimated {:.1e}\n", is, said);
  EXPECT_GE(said, 0.15 * is);
}

long long steps_of_world = 0;

struct Spent {
  long long steps = 0;  // of the run's World, beyond those of the run
  int samples = 0;
};

// The steps that the estimate takes in a run of so many.
Spent spent_by_estimate(Scene scene, long long steps) {
  using Space = Planar<double>;
  scene.duration = scene.step * static_cast<double>(steps);
  std::string warnings;
  auto world = world_at_start<Space>(scene, warnings);
  steps_of_world = 0;
  world.data().after_substep.push_back([](WorldData<Space>&, double) { ++steps_of_world; });
  ErrorEstimate<Space> estimate(scene, steps);
  const int bodies = static_cast<int>(scene.bodies.size());
  Frame before = frame_of(world, 0, bodies);
  for (long long k = 1; k <= steps; ++k) {
    estimate.before_step(world, k, scene.step);
    EXPECT_TRUE(world.step(scene.step));
    const Frame after = frame_of(world, static_cast<double>(k) * scene.step, bodies);
    estimate.after_step(world, before, after, k);
    before = after;
  }
  return {steps_of_world - steps, estimate.error().samples};
}

// A sample is one long step; none by RK4, which has its own rates; a step in parts, two or for the midpoint rule three;
// or twelve in a World of their own. Going back counts as one more. The start of the first window that promises a
// warning is made anew.
TEST(ErrorEstimate, TakesATwentiethOfTheStepsAndTwentyMore) {
  struct Kind {
    const char* what;
    Integrator integrator;
    Solver solver;
    double step;
    int of_sample;  // in a second World
  };
  for (const auto& [what, integrator, solver, step, of_sample] : {
           Kind{"longer steps", Integrator::rattle, Solver::direct, 1e-4, 0},
           Kind{"own rates", Integrator::rk4, Solver::direct, 1e-3, 0},
           Kind{"in parts", Integrator::implicit, Solver::direct, 1e-3, 0},
           Kind{"doubted", Integrator::rattle, Solver::direct, 0.05, 0},
           Kind{"sweeps", Integrator::euler, Solver::iterative, 1e-3, 12},
       }) {
    for (const long long steps : {5, 20, 60, 200, 1000}) {
      Scene scene = mechanism("double_pendulum", integrator, step);
      scene.settings.solver = solver;
      const auto [more, samples] = spent_by_estimate(scene, steps);
      const long long taken = more + (of_sample + 1) * samples;
      fmt::print("{:13} {:4} steps: {:2} samples for {:2} steps\n", what, steps, samples, taken);
      EXPECT_GE(samples, 1) << what << ", " << steps << " steps";
      EXPECT_LE(static_cast<double>(taken), 20 + 0.05 * static_cast<double>(steps))
          << what << ", " << steps << " steps";
      EXPECT_EQ(more == 0, solver == Solver::iterative || (integrator == Integrator::rk4 && steps >= 4))
          << "for sweeps a second World takes the steps, and RK4 needs none for four steps";
    }
  }
}

void expect_error_of(const Scene& scene, const char* what) {
  const Apart is = true_error(scene);
  const TrajectoryError said = estimate(scene);
  fmt::print("{:28} {:.2f} s: off by {:.1e} m, {:.1e} rad; estimated {:.1e} m, {:.1e} rad\n", what, scene.duration,
             is.position, is.angle, said.position, said.angle);
  EXPECT_GE(said.share, 0.15 * std::min(0.5, is.angle)) << what;
  EXPECT_LE(said.position, 20 * is.position) << what;
}

// Four steps as one fail at this crank, and are not tried again: two as one are, from there on.
TEST(ErrorEstimate, GivesUpLongStepsThatFail) {
  for (const long long steps : {5, 20, 60}) {
    Scene scene = mechanism("slider_crank", Integrator::rattle, 0.002);
    const auto [more, samples] = spent_by_estimate(scene, steps);
    EXPECT_GE(samples, 2);
    EXPECT_EQ(more, samples) << "steps that fail, and their parts, end no step";
    scene.duration = scene.step * static_cast<double>(steps);
    expect_error_of(scene, "four as one fail");
  }
}

// Four steps as one promise a warning. The first two of them as one tell the error.
TEST(ErrorEstimate, TakesTheStartOfAWindowInDoubtAnew) {
  for (const int steps : {20, 60}) {
    Scene scene = mechanism("double_pendulum", Integrator::rattle, 0.05);
    scene.duration = scene.step * steps;
    expect_error_of(scene, "four as one are in doubt");
  }
}

// In RK4's steps with events its rates jump: other steps take their place, where three discs leave their domes.
TEST(ErrorEstimate, TakesOtherStepsWhereRatesJump) {
  long long taken = 0;
  for (const int steps : {120, 150, 180, 210, 240}) {
    const auto [more, samples] = spent_by_estimate(mechanism("gallery/dome", Integrator::rk4, 1.1 / steps), steps);
    EXPECT_LE(more, 20) << steps << " steps";
    EXPECT_GE(samples, 5) << steps << " steps";
    taken += more;
  }
  EXPECT_GE(taken, 2);
}

// Euler's method falls too far by h^2 g / 2 in each step. Five steps have one sample, of the first three.
TEST(ErrorEstimate, OfTheLastSampleStandsForTheRest) {
  Scene scene = mechanism("simple_pendulum", Integrator::euler, 1e-3);
  scene.joints.clear(), scene.duration = 5 * scene.step;
  scene.trajectory_tolerance = 1e3;  // of a point the distance that it falls: nothing is doubted
  const TrajectoryError said = estimate(scene);
  EXPECT_EQ(said.samples, 1);
  const double exact = 5 * scene.step * scene.step / 2 * std::abs(scene.settings.gravity_y);
  EXPECT_NEAR(said.position, exact, 1e-9 * exact);
}

// Steps that are only compared close joints less than those of the run.
TEST(ErrorEstimate, LeavesTheBitsOfTheRunAlone) {
  const Scene scene = mechanism("four_bar", Integrator::rattle, 0.01);
  std::vector<BodyState> ends[2];
  for (const bool estimates : {false, true}) {
    RunOptions options;
    options.estimates_error = estimates;
    options.row = [&](const Frame& frame) { ends[estimates] = frame.bodies; };
    std::string warnings;
    EXPECT_EQ(simulate(scene, options, warnings).error.samples > 1, estimates);
  }
  ASSERT_EQ(ends[0].size(), ends[1].size());
  for (std::size_t k = 0; k < ends[0].size(); ++k) {
    EXPECT_EQ(ends[0][k].x, ends[1][k].x);
    EXPECT_EQ(ends[0][k].angle, ends[1][k].angle);
    EXPECT_EQ(ends[0][k].vy, ends[1][k].vy);
    EXPECT_EQ(ends[0][k].w, ends[1][k].w);
  }
}

// A run tells its balance after some steps. By looks at each of them the extremes are the same.
TEST(ErrorEstimate, OfTheEnergyIsTheWorstOfAllSteps) {
  for (const Integrator integrator : {Integrator::rattle, Integrator::rk4}) {
    Scene scene = mechanism("machine", integrator, 0.01);
    std::string warnings;
    scene.duration = 0.75;
    auto world = world_at_start<Planar<double>>(scene, warnings);
    BalanceWatch each;
    each.look(world.balance());
    for (int k = 1; k <= 75; ++k) {
      ASSERT_TRUE(world.step(scene.step));
      each.look(world.balance());
    }
    const BalanceWatch told = simulate(scene, {}, warnings).balance;
    const auto expect_same = [](const BalanceWatch::Worst& a, const BalanceWatch::Worst& b) {
      EXPECT_NEAR(a.amount, b.amount, 1e-12 * a.scale);
      EXPECT_NEAR(a.scale, b.scale, 1e-12 * a.scale);
      EXPECT_NEAR(a.time, b.time, 1e-12);
    };
    EXPECT_NE(each.energy.time, scene.duration) << "no worst moment within the run";
    expect_same(told.energy, each.energy), expect_same(told.risen, each.risen);
  }
}

// Momenta are looked at every 32 steps, and at the end.
TEST(ErrorEstimate, OfMomentaIsKnownOfShortRuns) {
  Scene scene = mechanism("spatial/torque_free_body", Integrator::rk4, 0.1);
  scene.duration = 10 * scene.step;
  std::string warnings;
  const BalanceWatch::Worst worst = simulate(scene, {}, warnings).balance.angular;
  EXPECT_GT(worst.amount, 0);
  EXPECT_NEAR(worst.time, scene.duration, 1e-12);
}

TEST(ErrorEstimate, OfOwnStepsIsNone) {
  Scene scene = scene_named("compound_pendulum");
  scene.settings.integrator = Integrator::dop853;
  scene.settings.local_error = 1e-6;
  EXPECT_EQ(estimate(scene).samples, 0);  // a method that chooses its steps has an estimate of its own
}

// A pendulum at a coarse step is off by some per cent: the tolerance decides between silence, a warning and a failure.
TEST(ErrorEstimate, PassesWarnsOrFailsByTheToleranceOfTheScene) {
  Scene scene = mechanism("compound_pendulum", Integrator::rattle, 0.05);
  const auto with = [&](double tolerance) {
    scene.trajectory_tolerance = tolerance;
    std::string warnings;
    const RunResult result = simulate(scene, {}, warnings);
    EXPECT_EQ(failure(scene, result).empty(), trajectory_failure(scene, result).empty());
    EXPECT_EQ(needs_advice(scene, result),
              !failure(scene, result).empty() || !trajectory_warning(scene, result).empty());
    return std::pair{failure(scene, result), trajectory_warning(scene, result)};
  };
  const double share = estimate(scene).share;
  ASSERT_GT(share, 0.02);
  EXPECT_EQ(with(11 * share), std::pair(std::string(), std::string()));
  EXPECT_NE(with(9 * share).second.find("the trajectory of \"rod\" is off by about"), std::string::npos);
  EXPECT_NE(with(0.9 * share).first.find("the trajectory of \"rod\" is off by about"), std::string::npos);
  EXPECT_EQ(with(0).second.empty(), share <= 0.1);
  EXPECT_EQ(with(0).first, "");
}

// A light chain under a heavy load at a game's step: what is advised was tried, and holds when pasted.
TEST(ErrorEstimate, WarnsWithAFixThatHolds) {
  const std::string file = (source_dir() / "tests/hard_cases/heavy_load/planar.toml").string();
  const auto ran = [&](const std::string& options) {
    const CommandResult result = cdot_run(fmt::format("simulate '{}' {} --json", file, options));
    EXPECT_EQ(result.status, 0);
    return nlohmann::json::parse(result.out);
  };
  const auto warned = ran("");
  EXPECT_NE(warned["trajectory_warning"], "");
  const std::string pasted = warned["advice"]["options"];
  ASSERT_NE(pasted, "");
  EXPECT_EQ(ran(pasted)["trajectory_warning"], "");
  // The promise, by a run of much higher accuracy.
  ASSERT_EQ(pasted, "--integrator dop853 --local-error 1e-06");
  Scene scene = read_scene(file);
  scene.settings.integrator = Integrator::dop853, scene.settings.local_error = 1e-6;
  const double promised = warned["advice"]["off"], is = true_error(scene).angle;
  EXPECT_GE(promised, is / 3);
  EXPECT_LE(promised, 1e-3);
}

}  // namespace
}  // namespace cdot::test::error_estimate_test
