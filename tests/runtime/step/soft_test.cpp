// Drift::soft: no number of sweeps and substeps and no jitter lets the energy rise, and its gaps are small for its
// price.
#include <functional>

#include "runtime/state/world_data.hpp"
#include "tests/runtime/spatial_support.hpp"

namespace cdot::test {
namespace {

Settings soft(int iterations, int substeps) {
  Settings s = settings(Solver::iterative, Drift::soft, -10);
  s.iterations = iterations, s.substeps = substeps;
  return s;
}

// A 1000 kg disc on the tip of light rods: tension makes their swinging stiff.
void add_heavy_chain(World<double>& world, int links) {
  const auto rods = add_chain(world, links, 0);
  const int disc = world.add_body({.x = links + 0.5, .mass = 1000, .inertia = 125});
  revolute(world, rods.back(), disc, 0.5, 0, -0.5, 0);
}

// Points on rods, some of the upper ones held.
void add_net(World<double>& world, int side, int apart) {
  for (int k = 0; k < side * side; ++k) {
    const int row = k / side, column = k % side;
    const bool held = row == 0 && (column % apart == 0 || column == side - 1);
    world.add_body({.x = 1.0 * column, .y = -1.0 * row, .mass = 1, .is_static = held});
    if (row > 0) distance(world, k - side, k, 1);
    if (column > 0) distance(world, k - 1, k, 1);
  }
}

void add_beam(World<double>& world, int welds) {
  int before = world.ground();
  for (int k = 0; k < welds; ++k) {
    const int body = world.add_body({.x = k + 0.5, .mass = 1, .inertia = 1.04 / 12});
    world.add_joint({"weld", {before, body}, {{"pa", {k ? 0.5 : 0.0, 0}}, {"pb", {-0.5, 0}}}, {}});
    before = body;
  }
}

// Limits that are hit, a motor, friction, a rope, springs.
void add_effects(World<double>& world) {
  const auto rods = add_chain(world, 6, 0.3);
  for (int joint : {0, 2, 4}) add_limit(world, joint, "angle", {.lower = -0.5, .upper = 0.4});
  add_motor(world, 1, "angle", {.speed = 3, .max_force = 20});
  add_friction(world, 3, "angle", {.max_force = 2});
  world.add_joint({"max_distance", {rods[0], rods[5]}, {{"pa", {0, 0}}, {"pb", {0, 0}}, {"l", {5}}}, {}});
  distance(world, rods[1], rods[4], 3, Softness{.by_frequency = true, .frequency = 2, .damping_ratio = 0.1});
  world.add_spring({.body_a = rods[0], .body_b = rods[3], .stiffness = 500, .rest_length = 2, .damping = 5});
}

// Of step k: between a half and two, in no order.
double jittered(int k) { return std::exp2(std::sin(12.9898 * k * k)); }

// For 4 s.
template <class S>
BalanceWatch watch(BasicWorld<S>& world, bool jitter) {
  BalanceWatch watch;
  watch.look(world.balance());
  for (int k = 0; k < 240; ++k) {
    const double factor = jitter ? jittered(k) : 1;
    EXPECT_TRUE(world.step(factor / 60));
    watch.look(world.balance());
  }
  return watch;
}

template <class S>
void expect_no_rise(const char* name, const std::function<void(BasicWorld<S>&)>& add) {
  for (int iterations : {1, 2, 10})
    for (int substeps : {1, 4, 8})
      for (bool jitter : {false, true}) {
        Settings s = soft(iterations, substeps);
        s.gravity_z = S::lengths == 3 ? -10 : 0;
        BasicWorld<S> world(s);
        add(world);
        const BalanceWatch seen = watch(world, jitter);
        // Symplectic Euler itself is off by h/2 F v.
        const double longest = (jitter ? 2.0 : 1.0) / 60 / substeps;
        EXPECT_LT(seen.risen.share(), 0.005 + longest)
            << name << ", " << iterations << " sweeps, " << substeps << " substeps, jitter " << jitter;
      }
}

TEST(Soft, EnergyNeverRises) {
  expect_no_rise<Planar<double>>("chain", [](World<double>& world) { add_chain(world, 10, 0); });
  expect_no_rise<Planar<double>>("heavy chain", [](World<double>& world) { add_heavy_chain(world, 20); });
  expect_no_rise<Planar<double>>("net", [](World<double>& world) { add_net(world, 12, 5); });
  expect_no_rise<Planar<double>>("beam", [](World<double>& world) { add_beam(world, 12); });
  expect_no_rise<Planar<double>>("effects", add_effects);
  expect_no_rise<Spatial<double>>("in space", [](SpatialWorld<double>& world) { test::add_free_mechanism(world); });
}

// Sweeps may give back to a chain the energy that they took from it, but not once it was set to another state.
TEST(Soft, LossesOfAnotherStateAreNoCredit) {
  World<double> world(soft(1, 1));
  const auto rods = add_chain(world, 10, 0);
  const auto credit = [&] { return -double(world.data().islands[0].gained); };
  for (int k = 0; k < 200 && !(k > 0 && credit() > 1); ++k) ASSERT_TRUE(world.step(1.0 / 60));
  ASSERT_GT(credit(), 1);
  world.apply_impulse(rods[0], {});
  EXPECT_EQ(credit(), 0);
}

// One sweep leaves a damper at another rate than the one that gave its impulse, which is what it took.
TEST(Soft, DampersTakeWhatTheirImpulsesTake) {
  Settings s = settings(Solver::iterative, Drift::none, 0);
  s.iterations = 1;
  World<double> world(s);
  const int body = world.add_body({.vx = 1, .vy = 0.5, .mass = 1, .inertia = 1});
  for (const auto& [x, y] : {std::pair{2., 0.}, {2., 2.}}) {
    const int end = world.add_body({.x = x, .y = y, .is_static = true});
    world.add_spring(
        {.body_a = end, .body_b = body, .stiffness = 1e-3, .rest_length = std::hypot(x, y), .damping = 1e3});
  }
  ASSERT_TRUE(world.step(0.01));
  EXPECT_GT(world.balance().taken, 0.3);
  EXPECT_NEAR(world.balance().method(), 0, 1e-6);
}

// A mechanism at rest whose start is apart closes, and lifts its load as it does.
TEST(Soft, GapsOfAStartClose) {
  for (int sweeps : {1, 4}) {
    World<double> world(soft(sweeps, 4));
    const int rod = world.add_body({.y = -0.6, .mass = 1, .inertia = 0.1});
    revolute(world, world.ground(), rod, 0, 0, 0, 0.5);
    EXPECT_NEAR(world.worst_position_error().value, 0.1, 1e-12);
    for (int k = 0; k < 60; ++k) ASSERT_TRUE(world.step(1.0 / 60));
    EXPECT_LT(world.worst_position_error().value, 1e-4) << sweeps;
  }
}

// --- gaps, beside Box2D v3 (commit 617d32ab): one sweep, four substeps of 1/60 s, its default softness ---

double largest_gap(World<double>& world, int steps) {
  double gap = 0;
  for (int k = 0; k < steps; ++k) {
    EXPECT_TRUE(world.step(1.0 / 60));
    gap = std::max(gap, world.worst_position_error().value);
  }
  return gap;
}

TEST(Soft, GapsOfAChainAreSmall) {
  World<double> world(soft(1, 4));
  add_chain(world, 10, 0);
  EXPECT_LT(largest_gap(world, 600), 0.0233);
}

TEST(Soft, GapsOfAGridAreSmall) {
  constexpr int side = 25;
  const double mass = pi * 0.16, inertia = 0.08 * mass;
  World<double> world(soft(1, 4));
  for (int k = 0; k < side * side; ++k) {
    const int row = k / side, column = k % side;
    const bool held = row == 0 && std::abs(column - side / 2) <= 3;
    world.add_body({.x = 1.0 * column, .y = -1.0 * row, .mass = mass, .inertia = inertia, .is_static = held});
    if (row > 0) revolute(world, k - side, k, 0, -0.5, 0, 0.5);
    if (column > 0) revolute(world, k - 1, k, 0.5, 0, -0.5, 0);
  }
  EXPECT_LT(largest_gap(world, 500), 0.0388);
}

TEST(Soft, GapsOfABeamAreSmall) {
  World<double> world(soft(1, 4));
  add_beam(world, 30);
  double gap = 0;
  for (int k = 0; k < 600; ++k) {
    ASSERT_TRUE(world.step(1.0 / 60));
    for (int joint = 0; joint < 30; ++joint)
      for (int row : {0, 1}) gap = std::max(gap, std::abs(world.position_error(joint)[static_cast<std::size_t>(row)]));
  }
  EXPECT_LT(gap, 0.0737);
}

TEST(Soft, GapsUnderAHeavyLoadAreSmall) {
  World<double> world(soft(1, 4));
  add_heavy_chain(world, 50);
  EXPECT_LT(largest_gap(world, 600), 1.97);
}

TEST(Soft, GapsOfANetAreSmall) {
  World<double> world(soft(1, 4));
  add_net(world, 60, 10);
  EXPECT_LT(largest_gap(world, 500), 0.111);
}

// A crank of 0.5 m at 1 rad and 10 rad/s, a rod of 1.5 m, a slider.
TEST(Soft, GapsOfASliderCrankAreSmall) {
  const double turn = 1, speed = 10, x = 0.5 * std::cos(turn), y = 0.5 * std::sin(turn);
  const double slope = std::asin(-y / 1.5), dx = 1.5 * std::cos(slope), spin = -x * speed / dx;
  World<double> world(soft(1, 4));
  const int crank = world.add_body({.x = x / 2,
                                    .y = y / 2,
                                    .angle = turn,
                                    .vx = -y / 2 * speed,
                                    .vy = x / 2 * speed,
                                    .w = speed,
                                    .mass = 1,
                                    .inertia = 0.25 / 12});
  const int rod = world.add_body({.x = x + dx / 2,
                                  .y = y / 2,
                                  .angle = slope,
                                  .vx = -y * speed + y / 2 * spin,
                                  .vy = x * speed + dx / 2 * spin,
                                  .w = spin,
                                  .mass = 1,
                                  .inertia = 2.25 / 12});
  const int slider = world.add_body({.x = x + dx, .vx = y * (spin - speed), .mass = 2, .inertia = 0.04 / 12});
  revolute(world, world.ground(), crank, 0, 0, -0.25, 0);
  revolute(world, crank, rod, 0.25, 0, -0.75, 0);
  revolute(world, rod, slider, 0.75, 0, 0, 0);
  world.add_joint({"prismatic", {slider, world.ground()}, {{"pa", {0, 0}}, {"pb", {x + dx, 0}}, {"t", {0, 1}}}, {}});
  EXPECT_LT(world.worst_velocity_error().value, 1e-12);
  EXPECT_LT(largest_gap(world, 600), 0.00686);
}

}  // namespace
}  // namespace cdot::test
