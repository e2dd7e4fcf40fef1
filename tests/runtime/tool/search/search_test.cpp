// Scenes that ask for an accuracy, by default or in numbers: what the run claims to have is measured against references
// that no method of the runtime made.
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cdot/methods.hpp>

#include "runtime/tool/run/trajectory.hpp"
#include "runtime/tool/search/attempt.hpp"
#include "runtime/tool/search/yardstick.hpp"
#include "tests/runtime/tool/support.hpp"

namespace cdot::test::search_test {
namespace {

struct Problem {
  const char* scene;
  bool of_peers;  // its reference is in tests/bench/peers
  const char* reference;
};

const Problem problems[] = {
    {"simple_pendulum", false, "simple_pendulum"}, {"compound_pendulum", false, "compound_pendulum"},
    {"double_pendulum", false, "double_pendulum"}, {"four_bar", false, "four_bar"},
    {"slider_crank", false, "slider_crank"},       {"pulley_ratio1", false, "pulley_ratio1"},
    {"pulley_ratio2", false, "pulley_ratio2"},     {"spatial/torque_free_body", false, "torque_free_body"},
    {"spatial/chain_10", true, "spatial_chain"},   {"spatial/gyroscope", true, "gyroscope"},
};
constexpr double four_bar_until = 0.7;  // [s]: before two motions are possible

// The error that the run claims, and its distance from the reference in the same unit.
struct Measured {
  Choice choice;
  double error = 0, reference = 0;
};

Measured measured(const Problem& problem, double accuracy) {
  Scene scene = scene_named(problem.scene);
  const double until = problem.scene == std::string("four_bar") ? four_bar_until : scene.duration;
  Reference reference =
      problem.of_peers ? read_reference_of_peers(problem.reference) : read_reference(problem.reference, until);
  scene.duration = reference.samples.back().time;
  scene.step = 0, scene.settings = {.gravity_x = scene.settings.gravity_x,
                                    .gravity_y = scene.settings.gravity_y,
                                    .gravity_z = scene.settings.gravity_z};
  scene.accuracy = accuracy;
  Yardstick yardstick(scene);
  Measured measured;
  std::size_t next = 0;
  RunOptions options;
  for (const ReferenceSample& sample : reference.samples) options.row_times.push_back(sample.time);
  options.row = [&](const Frame& frame) {
    Frame exact = frame;
    for (std::size_t k = 0; k < exact.bodies.size(); ++k)
      exact.bodies[k] = reference.samples[next].bodies.at(scene.bodies[k].name);
    measured.error = std::max(measured.error, yardstick.apart(frame, exact));
    ++next;
  };
  std::string warnings;
  const RunResult result = simulate(scene, options, warnings);
  EXPECT_EQ(failure(scene, result), "") << problem.scene;
  EXPECT_EQ(next, reference.samples.size());
  measured.choice = result.choice.value();
  measured.reference = reference.accuracy;
  return measured;
}

// 1e-4 of the size and 1e-4 rad, of every problem with a reference, at a price that is stated.
TEST(DefaultAccuracy, HoldsEveryProblemWithAReference) {
  for (const Problem& problem : problems) {
    const Measured now = measured(problem, 0);
    fmt::print("  {:24} {:9} claims {:.1e}, is off by {:.1e}; {} evaluations and {} before\n", problem.scene,
               name_of(integrators, now.choice.integrator), now.choice.achieved, now.error, now.choice.evaluations,
               now.choice.evaluations_before);
    EXPECT_TRUE(now.choice.reached) << problem.scene;
    EXPECT_TRUE(now.choice.of_size);
    EXPECT_LE(now.error, default_accuracy + now.reference) << problem.scene;
    EXPECT_LE(now.choice.evaluations_before, 2 * now.choice.evaluations) << problem.scene;
  }
}

// No run is off by more than three times what it claims, nor by more than it was asked for.
// In equilibrium by statics: they must stay. The tension of 50 N makes the chain's links stiff.
TEST(DefaultAccuracy, LeavesAtRestWhatStands) {
  for (const char* name : {"cantilever", "catenary_100"}) {
    Scene scene = scene_named(name);
    scene.step = 0;
    const Yardstick yardstick(scene);
    const auto [result, rows] = recorded(scene, 0.5);
    EXPECT_TRUE(result.choice->reached) << name;
    double moved = 0;
    for (const Frame& row : rows) moved = std::max(moved, yardstick.apart(row, rows.front()));
    fmt::print("  {:24} {:9} claims {:.1e}, moves by {:.1e}; {} evaluations and {} before\n", name,
               name_of(integrators, result.choice->integrator), result.choice->achieved, moved,
               result.choice->evaluations, result.choice->evaluations_before);
    EXPECT_LE(moved, default_accuracy) << name;
  }
}

// A bob on a damped spring: radau5 where stiffness is dear, dop853 where it is not or where the accuracy is high.
TEST(SearchedAccuracy, IsReachedAtEveryStiffness) {
  for (const double stiffness : {1e4, 1e6, 1e8, 1e10})
    for (const double accuracy : {1e-4, 1e-6, 1e-8}) {
      const Scene scene =
          read_scene(fmt::format("duration = 2\naccuracy = {}\n"
                                 "[[body]]\nname = \"bob\"\nposition = [1, 0]\nmass = 1\ninertia = 0.1\n"
                                 "[[spring]]\nbodies = [\"world\", \"bob\"]\nstiffness = {}\nrest = 1\ndamping = {}\n",
                                 accuracy, stiffness, 0.1 * std::sqrt(stiffness)),
                     "bob");
      std::string warnings;
      const RunResult result = simulate(scene, {}, warnings);
      const Choice& choice = result.choice.value();
      fmt::print("  {:.0e} N/m, {:.0e}: {}, {} evaluations and {} before\n", stiffness, accuracy,
                 name_of(integrators, choice.integrator), choice.evaluations, choice.evaluations_before);
      EXPECT_TRUE(choice.reached) << stiffness << " " << accuracy;
      if (stiffness == 1e10) {
        EXPECT_EQ(choice.integrator, Integrator::radau5);
        EXPECT_LE(choice.evaluations_before, 3 * choice.evaluations);
      }
    }
}

TEST(SearchedAccuracy, IsWhatTheRunClaims) {
  double worst = 0;
  for (const Problem& problem : problems)
    for (const double accuracy : {1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9}) {
      const Measured now = measured(problem, accuracy);
      // References round to doubles and have an error of their own.
      const double beyond = std::max(0.0, now.error - now.reference - 1e-13) / now.choice.achieved;
      EXPECT_LE(now.error, accuracy + now.reference) << problem.scene << " " << accuracy;
      EXPECT_LE(beyond, 3) << problem.scene << " " << accuracy << ": " << now.error << ", claimed "
                           << now.choice.achieved;
      worst = std::max(worst, now.choice.achieved > 0 ? beyond : 0);
    }
  fmt::print("  off by at most {:.2g} times the claim\n", worst);
}

// A double pendulum from above: differences grow by 1e4 in about 4 s.
Scene chaotic() {
  Scene scene = scene_named("double_pendulum");
  scene.bodies[0].definition.x = 0, scene.bodies[0].definition.y = 0.5, scene.bodies[0].definition.angle = 1.5707963;
  scene.bodies[1].definition.x = 0.5 * std::cos(0.4), scene.bodies[1].definition.y = 1 + 0.5 * std::sin(0.4);
  scene.bodies[1].definition.angle = 0.4;
  scene.project = true;
  scene.duration = 60;
  return scene;
}

TEST(SearchedAccuracy, OfAChaoticMotionIsToldByTime) {
  Scene scene = chaotic();
  const auto [result, rows] = recorded(scene, 0.5);
  const Choice& choice = result.choice.value();
  ASSERT_FALSE(choice.reached);
  EXPECT_GT(choice.holds_until, 5);
  EXPECT_LT(choice.holds_until, 60);
  // By default a warning, as asked for a failure.
  EXPECT_EQ(failure(scene, result), "");
  EXPECT_NE(summary_text(scene, result).find(fmt::format("holds up to t = {:.6g} s", choice.holds_until)),
            std::string::npos);
  Scene asked = chaotic();
  asked.accuracy = 1e-4;
  const RunResult failed = recorded(asked, 0.5).result;
  EXPECT_NE(failure(asked, failed).find("holds up to t = "), std::string::npos) << failure(asked, failed);
  // Up to that time another method agrees, in extended precision: round-off counts here.
  const Way way{.integrator = Integrator::rk4, .extended = true};
  constexpr int steps = 10000;  // to each frame
  const double halves = std::floor(choice.holds_until / 0.5);
  const Trajectory truth =
      trajectory_of(chaotic(), way, {steps}, equal_times(0.5 * halves, static_cast<int>(halves), 1));
  double apart = 0;
  for (std::size_t k = 0; k < truth.frames.size(); ++k)
    apart = std::max(apart, cdot::apart(truth.frames[k], rows[k + 1], scene.dimension).larger());
  fmt::print("  holds up to {} s, and is off by {:.1e} up to then\n", choice.holds_until, apart);
  EXPECT_LT(apart, 1e-4);
}

// A rod that jams is left to Euler's method. Runs with its steps in shorter intervals measure its error.
TEST(SearchedAccuracy, CountsStepsThatAreLeftToEuler) {
  const auto hard_case = [](const char* name) {
    Scene scene = read_scene((source_dir() / "tests/hard_cases" / name / "planar.toml").string());
    scene.step = 0;
    return scene;
  };
  const Scene scene = hard_case("jamming_rod");
  std::string warnings;
  const RunResult result = simulate(scene, {}, warnings);
  const Choice& choice = result.choice.value();
  EXPECT_TRUE(choice.reached);
  EXPECT_GT(choice.rescued, 0);
  EXPECT_GT(choice.first_rescue, 0);
  EXPECT_LT(choice.step, scene.duration / intervals_of_own_steps);  // in shorter intervals than the first run
  Scene named = hard_case("pulley_at_zero_rope");
  named.step = named.duration / intervals_of_own_steps;
  named.settings.integrator = Integrator::dop853, named.settings.local_error = 1e-9;
  const RunResult broken = simulate(named, {}, warnings);
  const std::string text = summary_text(named, broken);
  EXPECT_NE(text.find("the local error 1.0e-09 is broken: "), std::string::npos) << text;
  EXPECT_NE(text.find(fmt::format("first by t = {:.6g} s, where the largest force was the ", broken.first_rescue)),
            std::string::npos)
      << text;
  EXPECT_NE(text.find(" N of joint \""), std::string::npos) << text;
}

// At rest, and dear for explicit methods: they are not even begun.
TEST(SearchedAccuracy, OfAStiffChainAtRestIsCheap) {
  Scene scene = read_scene((source_dir() / "tests/hard_cases/hanging_chain/planar.toml").string());
  scene.step = 0;
  std::string warnings;
  const RunResult result = simulate(scene, {}, warnings);
  EXPECT_TRUE(result.choice->reached);
  EXPECT_EQ(result.choice->integrator, Integrator::implicit);
  EXPECT_EQ(result.choice->runs_before, 1);
}

// Only the first run may be dear: a finer one is not begun anew.
TEST(SearchedAccuracy, RefinesWithoutRunningAnythingTwice) {
  const Scene scene = scene_named("spatial/four_bar");
  std::string warnings;
  const RunResult result = simulate(scene, {}, warnings);
  EXPECT_TRUE(result.choice->reached);
  EXPECT_EQ(result.choice->runs_before, 2);
}

// The second run of a four-bar that passes its change points ends early: then its distance from the first tells how
// strict the third has to be.
TEST(SearchedAccuracy, EndsARunThatCannotAgree) {
  const Scene scene = scene_named("four_bar");
  std::string warnings;
  const RunResult result = simulate(scene, {}, warnings);
  EXPECT_TRUE(result.choice->reached);
  EXPECT_EQ(result.choice->runs_before, 2);
  EXPECT_LT(result.choice->evaluations_before, 0.8 * static_cast<double>(result.choice->evaluations));
}

// Two runs by dop853 whose local errors differ by a factor of 10^4. The distance of the second from the truth is sure
// to be 100 times smaller than theirs; 1000 times where the energies say so, too; and unknown beyond a radian.
TEST(SearchedAccuracy, TrustsLargeGainsWhereTheEnergyShowsThem) {
  const Yardstick yardstick(scene_named("simple_pendulum"));
  Attempt coarse, fine;
  coarse.knob = {Integrator::dop853, 1e-2}, fine.knob = {Integrator::dop853, 1e-6};
  coarse.energy_share = 1e-3;
  const auto sure = [&](double energy_share, double apart) {
    fine.energy_share = energy_share;
    return sure_gain(yardstick, coarse, fine, apart);
  };
  EXPECT_NEAR(sure(1e-3, 0.01), 100, 1e-6);
  EXPECT_NEAR(sure(1e-7, 0.01), 1000, 1e-4);
  EXPECT_NEAR(sure(1e-12, 0.01), 1000, 1e-4);  // no more than the local errors promise
  EXPECT_NEAR(sure(1e-3 / 2401, 0.01), 343, 1e-6);
  EXPECT_EQ(sure(1e-7, 1.01), 1);
  coarse.knob.integrator = fine.knob.integrator = Integrator::rk4;
  EXPECT_NEAR(sure(1e-7, 0.01), 100, 1e-6);
}

// Masses on a rope move along parabolas, which equal steps meet exactly. Three free bodies take long steps as well, but
// equal ones miss their turning: those end where they differ, within a third of the 192 evaluations of all.
TEST(SearchedAccuracy, OfEvenMotionsComesByEqualSteps) {
  std::string warnings;
  const RunResult even = simulate(scene_named("pulley_ratio1"), {}, warnings);
  EXPECT_TRUE(even.choice->reached);
  EXPECT_EQ(even.choice->integrator, Integrator::rattle);
  EXPECT_EQ(even.choice->runs_before, 1);
  Scene turning = scene_named("spatial/three_bodies");
  turning.step = 0;
  const RunResult other = simulate(turning, {}, warnings);
  EXPECT_TRUE(other.choice->reached);
  EXPECT_EQ(other.choice->integrator, Integrator::dop853);
  EXPECT_EQ(other.choice->runs_before, 2);
  EXPECT_LT(other.choice->evaluations_before, 72 + 192 / 3);
}

// Two runs reach the accuracy. With the work of one and a half, the second ends early and the first is delivered.
TEST(SearchedAccuracy, EndsAtItsBudgetAndSaysSo) {
  const Scene scene = scene_named("double_pendulum");
  std::string warnings;
  const auto with_budget = [&](double work) {
    RunOptions options;
    options.search_work = work;
    return simulate(scene, options, warnings);
  };
  const RunResult whole = with_budget(1e8);
  const double each = 4 + 2;  // work of an evaluation of two bodies
  const double first = each * static_cast<double>(whole.choice->evaluations_before),
               second = each * static_cast<double>(whole.choice->evaluations);
  EXPECT_TRUE(whole.choice->reached);
  EXPECT_EQ(whole.choice->runs_before, 1);
  const RunResult result = with_budget(first + second / 2);
  EXPECT_FALSE(result.choice->reached);
  EXPECT_EQ(static_cast<double>(result.choice->evaluations) * each, first);
  EXPECT_LE(static_cast<double>(result.choice->evaluations_before) * each, 0.6 * second);
  EXPECT_NEAR(result.time, scene.duration, 1e-9);  // a run that has ended is delivered
  const std::string text = summary_text(scene, result);
  EXPECT_NE(text.find("the search ended at its budget, after "), std::string::npos) << text;
}

// One step as long as the run takes hundreds of evaluations by the method's own steps. The bound ends it inside.
TEST(Simulate, ABoundOfEvaluationsHoldsWithinAStep) {
  Scene scene = scene_named("double_pendulum");
  scene.settings.integrator = Integrator::dop853, scene.settings.local_error = 1e-10, scene.step = scene.duration;
  std::string warnings;
  RunOptions options;
  const RunResult whole = simulate(scene, options, warnings);
  EXPECT_FALSE(whole.stopped);
  ASSERT_GT(whole.counts.evaluations, 650);
  options.most_evaluations = 300;
  const RunResult bounded = simulate(scene, options, warnings);
  EXPECT_TRUE(bounded.stopped);
  EXPECT_EQ(bounded.counts.rescued, 1);
  EXPECT_LE(bounded.counts.evaluations, 300 + 50);  // a step of dop853 and the midpoint rule
}

// A motor turns a wheel 1000 times and keeps its energy, whatever its angle is: only the angles tell the error.
TEST(SearchedAccuracy, IsNotJudgedByAnEnergyThatTellsNothing) {
  Scene scene = read_scene((source_dir() / "tests/hard_cases/angle_past_half_a_turn/spatial.toml").string());
  scene.step = 0;
  for (const double accuracy : {1e-3, 1e-4, 1e-5}) {
    scene.accuracy = accuracy;
    const auto [result, rows] = recorded(scene, 0.1);
    EXPECT_TRUE(result.choice->reached) << accuracy;
    double worst = 0;
    for (const Frame& frame : rows) {
      const double e0 = frame.bodies[2].e0, e3 = frame.bodies[2].e3, half = 50 * frame.time;
      worst = std::max(worst, 2 * std::abs(e3 * std::cos(half) - e0 * std::sin(half)));
    }
    fmt::print("  {:.0e}: claims {:.1e}, is off by {:.1e}\n", accuracy, result.choice->achieved, worst);
    EXPECT_LE(worst, 3 * result.choice->achieved) << accuracy;
  }
}

// A turn about a fixed axis at 1 rad/s has no acceleration: the local error bounds no step of it.
TEST(SearchedAccuracy, IsMeasuredByOtherSteps) {
  Scene scene = read_scene((source_dir() / "tests/hard_cases/gimbal_lock/six_dof.toml").string());
  scene.step = 0;
  for (const double accuracy : {1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8}) {
    scene.accuracy = accuracy;
    const auto [result, rows] = recorded(scene, 0.1);
    EXPECT_TRUE(result.choice->reached) << accuracy;
    double worst = 0;
    for (const Frame& frame : rows) {
      const BodyState& arm = frame.bodies[0];
      worst = std::max(worst, std::abs(2 * std::atan2(arm.e2, arm.e0) - frame.time));
    }
    fmt::print("  {:.0e}: claims {:.1e}, is off by {:.1e}, by steps of at most {:.2g} s\n", accuracy,
               result.choice->achieved, worst, result.counts.longest);
    EXPECT_LE(worst, 3 * result.choice->achieved) << accuracy;
    EXPECT_LE(result.counts.longest, scene.duration / 2) << "steps that nothing bounds are halved";
  }
}

TEST(SearchedAccuracy, BelowRoundOffEndsTheSearchSoon) {
  Scene scene = scene_named("double_pendulum");
  scene.accuracy = 1e-16;
  std::string warnings;
  const RunResult result = simulate(scene, {}, warnings);
  EXPECT_FALSE(result.choice->reached);
  EXPECT_LE(result.choice->runs_before, 5);
  EXPECT_LT(result.choice->evaluations_before, 2 * result.choice->evaluations);
  EXPECT_NE(failure(scene, result).find("accuracy 1.0e-16 m, rad holds up to t = "), std::string::npos)
      << failure(scene, result);
}

// Rows that were asked for change neither the choice nor the run.
TEST(SearchedAccuracy, IsTheSameWithAndWithoutOutputs) {
  const Scene scene = scene_named("crank_rocker");
  std::string warnings;
  const auto [with, rows] = recorded(scene, 0.01);
  const RunResult without = simulate(scene, {}, warnings);
  EXPECT_EQ(rows.size(), 201u);
  EXPECT_EQ(with.choice->local_error, without.choice->local_error);
  EXPECT_EQ(with.choice->achieved, without.choice->achieved);
  EXPECT_EQ(with.energy_end, without.energy_end);
}

// A method on the command line replaces an accuracy, and an accuracy a method.
TEST(Command, TakesAnAccuracyOrAMethod) {
  const std::string scene = "simulate '" + (scenes_dir() / "double_pendulum.toml").string() + "' --json ";
  const auto json = [&](const std::string& options) { return nlohmann::json::parse(cdot_run(scene + options).out); };
  const auto by_default = json("");
  EXPECT_EQ(by_default["accuracy"]["asked"], 1e-4);
  EXPECT_EQ(by_default["accuracy"]["unit"], "size, rad");
  EXPECT_EQ(by_default["accuracy"]["reached"], true);
  EXPECT_GT(double(by_default["accuracy"]["search"]["cpu"]), 0);
  EXPECT_EQ(json("--accuracy 1e-7")["accuracy"]["unit"], "m, rad");
  for (const char* method : {"--step 0.01", "--integrator rattle", "--integrator dop853 --local-error 1e-8"})
    EXPECT_FALSE(json(method).contains("accuracy")) << method;
  EXPECT_EQ(json("--integrator rattle")["step"], default_step);
  EXPECT_EQ(cdot_run(scene + "--accuracy 1e-7 --step 0.01").status, 2);
}

}  // namespace
}  // namespace cdot::test::search_test
