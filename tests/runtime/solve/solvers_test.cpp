// The direct solver is exact, the iterative one converges to it, and both reproduce their bits.
#include "tests/runtime/support.hpp"

namespace cdot::test {
namespace {

TEST(Solvers, DirectSatisfiesEveryRowToRoundOff) {
  World<double> world(settings(Solver::direct, Drift::projection, -9.81));
  add_chain(world, 50, -0.4);
  for (int i = 0; i < 200; ++i) {
    world.step(1e-3);
    ASSERT_LT(world.worst_position_error().value, 1e-11);
    ASSERT_LT(world.worst_velocity_error().value, 1e-10);
  }
}

// However large the mechanism is, only round-off of its poses stays in C.
TEST(Solvers, DirectClosesTheJointsOfALargeMechanism) {
  constexpr double arm = 1e5, spin = 0.1;
  World<double> world(settings(Solver::direct));
  const int body = world.add_body({.x = arm, .vy = spin * arm, .w = spin, .mass = 1, .inertia = 1});
  revolute(world, world.ground(), body, 0, 0, -arm, 0);
  for (int k = 0; k < 100; ++k) {
    ASSERT_TRUE(world.step(0.01));
    EXPECT_LT(world.worst_position_error().value, 1e-10);
  }
}

TEST(Solvers, IterativeTendsToDirect) {
  for (Drift drift : {Drift::none, Drift::baumgarte, Drift::projection}) {
    World<double> exact(settings(Solver::direct, drift, -9.81));
    add_chain(exact, 6, -0.4);
    run(exact, 0.5, 1e-3);
    double before = 1e9;
    for (int iterations : {30, 300, 3000}) {
      Settings s = settings(Solver::iterative, drift, -9.81);
      s.iterations = iterations;
      World<double> world(s);
      add_chain(world, 6, -0.4);
      run(world, 0.5, 1e-3);
      const double error = apart(exact, world);
      EXPECT_LT(error, 0.5 * before + 1e-9) << iterations;
      before = error;
    }
    EXPECT_LT(before, 1e-6);
  }
}

TEST(Solvers, WarmStartingReducesTheErrorOfTheSameSweeps) {
  double gap[2];
  for (bool warm : {false, true}) {
    Settings s = settings(Solver::iterative, Drift::baumgarte, -9.81);
    s.warm_start = warm;
    s.iterations = 8;
    World<double> world(s);
    add_chain(world, 20, -1.5);
    run(world, 2, 1e-2);
    gap[warm] = world.worst_position_error().value;
  }
  EXPECT_LT(gap[true], gap[false] / 3);
}

TEST(Solvers, SubstepsAreSteps) {
  Settings s = settings(Solver::direct, Drift::projection, -9.81);
  World<double> fine(s);
  s.substeps = 8;
  World<double> coarse(s);
  add_chain(fine, 3, -0.4);
  add_chain(coarse, 3, -0.4);
  run(fine, 1, 1.0 / 512);
  run(coarse, 1, 1.0 / 64);
  EXPECT_EQ(fine.hash(), coarse.hash());
}

TEST(Solvers, SameBitsEveryTime) {
  for (Solver solver : {Solver::direct, Solver::iterative}) {
    std::uint64_t first = 0;
    for (int attempt = 0; attempt < 3; ++attempt) {
      World<double> world(settings(solver, Drift::projection, -9.81));
      const auto rods = add_chain(world, 7, -0.4);
      add_limit(world, 2, "angle", {.lower = -0.1, .upper = 0.1});
      world.add_spring({.body_a = rods[0], .body_b = rods[6], .stiffness = 3, .rest_length = 1});
      run(world, 1, 1e-3);
      if (attempt == 0) first = world.hash();
      EXPECT_EQ(world.hash(), first);
    }
  }
}

// Two worlds in one: islands do not influence each other's bits.
TEST(Solvers, IslandsAreIndependent) {
  for (Solver solver : {Solver::direct, Solver::iterative}) {
    World<double> alone(settings(solver, Drift::projection, -9.81));
    const auto rods = add_chain(alone, 4, -0.4);
    World<double> both(settings(solver, Drift::projection, -9.81));
    add_chain(both, 4, -0.4);
    add_chain(both, 9, 0.7);
    run(alone, 1, 1e-3);
    run(both, 1, 1e-3);
    EXPECT_EQ(both.island_count(), 2);
    for (int i : rods) {
      EXPECT_EQ(alone.pose(i).x, both.pose(i).x);
      EXPECT_EQ(alone.pose(i).angle, both.pose(i).angle);
    }
  }
}

TEST(Solvers, ReactionsOfAHangingChain) {
  for (Drift drift : {Drift::none, Drift::baumgarte, Drift::projection}) {
    World<double> world(settings(Solver::direct, drift, -10));
    const auto rods = add_chain(world, 5, -pi / 2, 2);
    run(world, 0.1, 1e-2);
    for (int i = 0; i < 5; ++i) {
      EXPECT_NEAR(world.reaction(i, rods[i]).force_y, 20 * (5 - i), 1e-9);
      EXPECT_NEAR(world.reaction(i, rods[i]).force_x, 0, 1e-9);
    }
    EXPECT_NEAR(world.reaction(0, world.ground()).force_y, -100, 1e-9);
  }
}

}  // namespace
}  // namespace cdot::test
