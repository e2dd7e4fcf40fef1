// Runs of a search that follow the pace of the run before.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "runtime/tool/search/yardstick.hpp"
#include "tests/runtime/tool/support.hpp"

namespace cdot::test::paced_search_test {
namespace {

// Named with the same local error and step, the method rejects more steps. The report says so. A run that goes on from
// a saved state follows the same pace: its end has the bits of the whole run's.
TEST(SearchedAccuracy, FollowsThePaceOfTheRunBefore) {
  for (const char* name : {"crank_rocker", "compound_pendulum", "gallery/trammel"}) {
    const Scene scene = scene_named(name);
    std::string warnings;
    RunOptions options;
    options.save_at = scene.duration / 2;
    const RunResult paced = simulate(scene, options, warnings);
    const Choice& choice = paced.choice.value();
    ASSERT_EQ(choice.integrator, Integrator::dop853) << name;
    ASSERT_NEAR(choice.local_error, 2e-6, 1e-12) << name << ": throughout";
    EXPECT_TRUE(choice.paced);
    EXPECT_NE(summary_text(scene, paced).find("named, the method takes others"), std::string::npos);
    const RunResult named = simulate(solved_by(choice, scene), {}, warnings);
    fmt::print("  {:20} {} evaluations, {} rejected; named {} and {}\n", name, choice.evaluations,
               paced.counts.rejected, named.counts.evaluations, named.counts.rejected);
    EXPECT_LT(2 * paced.counts.rejected, named.counts.rejected) << name;
    EXPECT_LT(static_cast<double>(choice.evaluations), 0.95 * static_cast<double>(named.counts.evaluations)) << name;
    EXPECT_EQ(summary_text(scene, named).find("by the pace"), std::string::npos);
    RunOptions further;
    further.from = paced.state;
    EXPECT_EQ(simulate(scene, further, warnings).energy_end, paced.energy_end) << name;
  }
}

// The first run passes circles in four steps. Shorter steps follow, not shorter intervals, whose ends each cost as much
// as a stage.
TEST(SearchedAccuracy, AsksForShorterStepsWithoutMoreLooks) {
  const Scene scene = scene_named("gallery/epicycloid");
  std::string warnings;
  const RunResult result = simulate(scene, {}, warnings);
  const Choice& choice = result.choice.value();
  fmt::print("  {} and {} evaluations, steps of up to {:.3g} s\n", choice.evaluations_before, choice.evaluations,
             result.counts.longest);
  EXPECT_TRUE(choice.reached);
  EXPECT_EQ(choice.step, scene.duration / intervals_of_own_steps);
  EXPECT_LE(result.counts.longest, scene.duration / 2);
  EXPECT_LT(choice.evaluations, 180);
}

// A linkage that its motor drives: C = 0 tells where its bodies are, so a loose run hardly errs. The next one, which
// begins at 2e-6, goes on with a larger local error. A run from a state has the same bits. An output just before an
// interval ends is by the run's own steps: it is off by the rest of the motion.
TEST(SearchedAccuracy, GoesOnLooserWhereTwoRunsAgree) {
  Scene scene = scene_named("gallery/peaucellier");
  std::string warnings;
  RunOptions options;
  options.save_at = scene.duration / 32;  // before it gets that
  std::vector<Frame> rows, exact;
  const double interval = scene.duration / intervals_of_own_steps, before = 1e-5 * interval;
  for (int k = 1; k < intervals_of_own_steps; ++k)
    options.row_times.push_back(k * interval - before), options.row_times.push_back(k * interval);
  options.row = [&](const Frame& frame) { rows.push_back(frame); };
  const RunResult looser = simulate(scene, options, warnings);
  const Choice& choice = looser.choice.value();
  EXPECT_TRUE(choice.reached);
  EXPECT_GT(choice.local_error, 2e-5);
  EXPECT_LT(choice.evaluations, 330);
  RunOptions further;
  further.from = looser.state;
  EXPECT_EQ(simulate(scene, further, warnings).energy_end, looser.energy_end);
  scene.settings.integrator = Integrator::dop853, scene.settings.local_error = 1e-11;
  scene.step = interval;
  options.row = [&](const Frame& frame) { exact.push_back(frame); };
  run_once(scene, options, warnings);
  ASSERT_EQ(rows.size(), exact.size());
  const Yardstick yardstick(scene_named("gallery/peaucellier"));
  double off = 0, jump = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) off = std::max(off, yardstick.apart(rows[k], exact[k]));
  for (std::size_t k = 0; k < rows.size(); k += 2)
    for (std::size_t body = 0; body < scene.bodies.size(); ++body) {
      const BodyState &early = rows[k].bodies[body], &late = rows[k + 1].bodies[body];
      jump = std::max(jump, std::abs(late.x - early.x - before * late.vx));
      jump = std::max(jump, std::abs(late.y - early.y - before * late.vy));
    }
  fmt::print("  local error {:.1e}, {} evaluations; claims {:.1e}, is off by {:.1e}; {:.1e} between\n",
             choice.local_error, choice.evaluations, choice.achieved, off, jump);
  EXPECT_LT(jump, 1e-11);
  EXPECT_LT(off, choice.achieved);
}

}  // namespace
}  // namespace cdot::test::paced_search_test
