// Tension between bodies counts wherever a World starts.
#include <cdot/integrators.hpp>
#include <cdot/methods.hpp>

#include "runtime/own/own.hpp"
#include "tests/runtime/support.hpp"

namespace cdot::test {
namespace {

// Two stones circle each other on a cord. A World that starts with a slack cord, far from its length, goes on from a
// state as the one that starts there.
TEST(OwnTension, OfACordThatIsSlackAtTheStartCounts) {
  constexpr double l = 10, k = 1e6, stretched = 1, R = (l + stretched) / 2, m = 2;
  const OwnType own = add_own_type(CDOT_SOURCE_DIR "/tests/runtime/own/specs/elastic_cord.effect");
  ASSERT_EQ(own.problems, "");
  const double v = std::sqrt(k * stretched * R / m);
  for (const IntegratorRow& row : integrator_rows) {
    // They choose parts of steps by the mechanism's size at its start.
    if (row.integrator == Integrator::rk4 || row.integrator == Integrator::radau5) continue;
    const auto circles = [&](double start) {
      World<double> world({.integrator = row.integrator});
      int stones[2];
      for (int& stone : stones) {
        const double side = &stone == stones ? -1 : 1;
        stone = world.add_body({.x = side * start, .mass = m, .inertia = 0.1});
      }
      world.add_joint(
          {own.name, {stones[0], stones[1]}, {{"pa", {0.01, 0}}, {"pb", {-0.01, 0}}, {"l", {l}}, {"k", {k}}}, {}});
      world.prepare();
      for (int& stone : stones) {
        const double side = &stone == stones ? -1 : 1;
        world.set_pose(stone, {side * (R + 0.01), 0, 0});
        world.set_velocity(stone, {0, side * v, v / R});
      }
      for (int step = 0; step < 40; ++step) EXPECT_TRUE(world.step(0.3 * R / v));
      return world.pose(stones[1]);
    };
    const auto near = circles(0.2), there = circles(R + 0.01);
    EXPECT_EQ(near.x, there.x) << row.name;
    EXPECT_EQ(near.y, there.y) << row.name;
  }
}

}  // namespace
}  // namespace cdot::test
