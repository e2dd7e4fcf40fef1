// Parts of `cdot-run accuracy`: the frontier of given numbers, errors against a closed form, interrupted sweeps.
// command_test.cpp tests the output.
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <random>

#include "runtime/tool/accuracy/sweep.hpp"
#include "runtime/tool/run/output.hpp"
#include "tests/methods.hpp"
#include "tests/runtime/tool/accuracy/pendulum.hpp"
#include "tests/runtime/tool/support.hpp"

namespace cdot::test {
namespace {

// --- the frontier and the advice ---

TEST(Frontier, OfPointsByHand) {
  const std::vector<CostedError> points = {
      {1e-1, 5}, {1e-2, 10}, {2e-2, 20}, {1e-4, 40}, {1e-2, 10}, {1e-4, 41}, {1, 4}, {1, 6},
  };
  EXPECT_EQ(frontier_of(points, 0), (std::vector<std::size_t>{6, 0, 1, 3}));
  // Errors below 1e-3 count as equal: the point of 1e-4 still beats that of 1e-2.
  EXPECT_EQ(frontier_of(points, 1e-3), (std::vector<std::size_t>{6, 0, 1, 3}));
  EXPECT_EQ(frontier_of(points, 1e-2), (std::vector<std::size_t>{6, 0, 1}));
  EXPECT_EQ(frontier_of({}, 0), std::vector<std::size_t>{});
}

// A point is on the frontier if and only if no other point is better in one quantity and not worse in the other.
TEST(Frontier, HasThePointsThatNoOtherBeats) {
  std::mt19937 random(1);
  std::uniform_int_distribution<int> digit(0, 20);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<CostedError> points;
    for (int k = 0; k < 25; ++k) points.push_back({std::pow(10.0, -digit(random)), 1.0 + digit(random)});
    const std::vector<std::size_t> frontier = frontier_of(points, 0);
    for (std::size_t k = 0; k < points.size(); ++k) {
      const auto better = [&](const CostedError& p) {
        return p.error <= points[k].error && p.cost <= points[k].cost &&
               (p.error < points[k].error || p.cost < points[k].cost);
      };
      const auto same = [&](std::size_t i) {
        return points[i].error == points[k].error && points[i].cost == points[k].cost;
      };
      const bool beaten = std::any_of(points.begin(), points.end(), better);
      EXPECT_EQ(std::count_if(frontier.begin(), frontier.end(), same), beaten ? 0 : 1) << "trial " << trial;
    }
  }
}

TEST(Frontier, AdviceIsTheCheapestForEachDecade) {
  const std::vector<CostedError> points = {{0.5, 1}, {0.05, 2}, {2e-3, 8}, {1e-4, 16}};
  const std::vector<Advice> advice = advice_from(points, frontier_of(points, 0));
  ASSERT_EQ(advice.size(), 4u);  // 1e-1, 1e-2, 1e-3, 1e-4
  const std::vector<std::size_t> chosen = {1, 2, 3, 3};
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(advice[k].decade, -1 - static_cast<int>(k));
    EXPECT_EQ(advice[k].point, chosen[k]);
  }
  EXPECT_DOUBLE_EQ(*advice[0].factor, 4);
  EXPECT_DOUBLE_EQ(*advice[1].factor, 2);
  EXPECT_DOUBLE_EQ(*advice[2].factor, 1);
  EXPECT_FALSE(advice[3].factor);
}

// --- errors, against the closed form of the pendulum ---

Frame frame_of_one(const BodyState& body, double energy) {
  Frame frame;
  frame.bodies = {body};
  frame.energy = energy;
  return frame;
}

TEST(Distances, AreOfPlacesAndTurns) {
  const Frame a = frame_of_one({1, 2, 0.5, 0, 0, 0}, 0), b = frame_of_one({1.3, 2.4, 0.2, 0, 0, 0}, 0);
  EXPECT_NEAR(apart(a, b, Dimension::planar).position, 0.5, 1e-15);
  EXPECT_NEAR(apart(a, b, Dimension::planar).angle, 0.3, 1e-15);
  // q and -q are the same orientation; rotations by 1 and 1.25 about z differ by 0.25.
  const auto about_z = [](double angle, double sign) {
    BodyState body{};
    body.z = angle;
    body.e0 = sign * std::cos(angle / 2), body.e3 = sign * std::sin(angle / 2);
    return body;
  };
  const Apart turned = apart(frame_of_one(about_z(1, 1), 0), frame_of_one(about_z(1.25, -1), 0), Dimension::spatial);
  EXPECT_NEAR(turned.position, 0.25, 1e-15);
  EXPECT_NEAR(turned.angle, 0.25, 1e-15);
}

