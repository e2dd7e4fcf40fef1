// Joints whose own numbers follow functions of time: errors, rates and coordinates are those of the present numbers.
#include <cmath>

#include "tests/runtime/effects/generated_effects.hpp"
#include "tests/runtime/spatial_support.hpp"

namespace cdot::test {
namespace {

using effects::ball;
using effects::with;

// b sin(w t)
Profile swing(double b, double w) {
  return Profile::function([=](double t) -> ProfileValue {
    return {b * std::sin(w * t), b * w * std::cos(w * t), -b * w * w * std::sin(w * t)};
  });
}

constexpr double b = 0.3, w = 7, h = 0.01, t = 50 * h;

TEST(QueriesInTime, ASwingingPivotIsMet) {
  World<double> world(with(Integrator::rk4, -9.81));
  const int body = ball(world, 1, 0, 0, b * w);
  world.add_joint({"distance", {body, world.ground()}, {{"pa", {0, 0}}, in_time("pb", {0.0, swing(b, w)})}, {}});
  EXPECT_TRUE(world.inconsistencies(1e-9).empty()) << "the ball starts with the pivot's velocity";
  for (int k = 0; k < 50; ++k) ASSERT_TRUE(world.step(h));
  ASSERT_GT(std::abs(b * std::sin(w * t)), 0.1) << "the pivot is far from its start";
  EXPECT_LT(std::abs(world.position_error(0)[0]), 1e-9);
  EXPECT_LT(std::abs(world.velocity_error(0)[0]), 1e-9);
  EXPECT_LT(world.worst_position_error().value, 1e-9);
  EXPECT_LT(world.worst_velocity_error().value, 1e-9);
}

TEST(QueriesInTime, AStartBesideTheMovingPivotIsFound) {
  World<double> world(with(Integrator::rk4));
  const int body = ball(world, 0, 1, 0, 0);
  world.add_joint({"distance", {body, world.ground()}, {{"pa", {0, 0}}, in_time("pb", {0.0, swing(b, w)})}, {}});
  const auto found = world.inconsistencies(1e-9);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_TRUE(found[0].velocity);
  EXPECT_NEAR(std::abs(found[0].value), b * w, 1e-12) << "the rod stands on its pivot, which rises";
}

// A ball rests on a line while the point that its way is counted from swings along it.
TEST(QueriesInTime, CoordinatesFollow) {
  World<double> world(with(Integrator::rk4));
  const int body = ball(world, 2, 0, 0, 0);
  const int rail = world.add_joint(
      {"line", {world.ground(), body}, {in_time("pa", {swing(b, w), 0.0}), {"pb", {0, 0}}, {"t", {0, 1}}}, {}});
  const double start = world.coordinate(rail, "slide");
  const double start_rate = world.coordinate_rate(rail, "slide");
  EXPECT_NEAR(std::abs(start), 2, 1e-12);
  EXPECT_NEAR(std::abs(start_rate), b * w, 1e-12);
  for (int k = 0; k < 50; ++k) ASSERT_TRUE(world.step(h));
  const double sign = start_rate > 0 ? 1 : -1;
  EXPECT_NEAR(world.coordinate(rail, "slide"), start + sign * b * std::sin(w * t), 1e-9);
  EXPECT_NEAR(world.coordinate_rate(rail, "slide"), sign * b * w * std::cos(w * t), 1e-9);
}

}  // namespace
}  // namespace cdot::test
