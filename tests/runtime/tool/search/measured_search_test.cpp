// Runs of a search that only measure the one before.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "runtime/tool/search/yardstick.hpp"
#include "tests/runtime/tool/support.hpp"

namespace cdot::test::measured_search_test {
namespace {

// The second run ends early, and the third is aimed at the accuracy. The first one is more than a radian off and cannot
// tell whether it got there: a fourth run that is a little finer does, for less than a half more. Then the first one
// runs again, disturbed.
TEST(SearchedAccuracy, MeasuresAnAimedRunByOneALittleFiner) {
  const Scene scene = scene_named("spatial/torque_free_body");
  std::string warnings;
  std::vector<Frame> rows, truth;
  RunOptions options;
  options.row = [&](const Frame& frame) { rows.push_back(frame); };
  const Choice choice = simulate(scene, options, warnings).choice.value();
  Choice exact = choice;
  exact.local_error = 1e-12;
  options.row = [&](const Frame& frame) { truth.push_back(frame); };
  simulate(solved_by(exact, scene), options, warnings);
  ASSERT_EQ(rows.size(), truth.size());
  double off = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) off = std::max(off, Yardstick(scene).apart(rows[k], truth[k]));
  fmt::print("  {} and {} evaluations, {:.1e} off, {:.1e} claimed\n", choice.evaluations_before, choice.evaluations,
             off, choice.achieved);
  EXPECT_EQ(choice.runs_before, 4);
  EXPECT_TRUE(choice.reached);
  EXPECT_LT(off, choice.achieved);
  EXPECT_LT(choice.evaluations, 1.15 * static_cast<double>(choice.evaluations_before));
}

}  // namespace
}  // namespace cdot::test::measured_search_test
