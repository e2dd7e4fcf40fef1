// Known cases that break engines, each with a bound. 1/60 s and doubles unless stated; each must also stay finite in
// floats.
#include <fmt/core.h>

#include "tests/runtime/support.hpp"

namespace cdot::test::worlds_test {
namespace {

constexpr double g = 9.81, h = 1.0 / 60;

Settings heavy() {
  Settings s = settings(Solver::direct, Drift::projection, -g);
  s.integrator = Integrator::implicit;
  return s;
}

// Largest gap and rise of energy of a run.
struct Extremes {
  double gap = 0, rise = 0, fall = 0;
};
template <class T>
Extremes watch(World<T>& world, double duration, double step = h) {
  Extremes e;
  const double start = world.energy();
  const long steps = std::lround(duration / step);
  for (long i = 0; i < steps; ++i) {
    world.step(step);
    e.gap = std::max(e.gap, world.worst_position_error().value);
    e.rise = std::max(e.rise, world.energy() - start);
    e.fall = std::max(e.fall, start - world.energy());
  }
  return e;
}

// 40 rods of 5.982 kg and a disc of 4021.24 kg at their end, dropped from the horizontal.
template <class T>
int add_ball_and_chain(World<T>& world) {
  int before = world.ground();
  for (int i = 0; i < 40; ++i) {
    BodyDefinition d = rod(i, 0, 0, 5.982);
    d.linear_damping = d.angular_damping = 0.1;
    const int link = world.add_body(d);
    revolute(world, before, link, i ? 0.5 : 0.0, 0, -0.5, 0);
    before = link;
  }
  const double radius = 8, mass = 4021.24;
  const int disc = world.add_body({.x = 40 + radius,
                                   .mass = mass,
                                   .inertia = mass * radius * radius / 2,
                                   .linear_damping = 0.1,
                                   .angular_damping = 0.1});
  revolute(world, before, disc, 0.5, 0, -radius, 0);
  return disc;
}

TEST(HardCasesInWorlds, BallAndChain) {
  World<double> world(heavy());
  add_ball_and_chain(world);
  EXPECT_LT(watch(world, 10).gap, 5e-3);
  run(world, 400, h);
  EXPECT_NEAR(-world.reaction(0, world.ground()).force_y, 41795.6, 41.8);
  World<float> coarse(heavy());
  add_ball_and_chain(coarse);
  run(coarse, 10, h);
  EXPECT_TRUE(finite(coarse));
}

template <class T>
int add_chain_with_load(World<T>& world, double load) {
  const auto rods = add_chain(world, 10, -pi / 2);
  const int body = world.add_body({.y = -10, .mass = load});
  revolute(world, rods.back(), body, 0.5, 0, 0, 0);
  return body;
}

TEST(HardCasesInWorlds, HeavyLoadOnALightChain) {
  for (double load : {1e3, 1e6}) {
    World<double> world(heavy());
    const int body = add_chain_with_load(world, load);
    run(world, 0.2, h);
    EXPECT_NEAR(-world.reaction(0, world.ground()).force_y, (10 + load) * g, 1e-6 * load);
    world.apply_impulse(body, {load, 0, 0});
    const Extremes e = watch(world, 10);
    EXPECT_LT(e.gap, 1e-3) << load;
    EXPECT_LT(e.rise, 1e-3 * 0.5 * load) << load;
    World<float> coarse(heavy());
    coarse.apply_impulse(add_chain_with_load(coarse, load), {load, 0, 0});
    run(coarse, 10, h);
    EXPECT_TRUE(finite(coarse));
  }
}

template <class T>
void add_feather_between_anvils(World<T>& world) {
  int before = world.ground();
  for (int i = 0; i < 3; ++i) {
    const int body = world.add_body(rod(i, 0, 0, i == 1 ? 1e-3 : 1e3));
    revolute(world, before, body, i ? 0.5 : 0.0, 0, -0.5, 0);
    before = body;
  }
}

TEST(HardCasesInWorlds, FeatherBetweenAnvils) {
  Settings s = settings(Solver::direct, Drift::projection, -g);
  s.substeps = 16;
  World<double> world(s);
  add_feather_between_anvils(world);
  const Extremes e = watch(world, 5);
  EXPECT_LT(e.gap, 1e-3);
  const double scale = 2000 * g * 3;  // energy of the fall over the chain's length
  EXPECT_LT(std::max(e.rise, e.fall), 5e-3 * scale);
  World<float> coarse(s);
  add_feather_between_anvils(coarse);
  run(coarse, 5, h);
  EXPECT_TRUE(finite(coarse));
}

// 160 planks of 1 m over 158 m, dropped as a V: sag and tension at rest are known.
TEST(HardCasesInWorlds, BridgeWithSlack) {
  World<double> world(heavy());
  const double half = 79, depth = std::sqrt(80.0 * 80 - half * half), slope = std::atan2(depth, half);
  int before = world.ground();
  for (int i = 0; i < 160; ++i) {
    const double s = i < 80 ? i + 0.5 : 159.5 - i;
    const double x = s * std::cos(slope);
    const int plank = world.add_body({.x = i < 80 ? x : 2 * half - x,
                                      .y = -s * std::sin(slope),
                                      .angle = i < 80 ? -slope : slope,
                                      .mass = 5,
                                      .inertia = 5 * (1 + 0.0625) / 12,
                                      .linear_damping = 0.1,
                                      .angular_damping = 0.1});
    revolute(world, before, plank, i ? 0.5 : 0.0, 0, -0.5, 0);
    before = plank;
  }
  revolute(world, before, world.ground(), 0.5, 0, 2 * half, 0);
  EXPECT_LT(watch(world, 120).gap, 1e-3);
  double lowest = 0;
  for (int i = 1; i < world.body_count(); ++i)
    lowest = std::min(lowest, world.pose(i).y - 0.5 * std::abs(std::sin(world.pose(i).angle)));
  EXPECT_NEAR(-lowest, 10.93409, 1e-2);
  EXPECT_NEAR(std::abs(world.reaction(0, world.ground()).force_x), 14086.96, 14.1);
}

TEST(HardCasesInWorlds, StretchedChain) {
  World<double> world(settings(Solver::direct, Drift::projection, -g));
  const double mass = pi * 0.04;
  int before = world.ground();
  for (int i = 0; i < 40; ++i) {
    const int disc = world.add_body({.x = 2.0 * (i + 1), .mass = mass, .inertia = mass * 0.02});
    revolute(world, before, disc, i ? 0.5 : 0.0, 0, i ? -0.5 : -1.0, 0);
    before = disc;
  }
  const Extremes e = watch(world, 1);
  EXPECT_LT(world.worst_position_error().value, 5e-3);
  EXPECT_LE(e.rise, 0);
  for (int i = 0; i < world.body_count(); ++i) EXPECT_LT(std::hypot(world.velocity(i).x, world.velocity(i).y), 40);
}

TEST(HardCasesInWorlds, TheSameJointTenTimes) {
  for (Solver solver : {Solver::direct, Solver::iterative}) {
    for (Drift drift : {Drift::none, Drift::baumgarte, Drift::projection}) {
      World<double> one(settings(solver, drift, -g)), ten(settings(solver, drift, -g));
      const int a = one.ground(), b = one.add_body(rod(0, 0, 0));
      ten.ground(), ten.add_body(rod(0, 0, 0));
      revolute(one, a, b, 0, 0, -0.5, 0);
      for (int i = 0; i < 10; ++i) revolute(ten, a, b, 0, 0, -0.5, 0);
      run(one, 10, h);
      run(ten, 10, h);
      EXPECT_LT(apart(one, ten), 1e-9);
      if (solver == Solver::direct) {
        EXPECT_EQ(one.redundant_rows(), 0);
        EXPECT_EQ(ten.redundant_rows(), 18);
      }
    }
  }
}

// Two rods of 1 m and one of 2.02 m cannot close a triangle.
TEST(HardCasesInWorlds, IncompatibleTriangle) {
  for (Solver solver : {Solver::direct, Solver::iterative}) {
    for (Drift drift : {Drift::none, Drift::baumgarte, Drift::projection}) {
      World<double> world(settings(solver, drift));
      const int a = world.add_body(rod(0, 0, 0)), b = world.add_body(rod(1, 0, 0));
      const int c = world.add_body({.x = 1, .mass = 2.02, .inertia = 2.02 * 2.02 * 2.02 / 12});
      revolute(world, a, b, 0.5, 0, -0.5, 0);
      revolute(world, b, c, 0.5, 0, 1.01, 0);
      revolute(world, c, a, -1.01, 0, -0.5, 0);
      run(world, 1, h);
      const double gap = world.worst_position_error().value, energy = world.energy();
      EXPECT_LE(energy, 1e-6);
      run(world, 1, h);
      EXPECT_LE(world.energy(), energy + 1e-12);
      EXPECT_NEAR(world.worst_position_error().value, gap, 1e-6);
    }
  }
}

TEST(HardCasesInWorlds, ZeroLengthDistanceIsRefusedAndAZeroStartIsNot) {
  World<double> world(settings(Solver::direct, Drift::projection, -g));
  const int a = world.add_body({.mass = 1, .inertia = 0.1});
  const int b = world.add_body({.mass = 1, .inertia = 0.1});
  EXPECT_THROW(distance(world, a, b, 0), Error);
  revolute(world, world.ground(), a, 0.5, 0, 0.5, 0);
  const int joint = distance(world, a, b, 0.5);
  world.step(h);
  for (int i = 0; i < 300; ++i) {
    world.step(h);
    ASSERT_NEAR(world.position_error(joint)[0], 0, 1e-4);
  }
  EXPECT_TRUE(finite(world));
}

// One side of a pulley is pulled up to its wheel and past it.
template <class T>
void pulley_to_zero(Solver solver, double step, double* gap, double* rise) {
  World<T> world(settings(solver, Drift::projection, -g));
  const int a = world.add_body({.x = -1, .y = 5, .mass = 2, .inertia = 0.4});
  const int b = world.add_body({.x = 1, .y = 9.8, .mass = 1, .inertia = 0.2});
  world.add_joint({"pulley", {a, b}, {{"pa", {0, 0}}, {"pb", {0, 0}}, {"ga", {-1, 10}}, {"gb", {1, 10}}}, {}});
  const Extremes e = watch(world, 3, step);
  EXPECT_TRUE(finite(world));
  *gap = e.gap;
  *rise = e.rise;
}

TEST(HardCasesInWorlds, PulleyWhoseRopeShrinksToNothing) {
  for (double step : {h, 1.0 / 240, 1.0 / 1000}) {
    double gap, rise;
    pulley_to_zero<double>(Solver::direct, step, &gap, &rise);
    EXPECT_LT(gap, 1e-4);
    EXPECT_LT(rise, 1e-3 * 2 * g * 5);
    pulley_to_zero<float>(Solver::direct, step, &gap, &rise);
    pulley_to_zero<double>(Solver::iterative, step, &gap, &rise);
    EXPECT_LT(gap, 1e-4);
    EXPECT_LT(rise, 1e-3 * 2 * g * 5);
  }
}

// Slider-crank from its dead centre at 150 rad/s: 0.2 s at 32 800 steps per second. No gap, no gain
// of energy.
TEST(HardCasesInWorlds, SliderCrankThroughItsDeadCentres) {
  World<double> world(settings(Solver::direct, Drift::projection, -g));
  const int ground = world.ground();
  const int crank = world.add_body({.x = 0.0765, .vy = 11.475, .w = 150, .mass = 0.038, .inertia = 7.4e-5});
  const int rod = world.add_body({.x = 0.306, .vy = 11.475, .w = -75, .mass = 0.038, .inertia = 5.9e-4});
  const int slider = world.add_body({.x = 0.459, .mass = 0.076, .inertia = 2.7e-6});
  revolute(world, ground, crank, 0, 0, -0.0765, 0);
  revolute(world, crank, rod, 0.0765, 0, -0.153, 0);
  revolute(world, rod, slider, 0.153, 0, 0, 0);
  world.add_joint({"prismatic", {slider, ground}, {{"pa", {0, 0}}, {"pb", {0, 0}}, {"t", {0, 1}}}, {}});
  const Extremes e = watch(world, 0.2, 0.005 / 164);
  EXPECT_LT(e.gap, 1e-5);
  EXPECT_LT(std::max(e.rise, e.fall), 1e-3);  // of 7.5 J
}

// A parallelogram four-bar passes the flat pose, at which J loses a rank.
TEST(HardCasesInWorlds, FourBarThroughTheFlatPose) {
  World<double> world(settings(Solver::direct, Drift::projection));
  const int a = world.add_body({.y = 0.5, .angle = pi / 2, .vx = -0.5, .w = 1, .mass = 1, .inertia = 1.0 / 12});
  const int b = world.add_body({.x = 0.5, .y = 1, .vx = -1, .mass = 1, .inertia = 1.0 / 12});
  const int c = world.add_body({.x = 1, .y = 0.5, .angle = pi / 2, .vx = -0.5, .w = 1, .mass = 1, .inertia = 1.0 / 12});
  revolute(world, world.ground(), a, 0, 0, -0.5, 0);
  revolute(world, a, b, 0.5, 0, -0.5, 0);
  revolute(world, b, c, 0.5, 0, 0.5, 0);
  revolute(world, c, world.ground(), -0.5, 0, 1, 0);
  const Extremes e = watch(world, 20, 1.0 / 240);
  EXPECT_LT(e.gap, 1e-4);
  EXPECT_LT(std::max(e.rise, e.fall), 5e-3);
  EXPECT_TRUE(finite(world));
  EXPECT_NEAR(world.pose(a).angle, world.pose(c).angle, 1e-3) << "still the parallel branch";
  EXPECT_NEAR(world.pose(b).angle, 0, 1e-3);
}

// The same mechanism at the origin and far from it: |C| stays at the resolution of the numbers there.
TEST(HardCasesInWorlds, FarFromTheOrigin) {
  for (double place : {1e3, 1e6, 1e9}) {
    World<double> here(settings(Solver::direct, Drift::projection, -g));
    World<double> there(settings(Solver::direct, Drift::projection, -g));
    for (World<double>* world : {&here, &there}) {
      const double at = world == &there ? place : 0;
      int before = world->add_body({.x = at, .y = at, .is_static = true});
      for (int i = 0; i < 5; ++i) {
        BodyDefinition d = rod(i, 0, 0);
        d.x += at;
        d.y += at;
        const int link = world->add_body(d);
        revolute(*world, before, link, i ? 0.5 : 0.0, 0, -0.5, 0);
        before = link;
      }
    }
    const double resolution = place * 2.3e-16;
    EXPECT_LT(watch(there, 2).gap, 1e-12 + 4 * resolution);
    run(here, 2, h);
    for (int i = 0; i < here.body_count(); ++i)
      EXPECT_NEAR(there.pose(i).y - place, here.pose(i).y, 1e-9 + 1e5 * resolution);
    EXPECT_NEAR(there.energy(), here.energy(), 1e-6 + 1e6 * resolution);
  }
}

// A pendulum with steps of 0.1 s and 0.25 s, each a rotation of more than half a radian.
TEST(HardCasesInWorlds, VeryLargeStep) {
  for (double step : {0.1, 0.25}) {
    World<double> world(settings(Solver::direct, Drift::projection, -g));
    add_chain(world, 1, 0);
    const Extremes e = watch(world, 100, step);
    EXPECT_LT(e.gap, 1e-3) << step;
    EXPECT_TRUE(finite(world));
    fmt::print("step {}: energy rises by {:.3g} J of {:.3g} J\n", step, e.rise, 0.5 * g);
  }
}

TEST(HardCasesInWorlds, WeldOfBodiesThatDoNotTurn) {
  World<double> world(settings(Solver::direct, Drift::projection, -g));
  const int a = world.add_body({.mass = 1, .inertia = 1, .fixed_rotation = true});
  const int b = world.add_body({.x = 1, .mass = 1, .inertia = 1, .fixed_rotation = true});
  world.add_joint({"weld", {a, b}, {{"pa", {0.5, 0}}}, {}});
  world.add_joint({"weld", {world.ground(), a}, {{"pa", {0, 0}}}, {}});
  EXPECT_LT(watch(world, 5).gap, 1e-6);
  EXPECT_TRUE(finite(world));
}

}  // namespace
}  // namespace cdot::test::worlds_test
