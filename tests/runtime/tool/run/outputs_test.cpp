// Requested outputs change no bit of a run, and between the ends of steps they are as accurate as at the ends.
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <map>

#include <cdot/methods.hpp>

#include "runtime/tool/run/trajectory.hpp"
#include "tests/runtime/tool/support.hpp"

namespace cdot::test::outputs_test {
namespace {

struct Method {
  Integrator integrator;
  bool adaptive;
};

void PrintTo(const Method& method, std::ostream* out) { *out << name_of(integrators, method.integrator); }

std::vector<Method> all_methods() {
  std::vector<Method> methods;
  for (const IntegratorRow& row : integrator_rows)
    for (const bool adaptive : {false, true})
      if (!adaptive || row.level == Level::acceleration) methods.push_back({row.integrator, adaptive});
  return methods;
}

class Outputs : public testing::TestWithParam<Method> {
 protected:
  Scene scene_of(const char* name, double until, double step) const {
    Scene scene = scene_named(name);
    scene.duration = until;
    scene.step = step;
    scene.settings.integrator = GetParam().integrator;
    scene.settings.local_error = GetParam().adaptive ? 1e-7 : 0;
    return scene;
  }
};

struct Run {
  std::map<double, Frame> ends;
  Snapshot state;
  long long steps;
};

Run run_of(const Scene& scene, const std::vector<double>& times, const std::vector<double>& film) {
  Run run;
  RunOptions options;
  options.row = [&](const Frame& frame) { run.ends[frame.time] = frame; };
  options.row_times = times;
  options.film_times = film;
  options.save_at = scene.duration;
  std::string warnings;
  const RunResult result = simulate(scene, options, warnings);
  run.state = result.state;
  run.steps = result.steps;
  return run;
}

bool same_bits(const BodyState& a, const BodyState& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

// Outputs at 1 % and 62 % of every step, at its end, and of a film.
void expect_same_bits(const Scene& scene) {
  const Run without = run_of(scene, {}, {});
  std::vector<double> times;
  double before = 0;
  for (const auto& [time, frame] : without.ends) {
    if (time > 0) times.insert(times.end(), {before + 0.01 * (time - before), before + 0.618 * (time - before)});
    times.push_back(before = time);
  }
  const Run with = run_of(scene, times, equal_times(scene.duration, 37));
  EXPECT_EQ(with.steps, without.steps) << scene.file;
  EXPECT_EQ(with.ends.size(), times.size()) << scene.file;
  EXPECT_EQ(with.state.differences(without.state), std::vector<std::string>{}) << scene.file;
  for (const auto& [time, frame] : without.ends)
    for (std::size_t k = 0; k < frame.bodies.size(); ++k)
      ASSERT_TRUE(same_bits(with.ends.at(time).bodies[k], frame.bodies[k])) << scene.file << " at " << time << " s";
}

TEST_P(Outputs, ChangeNoBit) {
  expect_same_bits(scene_of("double_pendulum", 2, 0.01));
  expect_same_bits(scene_of("chain_10", 1, 0.01));
  expect_same_bits(scene_of("machine", 1, 0.01));
  expect_same_bits(scene_of("crank_rocker", 1, 0.01));
  expect_same_bits(scene_of("spatial/four_bar", 2, 0.03));
  expect_same_bits(scene_of("spatial/four_bar", 2, 0.003));
  expect_same_bits(scene_of("spatial/gyroscope", 0.5, 0.01));
  expect_same_bits(scene_of("spatial/three_bodies", 1, 0.01));
  Scene breaking = scene_of("chain_10", 1, 0.01);
  breaking.joints[4].bonds = {{"breaking", {{"strength", {100}}}}};
  expect_same_bits(breaking);
}

struct Worst {
  double at_ends = 0, between = 0;
};

// The largest distance from the exact motion, of positions, angles and velocities, at the ends of every step and at
// three places inside.
Worst worst_of(const Scene& scene) {
  RunOptions options;
  const auto steps = std::llround(scene.duration / scene.step);
  for (long long k = 0; k < steps; ++k)
    for (const double share : {0.15, 0.5, 0.85, 1.0})
      options.row_times.push_back((static_cast<double>(k) + share) * scene.step);
  // Its steps end at all these times: it requests nothing.
  const Way way{.integrator = Integrator::dop853, .adaptive = true};
  const Trajectory exact = trajectory_of(scene, way, {1, 1e-13}, options.row_times);
  Worst worst;
  std::size_t next = 0;
  options.row = [&](const Frame& frame) {
    double& of = next % 4 == 3 ? worst.at_ends : worst.between;
    const Frame& was = exact.frames.at(next++);
    of = std::max(of, apart(frame, was, scene.dimension).larger());
    for (std::size_t k = 0; k < frame.bodies.size(); ++k) {
      const BodyState &a = frame.bodies[k], &b = was.bodies[k];
      of = std::max({of, std::hypot(a.vx - b.vx, a.vy - b.vy, a.vz - b.vz), std::abs(a.w - b.w),
                     std::hypot(a.wx - b.wx, a.wy - b.wy, a.wz - b.wz)});
    }
  };
  std::string warnings;
  simulate(scene, options, warnings);
  EXPECT_EQ(next, exact.frames.size());
  return worst;
}

// Four runs, each with half the step of the last, or a hundredth of the local error. Passing a loss of rank, the
// spatial four-bar has no clean order: its states between must only be as good as those at the ends.
TEST_P(Outputs, BetweenStepsAreOfTheOrder) {
  struct {
    const char* scene;
    double until, step;
    bool has_order;
  } const problems[] = {{"double_pendulum", 1, 0.02, true},
                        {"four_bar", 1, 0.02, true},
                        {"spatial/four_bar", 1, 0.02, false},
                        {"spatial/gyroscope", 0.2, 0.002, true}};
  const auto [integrator, adaptive] = GetParam();
  constexpr double round_off = 3e-9;  // of the reference in the flat pose of the four-bars
  for (const auto& [name, until, step, has_order] : problems) {
    // Radau IIA leaves flat poses to another method, and says so.
    if (integrator == Integrator::radau5 && std::string_view(name).ends_with("four_bar")) continue;
    double before = 0;
    for (int halvings = 0; halvings < 4; ++halvings) {
      const double coarsest = integrator == Integrator::dop853 ? 5 * step : step;
      Scene scene = scene_of(name, until, coarsest / (1 << halvings));
      if (adaptive) scene.settings.local_error = 1e-5 * std::pow(0.01, halvings);
      const Worst now = worst_of(scene);
      const double slope = std::log2(before / now.between);
      fmt::print("  {} {:.2e}: off by {:.2e} at ends, {:.2e} between, slope {:.2f}\n", name, scene.step, now.at_ends,
                 now.between, slope);
      EXPECT_LT(now.between, (adaptive ? 5 : 1.1) * now.at_ends + round_off) << name << " " << scene.step;
      if (halvings > 0 && !adaptive && has_order && now.between > round_off) {
        EXPECT_GT(slope, 0.8 * row_of(integrator).order) << name << " " << scene.step;
      }
      before = now.between;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Methods, Outputs, testing::ValuesIn(all_methods()), [](const auto& info) {
  return fmt::format("{}{}", name_of(integrators, info.param.integrator), info.param.adaptive ? "_adaptive" : "");
});

// After 400,000 steps the World's time, a sum, is off by 2.5e-9 s; a run that goes on from there keeps the steps' ends.
TEST(LongRun, GoesOnWithItsBits) {
  const TemporaryFolder folder;
  const std::string state = folder / "run.state", further = folder / "further.csv", whole = folder / "whole.csv";
  const std::string run = fmt::format("simulate '{}' --integrator euler --step 0.001 --every 0.5",
                                      (scenes_dir() / "simple_pendulum.toml").string());
  ASSERT_EQ(cdot_run(fmt::format("{} --until 400 --save-state '{}'", run, state)).status, 0);
  EXPECT_EQ(cdot_run(fmt::format("{} --until 400.5 --from-state '{}' -o '{}'", run, state, further)).status, 0);
  EXPECT_EQ(cdot_run(fmt::format("{} --until 400.5 -o '{}'", run, whole)).status, 0);
  const auto last_row = [](const std::string& file) {
    const std::string text = read_text(file);
    return text.substr(text.rfind('\n', text.size() - 2) + 1);
  };
  EXPECT_EQ(last_row(further).substr(0, 6), "400.5,");
  EXPECT_EQ(last_row(further), last_row(whole));
}

}  // namespace
}  // namespace cdot::test::outputs_test
