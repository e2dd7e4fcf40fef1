// Islands at rest fall asleep, and every change of an island wakes it. (cost_test.cpp tests that sleep costs nothing.)
#include "tests/runtime/support.hpp"

namespace cdot::test {
namespace {

Settings sleepy(Solver solver) {
  Settings s = settings(solver, Drift::projection, -9.81);
  s.sleep_after = 0.5;
  return s;
}

// A pendulum that hangs at rest, and one that swings.
struct TwoPendulums {
  explicit TwoPendulums(Solver solver) : world(sleepy(solver)) {
    resting = add_chain(world, 2, -pi / 2).back();
    swinging = add_chain(world, 2, -0.3).back();
  }
  World<double> world;
  int resting, swinging;
};

TEST(Sleep, OnlyIslandsAtRestFallAsleep) {
  for (Solver solver : {Solver::direct, Solver::iterative}) {
    TwoPendulums two(solver);
    run(two.world, 0.4, 0.01);
    EXPECT_EQ(two.world.sleeping_islands(), 0);
    run(two.world, 1, 0.01);
    EXPECT_TRUE(two.world.asleep(two.resting));
    EXPECT_FALSE(two.world.asleep(two.swinging));
    EXPECT_EQ(two.world.sleeping_islands(), 1);
    const auto before = two.world.pose(two.resting);
    run(two.world, 1, 0.01);
    EXPECT_EQ(two.world.pose(two.resting).x, before.x);
    EXPECT_EQ(two.world.pose(two.resting).y, before.y);
  }
}

TEST(Sleep, NeverUnlessAskedFor) {
  World<double> world(settings(Solver::direct, Drift::projection, -9.81));
  add_chain(world, 2, -pi / 2);
  run(world, 5, 0.01);
  EXPECT_EQ(world.sleeping_islands(), 0);
}

TEST(Sleep, EveryTouchWakes) {
  for (int touch = 0; touch < 6; ++touch) {
    TwoPendulums two(Solver::direct);
    run(two.world, 1, 0.01);
    ASSERT_TRUE(two.world.asleep(two.resting));
    const auto q = two.world.pose(two.resting);
    if (touch == 0) two.world.apply_impulse(two.resting, {1, 0, 0});
    if (touch == 1) two.world.set_velocity(two.resting, {1, 0, 0});
    if (touch == 2) two.world.set_force(two.resting, {3, 0, 0});
    if (touch == 3) two.world.set_pose(two.resting, {q.x + 0.1, q.y, q.angle});
    if (touch == 4) two.world.set_pose(two.world.ground(), {0.1, 0, 0});
    if (touch == 5)  // a spring to a moving body
      two.world.add_spring({.body_a = two.resting, .body_b = two.swinging, .stiffness = 20});
    two.world.step(0.01);
    EXPECT_FALSE(two.world.asleep(two.resting)) << touch;
    run(two.world, 0.2, 0.01);
    EXPECT_GT(std::abs(two.world.velocity(two.resting).x), 1e-2) << touch;
  }
}

TEST(Sleep, ATouchOfOneIslandLeavesTheOthersAsleep) {
  World<double> world(sleepy(Solver::direct));
  std::vector<int> ends;
  for (int i = 0; i < 5; ++i) ends.push_back(add_chain(world, 2, -pi / 2).back());
  run(world, 1, 0.01);
  EXPECT_EQ(world.sleeping_islands(), 5);
  world.apply_impulse(ends[2], {1, 0, 0});
  EXPECT_EQ(world.sleeping_islands(), 4);
  world.step(0.01);
  EXPECT_FALSE(world.asleep(ends[2]));
  EXPECT_TRUE(world.asleep(ends[1]));
}

TEST(Sleep, WakingGoesOnAsIfItHadNotSlept) {
  TwoPendulums slept(Solver::direct);
  World<double> awake(settings(Solver::direct, Drift::projection, -9.81));
  const int resting = add_chain(awake, 2, -pi / 2).back();
  run(slept.world, 2, 0.01);
  run(awake, 2, 0.01);
  slept.world.apply_impulse(slept.resting, {1, 0, 0});
  awake.apply_impulse(resting, {1, 0, 0});
  run(slept.world, 1, 0.01);
  run(awake, 1, 0.01);
  EXPECT_NEAR(slept.world.pose(slept.resting).x, awake.pose(resting).x, 1e-9);
}

}  // namespace
}  // namespace cdot::test
