// The iterative solver sweeps along chains from the tips to the roots, for every order of add_joint().
#include "runtime/world/sweep_order.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <random>

#include <cdot/world.hpp>

namespace cdot::test {
namespace {

struct Link {
  std::vector<int> bodies;
  double x_a, x_b;
};

constexpr int links = 20;

// A horizontal chain with initial velocities, pinned at one end or at both; its joints in a given order.
World<double> chain(bool bridge, unsigned shuffled) {
  World<double> world({.solver = Solver::iterative, .iterations = 10, .gravity_y = -9.81});
  std::vector<Link> all;
  int before = world.ground();
  for (int k = 0; k < links; ++k) {
    const int rod = world.add_body({.x = k + 0.5, .mass = 1, .inertia = 1.0 / 12});
    all.push_back({{before, rod}, k ? 0.5 : 0.0, -0.5});
    before = rod;
  }
  if (bridge) all.push_back({{before, world.ground()}, 0.5, links});
  if (shuffled) std::shuffle(all.begin(), all.end(), std::mt19937(shuffled));
  for (const Link& link : all)
    world.add_joint({"revolute", link.bodies, {{"pa", {link.x_a, 0}}, {"pb", {link.x_b, 0}}}, {}});
  return world;
}

// A chain gives the same bits; a bridge, which may be swept from either end, an equally small gap.
TEST(SweepOrder, DoesNotDependOnTheOrderOfAdding) {
  for (const bool bridge : {false, true}) {
    World<double> first = chain(bridge, 0);
    for (int k = 0; k < 120; ++k) first.step(1.0 / 120);
    const double gap = first.worst_position_error().value;
    for (unsigned seed = 1; seed <= 5; ++seed) {
      World<double> other = chain(bridge, seed);
      for (int k = 0; k < 120; ++k) other.step(1.0 / 120);
      if (!bridge) {
        EXPECT_EQ(other.hash(), first.hash()) << "seed " << seed;
      }
      EXPECT_NEAR(other.worst_position_error().value, gap, 0.01 * gap) << "seed " << seed;
    }
  }
}

TEST(SweepOrder, GoesFromTheTipToTheRoot) {
  World<double> world = chain(false, 3);
  const std::vector<int> places = sweep_places(world.data());
  for (int joint = 0; joint < links; ++joint) {
    const std::vector<int> bodies = world.joint_bodies(joint);
    for (int next = 0; next < links; ++next) {
      if (world.joint_bodies(next)[0] != bodies[1]) continue;
      EXPECT_EQ(places[joint], places[next] + 1);
    }
    if (world.is_static(bodies[0])) {
      EXPECT_EQ(places[joint], links - 1);
    }
  }
}

// A tree: each branch without interruption, and the trunk after all branches.
TEST(SweepOrder, TakesEachBranchInOneGo) {
  World<double> world({.solver = Solver::iterative});
  const auto joint = [&](int a, int b) {
    return world.add_joint({"revolute", {a, b}, {{"pa", {0, 0}}, {"pb", {0, 0}}}, {}});
  };
  int body[5];
  for (int& b : body) b = world.add_body({.mass = 1, .inertia = 1});
  const int left = joint(body[0], body[1]), right = joint(body[0], body[2]);
  const int left_tip = joint(body[1], body[3]), right_tip = joint(body[2], body[4]);
  const int trunk = joint(world.ground(), body[0]);
  const std::vector<int> places = sweep_places(world.data());
  EXPECT_EQ(places[trunk], 4);
  EXPECT_EQ(places[left], places[left_tip] + 1);
  EXPECT_EQ(places[right], places[right_tip] + 1);
}

}  // namespace
}  // namespace cdot::test
