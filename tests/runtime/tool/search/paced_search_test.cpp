// Runs of a search that follow the pace of the run before.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/runtime/tool/support.hpp"

namespace cdot::test::paced_search_test {
namespace {

// Named with the same local error and step, the method rejects more steps. The report says so. A run that goes on from
// a saved state follows the same pace: its end has the bits of the whole run's.
TEST(SearchedAccuracy, FollowsThePaceOfTheRunBefore) {
  for (const char* name : {"slider_crank", "compound_pendulum", "spatial/chain_10"}) {
    const Scene scene = scene_named(name);
    std::string warnings;
    RunOptions options;
    options.save_at = scene.duration / 2;
    const RunResult paced = simulate(scene, options, warnings);
    const Choice& choice = paced.choice.value();
    ASSERT_EQ(choice.integrator, Integrator::dop853) << name;
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

}  // namespace
}  // namespace cdot::test::paced_search_test
