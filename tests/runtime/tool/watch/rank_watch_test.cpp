// Losses of rank along a run.
#include "runtime/tool/watch/rank_watch.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace cdot::test::rank_watch_test {
namespace {

std::vector<RankLoss> watched(double (*share)(double)) {
  RankWatch watch;
  for (int k = 1; k <= 1000; ++k) watch.look(0.01 * k, {share(0.01 * k), 3, 1});
  watch.end();
  return watch.found();
}

// The pivot of a mechanism that lies flat at 1, 3, 5, 7 and 9 s.
TEST(RankWatch, FindsEveryDip) {
  const auto found = watched([](double t) { return std::pow(std::cos(1.57079632679 * t), 2) + 1e-12; });
  ASSERT_EQ(found.size(), 5u);
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_NEAR(found[k].time, 1 + 2.0 * static_cast<double>(k), 1e-9);
    EXPECT_LT(found[k].row.share, 1e-11);
    EXPECT_EQ(found[k].row.joint, 3);
    EXPECT_EQ(found[k].row.row, 1);
  }
}

TEST(RankWatch, FindsNoneWhereAPivotStaysSmallOrRipples) {
  EXPECT_TRUE(watched([](double) { return 1e-10; }).empty());
  EXPECT_TRUE(watched([](double t) { return 1e-10 * (2 + std::sin(7 * t)); }).empty());
  EXPECT_TRUE(watched([](double t) { return 0.5 + 0.4 * std::sin(7 * t); }).empty());
}

TEST(RankWatch, FindsARunThatEndsInOne) {
  const auto found = watched([](double t) { return std::pow(1 - t / 10, 2) + 1e-9; });
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].time, 10, 1e-9);
}

}  // namespace
}  // namespace cdot::test::rank_watch_test
