// Joints that break above a load: at which load, which of several, and the state afterwards.
#include <cdot/methods.hpp>

#include "tests/runtime/support.hpp"

namespace cdot::test::breaking_test {
namespace {

constexpr Solver both[] = {Solver::direct, Solver::iterative};

TEST(BreakingLoad, BreaksJustAboveIt) {
  for (Solver solver : both) {
    for (double load : {99.0, 101.0}) {
      Settings s = settings(solver, Drift::projection, -10);
      s.iterations = 200;
      World<double> world(s);
      const auto rods = add_chain(world, 5, -pi / 2, 2);
      set_breaking_load(world, 0, load);
      run(world, 1, 0.01);
      EXPECT_EQ(world.broken(0), load < 100);
      EXPECT_NEAR(world.pose(rods[4]).y, load < 100 ? -4.5 - 5 : -4.5, 0.11);
      EXPECT_FALSE(world.broken(1));
      EXPECT_LT(world.worst_position_error().value, 1e-6);
    }
  }
}

// The short form and the spec break the same joints in the same steps.
TEST(BreakingLoad, IsTheSpecOfThatName) {
  for (const bool by_spec : {false, true}) {
    World<double> world(settings(Solver::direct, Drift::projection, -10));
    const auto rods = add_chain(world, 5, 0.0, 2);
    for (const int joint : {1, 3}) {
      if (by_spec) add_effect(world, joint, {"breaking", {{"strength", {60}}}});
      else set_breaking_load(world, joint, 60);
    }
    static std::vector<double> places;
    std::vector<double> now;
    for (int k = 0; k < 100; ++k) {
      ASSERT_TRUE(world.step(0.01));
      now.insert(now.end(), {world.pose(rods[4]).x, world.pose(rods[4]).y, double(world.broken(1) + world.broken(3))});
    }
    EXPECT_GT(now.back(), 0);
    if (by_spec) {
      EXPECT_EQ(now, places);
    }
    places = now;
  }
}

TEST(BreakingLoad, WrongUsesAreRefused) {
  World<double> world(settings(Solver::direct, Drift::projection));
  add_chain(world, 1, 0.0);
  EXPECT_THROW(add_effect(world, 0, "angle", SpecEffect{"breaking", {{"strength", {1}}}}), Error);
  EXPECT_THROW(add_effect(world, 0, SpecEffect{"motor", {{"speed", {1}}}}), Error);
  EXPECT_THROW(add_effect(world, 0, SpecEffect{"breaking", {}}), Error);
  EXPECT_THROW(add_effect(world, 0, SpecEffect{"breaking", {{"strength", {-1}}}}), Error);
  EXPECT_THROW(add_effect(world, 5, SpecEffect{"breaking", {{"strength", {1}}}}), Error);
  const Profile falls = Profile::table({.times = {0, 1}, .values = {2, 1}});
  EXPECT_THROW(add_effect(world, 0, SpecEffect{"breaking", {in_time("strength", {falls})}}), Error);
}

// A mass of 2 kg falls into a spring of 100 N/m, as a soft joint or as an effect: at most 2 m g pull.
World<double> hanging(bool soft, Integrator integrator, double strength) {
  Settings s = settings(Solver::direct, Drift::projection, -9.81);
  s.integrator = integrator;
  World<double> world(s);
  const int body = world.add_body({.y = -1, .mass = 2, .inertia = 0.1});
  JointDefinition line{"distance", {world.ground(), body}, {{"pa", {0, 0}}, {"pb", {0, 0}}, {"l", {1}}}, {}};
  if (soft) line.soft = Softness{.by_frequency = false, .stiffness = 100, .damping = 1};
  else
    line.type = "spring", line.parameters[2].name = "rest",
    line.parameters.insert(line.parameters.end(), {{"k", {100}}, {"d", {1}}});
  set_breaking_load(world, world.add_joint(line), strength);
  return world;
}

TEST(BreakingLoad, BreaksSpringsByEveryMethod) {
  for (const bool soft : {true, false})
    for (const IntegratorRow& row : integrator_rows)
      for (const double strength : {30, 40}) {
        World<double> world = hanging(soft, row.integrator, strength);
        run(world, 0.5, 0.001);
        EXPECT_EQ(world.broken(0), strength < 2 * 2 * 9.81) << row.name << (soft ? ", soft" : ", effect");
      }
}

// Of these methods it is a mean over the step: m (v' - v) = (F - m g) h.
TEST(BreakingLoad, OfASpringIsItsWholeImpulse) {
  constexpr double h = 0.005;
  for (const bool soft : {true, false})
    for (const Integrator integrator : {Integrator::euler, Integrator::implicit, Integrator::rattle}) {
      World<double> world = hanging(soft, integrator, 100);
      for (int k = 0; k < 200; ++k) {
        const double v = world.velocity(0).y;
        ASSERT_TRUE(world.step(h));
        ASSERT_NEAR(world.reaction(0, 0).force_y, 2 * ((world.velocity(0).y - v) / h + 9.81), 1e-10)
            << row_of(integrator).name << (soft ? ", soft" : ", effect") << ", step " << k;
      }
    }
}

TEST(BreakingLoad, OfOneJointAmongMany) {
  for (Solver solver : both) {
    Settings s = settings(solver, Drift::projection, -10);
    s.iterations = 100;
    World<double> world(s);
    const auto rods = add_chain(world, 5, 0.0, 2);
    add_spring(world, 2, "angle", {.softness = {.by_frequency = false, .damping = 0.1}});
    set_breaking_load(world, 2, 5);
    run(world, 0.5, 0.005);
    EXPECT_TRUE(world.broken(2));
    const auto impulse = world.impulse(2);
    EXPECT_EQ(impulse[0], 0);
    EXPECT_LT(world.worst_position_error().value, 1e-3);
    world.add_body({.mass = 1});  // analyses the islands again, without the broken joint
    run(world, 0.5, 0.005);
    EXPECT_EQ(world.island_count(), 3);
    EXPECT_LT(world.pose(rods[4]).y, -2);
  }
}

// The springs of a joint that is gone store nothing.
TEST(BreakingLoad, TheSpringsOfABrokenJointHaveNoEnergy) {
  for (const bool breaks : {false, true}) {
    World<double> world(settings(Solver::direct, Drift::projection, -10));
    const int rod_of_it = add_chain(world, 1, 0.0).front();
    add_spring(world, 0, "angle", {.softness = {.by_frequency = false, .stiffness = 100}, .rest = 0.3});
    const double stretched = 0.5 * 100 * 0.3 * 0.3;
    EXPECT_NEAR(world.energy(), stretched, 1e-12);
    if (breaks) set_breaking_load(world, 0, 1e-3);
    else world.remove_joint(0);
    world.step(1e-9);
    ASSERT_TRUE(world.broken(0));
    EXPECT_NEAR(world.energy(), 0, 1e-6) << rod_of_it;
  }
}

// A crank that turns with time, and drives a disc through a spring: after its first step, which may break it.
World<double> driven_by_a_spring(const Settings& s, double load) {
  World<double> world(s);
  const int disc = world.add_body({.mass = 1, .inertia = 1});
  const int crank = world.add_joint({.type = "driven_crank",
                                     .bodies = {world.ground(), disc},
                                     .parameters = {{"pa", {0, 0}}, {"pb", {0, 0}}, {"rate", {5}}},
                                     .soft = Softness{.by_frequency = false, .stiffness = 100, .damping = 1}});
  set_breaking_load(world, crank, load);
  EXPECT_TRUE(world.step(0.01));
  EXPECT_EQ(world.broken(crank), load < 1);
  return world;
}

// The energy that goes with a joint is that of the end of the step, as time drives it.
TEST(BreakingLoad, TakesTheEnergyThatADrivenSpringHas) {
  for (const Solver solver : {Solver::direct, Solver::iterative})
    for (const IntegratorRow& row : integrator_rows) {
      Settings s = settings(solver, solver == Solver::iterative ? Drift::soft : Drift::projection, 0);
      s.integrator = row.integrator;
      if (row.level != Level::velocity || mistake_in_methods(s)) continue;
      const Balance holds = driven_by_a_spring(s, unlimited).balance(), broken = driven_by_a_spring(s, 1e-3).balance();
      EXPECT_GT(holds.potential, 0) << row.name;
      EXPECT_EQ(broken.potential, 0) << row.name;
      EXPECT_NEAR(broken.taken - holds.taken, holds.potential, 1e-9 * holds.potential) << row.name;
    }
}

// By sweeps, two pins that misfit pull at each other ever harder. They carry nothing, so they share nothing.
TEST(BreakingLoad, JointsThatWorkAgainstEachOtherDoNotBreak) {
  World<double> world(settings(Solver::iterative, Drift::baumgarte));
  const int body = world.add_body({.mass = 1, .inertia = 1});
  for (double x : {-1e-5, 1e-5}) set_breaking_load(world, revolute(world, world.ground(), body, x, 0, 0, 0), 0.1);
  run(world, 1, 0.01);
  EXPECT_FALSE(world.broken(0) || world.broken(1));
}

// Both pins of two hanging rods carry too much. Without the upper one, the rods fall and the lower one carries nothing.
TEST(BreakingLoad, OfJointsInARowOneBreaks) {
  for (Solver solver : both) {
    World<double> world(settings(solver, Drift::projection, -10));
    add_chain(world, 2, -pi / 2);
    for (int joint : {0, 1}) set_breaking_load(world, joint, 5);
    run(world, 0.2, 0.01);
    EXPECT_TRUE(world.broken(0));
    EXPECT_FALSE(world.broken(1));
  }
}

// A weight falls on a rod of length l from the horizontal. The rod carries 3 m g sin(angle) (Newton's law along the
// rod, with m v^2 / 2 = m g l sin(angle)) and breaks at sin(angle) = strength / (3 m g). From there on the weight keeps
// its speed sideways, v sin(angle).
struct WeightOnARod {
  explicit WeightOnARod(Integrator integrator, double local_error = 0) : world(method(integrator, local_error)) {
    weight = world.add_body({.x = 1, .mass = 2, .inertia = 1});
    distance(world, world.ground(), weight, 1);
    set_breaking_load(world, 0, strength);
  }
  static Settings method(Integrator integrator, double local_error) {
    Settings s = settings(Solver::direct, Drift::projection, -10);
    s.integrator = integrator, s.local_error = local_error;
    return s;
  }
  double error() {
    EXPECT_TRUE(world.broken(0));
    const double sine = strength / (3 * 2 * 10), speed = std::sqrt(2 * 10 * sine);
    return std::abs(world.velocity(weight).x + speed * sine);
  }
  static constexpr double strength = 33;
  World<double> world;
  int weight;
};

// Methods that locate events find the moment, to 3e-10 of the load (`just_passed` in runtime/step/between.cpp). The
// others break the rod after the step, an error of first order.
TEST(BreakingLoad, IsLocatedWithinTheStep) {
  for (const double h : {0.05, 0.02}) {
    WeightOnARod adaptive(Integrator::dop853, 1e-12), stiff(Integrator::radau5, 1e-12), fixed(Integrator::dop853);
    WeightOnARod rattle(Integrator::rattle);
    for (WeightOnARod* run_by : {&adaptive, &stiff, &fixed, &rattle}) run(run_by->world, 0.6, h);
    EXPECT_LT(adaptive.error(), 3e-9) << h;
    EXPECT_LT(stiff.error(), 1e-8) << h;
    EXPECT_LT(fixed.error(), 1e-6) << h;
    EXPECT_GT(rattle.error(), 1e-4) << h;
    EXPECT_LT(rattle.error(), 20 * h) << h;
    EXPECT_NEAR(adaptive.world.energy(), 0, 1e-9) << h;
  }
}

// Of two rods in a row the upper one breaks, of its load; the lower one then carries nothing, at once.
TEST(BreakingLoad, IsLocatedForTheMostOverloadedJointAlone) {
  WeightOnARod below(Integrator::dop853, 1e-10);
  const int lower = below.world.add_body({.x = 2, .mass = 2, .inertia = 1});
  const int rod = distance(below.world, below.weight, lower, 1);
  set_breaking_load(below.world, rod, WeightOnARod::strength);
  run(below.world, 0.6, 0.05);
  EXPECT_TRUE(below.world.broken(0));
  EXPECT_FALSE(below.world.broken(rod));
}

// A weight falls from its peg on a cord of length 1 that becomes taut at t = sqrt(2 l / g). The blow m v stops it; over
// the time of a blow it is a load. Where that breaks the cord, the weight falls on at once, from rest.
struct WeightOnACord {
  WeightOnACord(const Settings& settings, double strength) : world(settings) {
    weight = world.add_body({.mass = 2, .fixed_rotation = true});
    cord = world.add_joint({.type = "max_distance",
                            .bodies = {world.ground(), weight},
                            .parameters = {{"pa", {0, 0}}, {"pb", {0, 0}}, {"l", {1}}},
                            .soft = {}});
    set_breaking_load(world, cord, strength);
  }
  static constexpr double g = 10, end = 0.9;
  static double blow() { return 2 * std::sqrt(2 * g); }
  static double fallen() {
    const double since = end - std::sqrt(2 / g);
    return 1 + g / 2 * since * since;
  }
  World<double> world;
  int weight, cord;
};

TEST(BreakingLoad, ABlowBreaksAtOnce) {
  for (const IntegratorRow& row : integrator_rows) {
    if (row.level != Level::acceleration) continue;
    for (const double local_error : {0.0, 1e-10})
      for (const int steps : {9, 20, 300}) {
        Settings s = settings(Solver::direct, Drift::projection, -WeightOnACord::g);
        s.integrator = row.integrator, s.local_error = local_error;
        const double h = WeightOnACord::end / steps, lasts = local_error > 0 ? 1e-3 : h;
        WeightOnACord weak(s, 0.99 * WeightOnACord::blow() / lasts), strong(s, 1.01 * WeightOnACord::blow() / lasts);
        run(weak.world, WeightOnACord::end, h), run(strong.world, WeightOnACord::end, h);
        EXPECT_TRUE(weak.world.broken(weak.cord)) << row.name << " by " << h;
        EXPECT_NEAR(weak.world.pose(weak.weight).y, -WeightOnACord::fallen(), 1e-8) << row.name << " by " << h;
        EXPECT_FALSE(strong.world.broken(strong.cord)) << row.name << " by " << h;
        EXPECT_NEAR(strong.world.pose(strong.weight).y, -1, 1e-8) << row.name << " by " << h;
      }
  }
}

// The same cord between two weights, of which a pin holds the upper one on a rail. The blow shears the pin, and both
// fall on together.
TEST(BreakingLoad, ABlowShearsAPinAtOnce) {
  for (const double h : {0.1, 0.003}) {
    Settings s = settings(Solver::direct, Drift::projection, -WeightOnACord::g);
    s.integrator = Integrator::dop853, s.local_error = 1e-10;
    WeightOnACord hangs(s, unlimited);
    const int upper = hangs.world.add_body({.mass = 3, .fixed_rotation = true});
    const int rail = hangs.world.add_joint({.type = "line",
                                            .bodies = {upper, hangs.world.ground()},
                                            .parameters = {{"pa", {0, 0}}, {"pb", {0, 0}}, {"t", {1, 0}}},
                                            .soft = {}});
    add_effect(hangs.world, rail, "slide", SpecEffect{"shear_pin", {{"strength", {0.99e3 * WeightOnACord::blow()}}}});
    hangs.world.remove_joint(hangs.cord);
    hangs.world.add_joint({.type = "max_distance",
                           .bodies = {upper, hangs.weight},
                           .parameters = {{"pa", {0, 0}}, {"pb", {0, 0}}, {"l", {1}}},
                           .soft = {}});
    run(hangs.world, WeightOnACord::end, h);
    EXPECT_NEAR(hangs.world.pose(hangs.weight).y, -WeightOnACord::fallen(), 1e-8) << h;
    EXPECT_NEAR(hangs.world.pose(upper).y, 1 - WeightOnACord::fallen(), 1e-8) << h;
  }
}

}  // namespace
}  // namespace cdot::test::breaking_test