TEST(Distances, ErrorsAreTheLargestOfAllSamples) {
  ReferenceRun reference;
  Trajectory trajectory;
  for (int k = 0; k < 3; ++k) {
    reference.frames.push_back(frame_of_one({0, 0, 0, 0, 0, 0}, 5));
    trajectory.frames.push_back(frame_of_one({k == 1 ? 0.1 : 0.01, 0, k == 2 ? -0.3 : 0, 0, 0, 0}, k == 0 ? 4 : 5.5));
  }
  trajectory.C = 7, trajectory.Cdot = 8;
  trajectory.least_energy = 4, trajectory.most_energy = 5.5;
  const Errors errors = errors_of(trajectory, reference, Scene());
  EXPECT_EQ(errors, (Errors{0.1, 0.3, 7, 8, 1}));
  EXPECT_EQ(errors.trajectory(), 0.3);
  // The energy was further off between the samples.
  trajectory.least_energy = 3;
  EXPECT_EQ(errors_of(trajectory, reference, Scene()).energy, 2);
  // If the reference does not conserve energy, the energy between the samples is unknown.
  reference.frames[0].energy = 4;
  EXPECT_EQ(errors_of(trajectory, reference, Scene()).energy, 0.5);
  reference.frames[0].energy = 5;
  Scene damped;
  damped.bodies.emplace_back().definition.linear_damping = 1;
  EXPECT_EQ(errors_of(trajectory, reference, damped).energy, 1);
}

// Euler's C and energy oscillate: the largest values at 16 samples are below the true ones.
TEST(Distances, AreSeenAfterEveryStep) {
  const Scene scene = pendulum_scene();
  const std::vector<double> times = equal_times(2, sample_count), fine = equal_times(2, 64 * sample_count);
  const Way way{Integrator::euler, Solver::direct, Drift::baumgarte};
  const Trajectory sampled = trajectory_of(scene, way, {64, 0}, times);
  const Trajectory watched = trajectory_of(scene, way, {64, 0}, times, {}, {}, true);
  const Trajectory every = trajectory_of(scene, way, {1, 0}, fine);
  fmt::print("  |C| {:.4e} at the samples, {:.4e} after every step\n", sampled.C, watched.C);
  EXPECT_LT(sampled.C, watched.C);
  EXPECT_EQ(watched.C, every.C);
  EXPECT_EQ(watched.Cdot, every.Cdot);
  EXPECT_EQ(watched.least_energy, every.least_energy);
  EXPECT_EQ(watched.most_energy, every.most_energy);
  EXPECT_EQ(watched.frames.size(), times.size());
}

class Slopes : public testing::TestWithParam<Way> {};

// As long as the error is small and above round-off, halving the step divides it by 2^order.
TEST_P(Slopes, AreTheOrder) {
  const Way& way = GetParam();
  const Scene scene = pendulum_scene();
  const ReferenceRun reference = closed_form();
  double before = 0;
  int seen = 0;
  for (int steps = 1; steps <= 4096; steps *= 2) {
    const Trajectory trajectory = trajectory_of(scene, way, {steps, 0}, reference.times);
    const Errors errors = errors_of(trajectory, reference, scene);
    const double now = errors.trajectory();
    fmt::print("  {} steps: {:.3e}", steps, now);
    if (before > 0 && before < 1e-2 && now > 1e-11) {
      fmt::print(", order {:.2f}", std::log2(before / now));
      EXPECT_NEAR(std::log2(before / now), order_of(way.integrator), order_of(way.integrator) > 4 ? 1 : 0.3);
      ++seen;
    }
    fmt::print("\n");
    before = now;
  }
  EXPECT_GE(seen, order_of(way.integrator) > 4 ? 1 : 3);
}

std::string test_name(const testing::TestParamInfo<Way>& info) {
  return fmt::format("{}_{}", name_of(integrators, info.param.integrator), name_of(drifts, info.param.drift));
}

INSTANTIATE_TEST_SUITE_P(Ways, Slopes,
                         testing::Values(Way{Integrator::euler, Solver::direct, Drift::none},
                                         Way{Integrator::euler, Solver::direct, Drift::projection},
                                         Way{Integrator::implicit}, Way{Integrator::rattle}, Way{Integrator::rk4},
                                         Way{Integrator::dop853}),
                         test_name);

// --- sweeps ---

SweepOptions small_sweep() {
  SweepOptions options;
  options.ways = {{Integrator::euler, Solver::direct, Drift::projection},
                  {Integrator::euler, Solver::direct, Drift::projection, 0, true},
                  {Integrator::euler, Solver::iterative, Drift::baumgarte, 4}};
  options.levels = 6;
  options.rounds = 3;
  options.budget = 1e9;
  return options;
}

