// Every solver conserves momentum and angular momentum, and energy to first order.
#include "tests/runtime/support.hpp"

namespace cdot::test {
namespace {

struct Momentum {
  double x = 0, y = 0, angular = 0;  // about the origin
};

template <class T>
Momentum momentum(const World<T>& world) {
  Momentum sum;
  for (int i = 0; i < world.body_count(); ++i) {
    const auto m = world.inverse_mass(i);
    if (m.m == 0) continue;
    const auto q = world.pose(i);
    const auto v = world.velocity(i);
    const double mass = 1.0 / double(m.m);
    sum.x += mass * v.x;
    sum.y += mass * v.y;
    sum.angular += mass * (q.x * v.y - q.y * v.x) + (m.I > 0 ? v.w / m.I : 0);
  }
  return sum;
}

// A chain of five links in free space, pushed: revolutes, a distance, a motor, a soft joint, a
// spring between points.
template <class T>
void add_free_mechanism(World<T>& world) {
  std::vector<int> rods;
  for (int i = 0; i < 5; ++i) rods.push_back(world.add_body(rod(i, 0, 0, 1 + 0.5 * i)));
  for (int i = 1; i < 4; ++i) revolute(world, rods[i - 1], rods[i], 0.5, 0, -0.5, 0);
  add_motor(world, 1, "angle", {.speed = 2, .max_force = 0.5});
  add_limit(world, 0, "angle", {.lower = -0.3, .upper = 0.4});
  distance(world, rods[0], rods[2], 2, Softness{.by_frequency = true, .frequency = 3, .damping_ratio = 0.2});
  revolute(world, rods[3], rods[4], 0.5, 0, -0.5, 0);
  world.add_spring({.body_a = rods[0], .body_b = rods[4], .ay = 0.2, .stiffness = 5, .rest_length = 3, .damping = 0.3});
  world.apply_impulse(rods[0], {1, 2, 0.5});
  world.apply_impulse(rods[4], {-3, 1, -0.2});
}

TEST(Conservation, MomentumOfAFreeMechanism) {
  for (Solver solver : {Solver::direct, Solver::iterative}) {
    for (Drift drift : {Drift::none, Drift::baumgarte, Drift::projection}) {
      World<double> world(settings(solver, drift));
      add_free_mechanism(world);
      const Momentum before = momentum(world);
      run(world, 3, 1.0 / 240);
      const Momentum after = momentum(world);
      EXPECT_NEAR(after.x, before.x, 1e-11);
      EXPECT_NEAR(after.y, before.y, 1e-11);
    }
  }
}

// Impulses act along one line if the two points of a joint coincide. The direct solver with projection closes the gaps
// to round-off. The iterative solver leaves gaps, which cause a torque.
TEST(Conservation, AngularMomentumOfAFreeMechanism) {
  for (Solver solver : {Solver::direct, Solver::iterative}) {
    World<double> world(settings(solver, Drift::projection));
    add_free_mechanism(world);
    const double before = momentum(world).angular;
    run(world, 3, 1.0 / 240);
    EXPECT_NEAR(momentum(world).angular, before, solver == Solver::direct ? 1e-11 : 1e-4);
  }
}

// Energy of an undamped double pendulum: oscillates at first order in h, without drift over many periods.
TEST(Conservation, EnergyOfTheDoublePendulumHasNoDrift) {
  double before = 0;
  for (double h : {2e-3, 1e-3, 5e-4}) {
    World<double> world(settings(Solver::direct, Drift::projection, -9.81));
    add_chain(world, 2, -1.0);
    const EnergyOff off = energy_off(world, 20, h);
    EXPECT_LT(off.late, 1.5 * off.early) << "h = " << h;
    if (before > 0) {
      EXPECT_NEAR(before / off.early, 2, 0.4) << "h = " << h;
    }
    before = off.early;
  }
}

TEST(Conservation, WithoutForcesNothingMoves) {
  for (Solver solver : {Solver::direct, Solver::iterative}) {
    World<double> world(settings(solver));
    add_chain(world, 5, 0.3);
    const auto before = world.hash();
    run(world, 1, 1e-2);
    EXPECT_LT(world.energy(), 1e-25);
    World<double> again(settings(solver));
    add_chain(again, 5, 0.3);
    EXPECT_EQ(again.hash(), before);
    EXPECT_LT(apart(world, again), 1e-12);
  }
}

}  // namespace
}  // namespace cdot::test