TEST(Sweep, CoversEveryWayAndLevel) {
  SweepState state;
  state.reference = closed_form();
  const SweepOptions options = small_sweep();
  ASSERT_TRUE(sweep(pendulum_scene(), options, state, {}));
  EXPECT_EQ(state.points.size(), 18u);
  for (const Point& point : state.points) {
    if (!point.failure.empty()) continue;
    EXPECT_EQ(point.rounds.size(), 3u);
    EXPECT_GT(point.cost(), 0);
  }
  const std::vector<Point> answers = answers_of(state, options.ways);
  EXPECT_EQ(answers.size() + failures_of(state, options.ways).size(), 18u);
  for (std::size_t k = 1; k < answers.size(); ++k) {
    if (answers[k].way == answers[k - 1].way) {
      EXPECT_GT(answers[k].level, answers[k - 1].level);
    }
  }
}

// Runs with a reported time of 1 s each: the budget counts the runs, their rounds of timing and the estimate for the
// next level.
TEST(Sweep, EndsWhereItsBudgetDoes) {
  SweepOptions options = small_sweep();
  options.rounds = 1;
  SweepState begun;
  begun.reference = closed_form();
  for (const Way& way : options.ways) begun.points.push_back({way, 0, {}, {0.1, 0.1, 0, 0, 0}, 1, 0.5, {}});
  const auto levels_within = [&](double budget) {
    SweepState state = begun;
    options.budget = budget;
    EXPECT_TRUE(sweep(pendulum_scene(), options, state, {}));
    return state.points.size();
  };
  // Spent: 3 runs of 1 s, 0.5 s for measuring errors, and 1 s for timing. Level 1 would take 2 s, 1 s for errors, and
  // its timing.
  EXPECT_EQ(levels_within(12.4), 3u);
  EXPECT_GT(levels_within(12.6), 3u);
}

std::vector<std::pair<std::string, Errors>> results_of(const SweepState& state, const SweepOptions& options) {
  std::vector<std::pair<std::string, Errors>> results;
  for (const Point& point : answers_of(state, options.ways))
    results.emplace_back(fmt::format("{} level {}", name_of(point.way), point.level), point.errors);
  return results;
}

// A sweep that is stopped, written, read and resumed every few results equals one in a single run, except for times.
TEST(Sweep, InterruptedAndResumedIsTheSame) {
  const Scene scene = pendulum_scene();
  const SweepOptions options = small_sweep();
  SweepState whole;
  whole.reference = closed_form();
  ASSERT_TRUE(sweep(scene, options, whole, {}));

  const TemporaryFolder folder;
  const std::string path = folder / "state.json";
  const Fingerprint fingerprint{"program", "scene"};
  SweepState pieces;
  pieces.reference = closed_form();
  write_state(path, fingerprint, pieces);
  bool finished = false;
  int interruptions = 0;
  for (; !finished && interruptions < 100; ++interruptions) {
    SweepState state = read_state(path, fingerprint);
    int found = 0;
    SweepHooks hooks;
    hooks.stop = [&] { return found >= 5; };
    hooks.grown = [&](double, double, const std::string&) { ++found; };
    finished = sweep(scene, options, state, hooks);
    write_state(path, fingerprint, state);
    pieces = state;
  }
  EXPECT_GT(interruptions, 5);
  EXPECT_TRUE(finished);
  EXPECT_EQ(results_of(pieces, options), results_of(whole, options));
  for (const Point& point : answers_of(pieces, options.ways)) EXPECT_EQ(point.rounds.size(), 3u);
}

TEST(Sweep, AStateOfSomethingElseIsRefused) {
  const TemporaryFolder folder;
  const std::string path = folder / "state.json";
  const auto refusal = [&](const Fingerprint& fingerprint) -> std::string {
    try {
      read_state(path, fingerprint);
    } catch (const std::exception& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(refusal({"p", "s"}), path + ": cannot be read");
  write_file(path, "{}");
  EXPECT_EQ(refusal({"p", "s"}), path + ": not the state of an interrupted sweep");
  write_state(path, {"p", "s"}, {});
  EXPECT_EQ(refusal({"p", "s"}), "accepted");
  EXPECT_EQ(refusal({"p", "other"}),
            path + ": the scene, its duration or its reference has changed since: start again without --resume");
  EXPECT_EQ(refusal({"other", "s"}), path + ": another build of cdot-run wrote it: start again without --resume");
}

}  // namespace
}  // namespace cdot::test
