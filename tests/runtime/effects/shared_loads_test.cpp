// Brakes, pins, ropes and joints that hold one motion together: which of them breaks is the same by every method.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include <cdot/methods.hpp>

#include "runtime/state/world_data.hpp"
#include "tests/runtime/effects/generated_effects.hpp"
#include "tests/runtime/sines.hpp"

namespace cdot::test {
namespace {

using effects::wheel;
using effects::with;

// The turn of a wheel under 24.525 N m that brakes and a pin hold, the pin before them or after; with `beside`, other
// rows that do not act.
struct Order {
  bool pin_first, beside;
};
double turned(Integrator integrator, const std::vector<double>& brakes, double strength, Order order) {
  World<double> world(with(integrator));
  const int body = world.add_body({.mass = 1, .inertia = 1});
  world.set_force(body, {0, 0, -24.525});
  const int hinge = revolute(world, world.ground(), body, 0, 0, 0, 0);
  const SpecEffect pin{"shear_pin", {{"strength", {strength}}}};
  if (order.pin_first) add_effect(world, hinge, "angle", pin);
  for (const double torque : brakes) add_effect(world, hinge, "angle", {"brake", {{"torque", {torque}}}});
  if (!order.pin_first) add_effect(world, hinge, "angle", pin);
  if (order.beside) world.add_joint({"backlash", {world.ground(), body}, {{"play", {0.5}}}, {}});
  for (int k = 0; k < 20; ++k) EXPECT_TRUE(world.step(0.005));
  return world.pose(body).angle;
}

// The brakes give all that they have, and no more: the pin carries the rest.
TEST(SharedLoads, BrakesBesideAPinGiveNoMoreThanTheyHave) {
  for (const IntegratorRow& row : integrator_rows)
    for (const std::vector<double>& brakes : {std::vector{4.0}, std::vector{4.0, 7.0}})
      for (const Order order : {Order{false, false}, {false, true}, {true, false}, {true, true}}) {
        const double rest = 24.525 - std::accumulate(brakes.begin(), brakes.end(), 0.0);
        const std::string what =
            fmt::format("{}, {} brakes{}{}", row.name, brakes.size(), order.pin_first ? " after the pin" : "",
                        order.beside ? ", beside play" : "");
        EXPECT_LT(turned(row.integrator, brakes, rest - 0.02, order), -0.06) << what;
        EXPECT_NEAR(turned(row.integrator, brakes, rest + 0.02, order), 0, 1e-12) << what;
      }
}

// A rod of 1 kg hangs level on a hinge with friction of 1 N m and on a rope at its end. Without friction the rope pulls
// m g / 2 / sin(its angle). No share of the load puts more on it, since friction need not work against it.
TEST(SharedLoads, FrictionDoesNotTearARope) {
  const double pull = 9.81 / 2 / (1.44 / std::hypot(0.23, 1.44));
  for (const IntegratorRow& row : integrator_rows)
    for (const double share : {0.6, 1.001}) {
      World<double> world(with(row.integrator, -9.81));
      const int rod = world.add_body({.x = 0.5, .mass = 1, .inertia = 1.0 / 12});
      const int hinge = revolute(world, world.ground(), rod, 0, 0, -0.5, 0);
      add_friction(world, hinge, "angle", {1});
      world.add_joint({"tearing_rope",
                       {world.ground(), rod},
                       {{"pa", {1.23, 1.44}}, {"pb", {0.5, 0}}, {"strength", {share * pull}}},
                       {}});
      for (int k = 0; k < 20; ++k) ASSERT_TRUE(world.step(0.005));
      if (share > 1) EXPECT_NEAR(world.pose(rod).angle, 0, 1e-12) << row.name;
      else EXPECT_LT(world.pose(rod).angle, -0.03) << row.name;
    }
}

// A rod on a hinge with a pin: both are overloaded until the pin is sheared, and then the hinge holds.
TEST(SharedLoads, APinShearsBeforeAJointBreaks) {
  for (const IntegratorRow& row : integrator_rows) {
    World<double> world(with(row.integrator, -9.81));
    const int rod = world.add_body({.x = 0.5, .mass = 2, .inertia = 2.0 / 12});
    const int hinge = revolute(world, world.ground(), rod, 0, 0, -0.5, 0);
    add_effect(world, hinge, "angle", {"shear_pin", {{"strength", {5}}}});
    set_breaking_load(world, hinge, 15);  // of 19.6 N with the pin, and 4.9 N without
    for (int k = 0; k < 10; ++k) ASSERT_TRUE(world.step(0.002));
    EXPECT_FALSE(world.broken(hinge)) << row.name;
    EXPECT_LT(world.pose(rod).angle, -1e-3) << row.name;
  }
}

// A motor of unlimited force starts by a blow, of 2 kg m^2/s here. It shears a pin of the shaft that it turns.
TEST(SharedLoads, AMotorThatStartsAtOnceShearsAPin) {
  for (const IntegratorRow& row : integrator_rows)
    for (const double strength : {100.0, 1e4}) {
      World<double> world(with(row.integrator));
      const int drum = wheel(world, 5), load = wheel(world, 1);
      add_motor(world, revolute(world, world.ground(), drum, 0, 0, 0, 0), "angle", {2});
      add_effect(world, revolute(world, drum, load, 0, 0, 0, 0), "angle", {"shear_pin", {{"strength", {strength}}}});
      world.add_joint({"brake", {load, world.ground()}, {{"torque", {3}}}, {}});
      for (int k = 0; k < 400; ++k) ASSERT_TRUE(world.step(0.002));
      if (strength < 1e3) EXPECT_NEAR(world.velocity(load).w, 0, 1e-6) << row.name;
      else EXPECT_NEAR(world.velocity(load).w, 2, 1e-6) << row.name;
    }
}

// Up to four cranks of 1 m, upright and level at their feet, and a rod on their heads: three of them are one too many.
struct Cranks {
  Cranks(Integrator integrator, const std::vector<double>& masses) : world(with(integrator, -9.81)) {
    const int count = static_cast<int>(masses.size()) - 1;
    const int coupler = world.add_body({.x = (count - 1) / 2.0, .y = 1, .mass = masses.back(), .inertia = 1});
    for (int k = 0; k < count; ++k) {
      const double m = masses[static_cast<size_t>(k)];
      const int crank = world.add_body({.x = double(k), .y = 0.5, .mass = m, .inertia = m / 12});
      feet.push_back(revolute(world, world.ground(), crank, k, 0, 0, -0.5));
      heads.push_back(revolute(world, crank, coupler, 0, 0.5, k - (count - 1) / 2.0, 0));
    }
    set_breaking_load(world, feet[0], 1e4);  // loads are shared
  }
  void brake(int joint, double torque) { add_effect(world, joint, "angle", {"brake", {{"torque", {torque}}}}); }
  void motor(int joint, double speed, double most) {
    add_motor(world, joint, "angle", {.speed = speed, .max_force = most});
  }
  // Of all joints, in turn.
  std::vector<double> loads() const {
    std::vector<double> loads;
    for (const std::vector<int>* joints : {&feet, &heads})
      for (const int joint : *joints) {
        const auto load = world.reaction(joint, world.joint_bodies(joint)[1]);
        loads.insert(loads.end(), {load.force_x, load.force_y});
      }
    return loads;
  }
  World<double> world;
  std::vector<int> feet, heads;
};

double largest_difference(const std::vector<double>& one, const std::vector<double>& other) {
  double largest = 0;
  for (size_t k = 0; k < one.size(); ++k) largest = std::max(largest, std::abs(one[k] - other[k]));
  return largest;
}

// Motors press a crank against a stop, or load a pin, beside brakes that hold as well. A stop lets go where the motion
// bends away from it, but at rest what is left of the motion is round-off: in a third of these mechanisms it told that
// the stop opens. A pin has no side on which to open.
TEST(SharedLoads, AtRestNoStopAndNoPinLetsGo) {
  for (const bool pinned : {false, true})
    for (int draw = 0; draw < 12; ++draw) {
      std::vector<double> masses, first;
      for (int k = 1; k <= 5; ++k) masses.push_back(0.5 + std::fmod((5 * draw + k) * 0.6180339887498949, 1) * 2.5);
      for (const IntegratorRow& row : integrator_rows) {
        Cranks cranks(row.integrator, masses);
        const auto &feet = cranks.feet, &heads = cranks.heads;
        cranks.motor(feet[0], 1, 10), cranks.motor(heads[0], 1, 1), cranks.motor(feet[1], -1, 30);
        cranks.motor(feet[2], -2, 30), cranks.motor(feet[3], 1, 30);
        if (pinned) add_effect(cranks.world, feet[0], "angle", {"shear_pin", {{"strength", {1e3}}}});
        else add_limit(cranks.world, feet[0], "angle", {.lower = 0, .upper = 1});
        cranks.brake(heads[0], 2), cranks.brake(feet[1], 5), cranks.brake(feet[1], 1), cranks.brake(feet[2], 0.5);
        cranks.brake(heads[2], 4), cranks.brake(heads[3], 10);
        for (int k = 0; k < 2; ++k) ASSERT_TRUE(cranks.world.step(0.01));
        if (first.empty()) first = cranks.loads();
        EXPECT_LT(largest_difference(cranks.loads(), first), 1e-6)
            << row.name << (pinned ? ", pin, draw " : ", stop, draw ") << draw;
      }
    }
}

// A crank, a rod and a slide in line, with a pin on the slide: its row follows from those of the joints. Each of these
// three carries x of the slide's 10 N, and the pin p = 10 - x. 3 x^2 + p^2 is least for x = 2.5 N. The slide bends away
// from the end of its way, but a pin holds it there on both sides.
TEST(SharedLoads, APinAtADeadCentreHasItsShare) {
  for (const IntegratorRow& row : integrator_rows) {
    World<double> world(with(row.integrator));
    const int crank = world.add_body(rod(0, 0, 0)), bar = world.add_body(rod(1, 0, 0));
    const int slide = world.add_body({.x = 2, .mass = 1, .inertia = 1});
    const int foot = revolute(world, world.ground(), crank, 0, 0, -0.5, 0);
    revolute(world, crank, bar, 0.5, 0, -0.5, 0);
    revolute(world, bar, slide, 0.5, 0, 0, 0);
    const int rail =
        world.add_joint({"prismatic", {slide, world.ground()}, {{"pa", {0, 0}}, {"pb", {2, 0}}, {"t", {0, 1}}}, {}});
    set_breaking_load(world, foot, 1e4);
    add_effect(world, rail, "slide", {"shear_pin", {{"strength", {1e3}}}});
    add_friction(world, foot, "angle", {.max_force = 1});  // forces decide about it
    world.set_force(slide, {10, 0, 0});
    for (int k = 0; k < 2; ++k) ASSERT_TRUE(world.step(0.01));
    EXPECT_NEAR(std::abs(world.reaction(foot, crank).force_x), 2.5, 1e-6) << row.name;
  }
}

// The least sum of squares is one solution, wherever its search begins.
TEST(SharedLoads, EveryMethodSharesAlike) {
  std::mt19937 draw(7);
  const auto one_of = [&](const std::vector<double>& values) { return values[draw() % values.size()]; };
  for (int mechanism = 0; mechanism < 400; ++mechanism) {
    const int count = 2 + static_cast<int>(draw() % 3);
    std::vector<double> masses, first;
    for (int k = 0; k <= count; ++k) masses.push_back(one_of({0.5, 1, 2, 5}));
    const unsigned effects = draw();
    for (const IntegratorRow& row : integrator_rows) {
      draw.seed(effects);
      Cranks cranks(row.integrator, masses);
      for (const std::vector<int>* joints : {&cranks.feet, &cranks.heads})
        for (const int joint : *joints) {
          if (draw() % 2 == 0) cranks.motor(joint, one_of({-1, 1, 2, -2}), one_of({1, 3, 10, 30}));
          if (draw() % 3 == 0) cranks.brake(joint, one_of({0.5, 2, 5}));
          if (draw() % 3 == 0) cranks.brake(joint, one_of({1, 4, 10}));
          if (draw() % 3 == 0) add_effect(cranks.world, joint, "angle", {"shear_pin", {{"strength", {1e3}}}});
          else if (draw() % 4 == 0) add_limit(cranks.world, joint, "angle", {.lower = 0, .upper = 1});
        }
      ASSERT_TRUE(cranks.world.step(1e-7));
      if (first.empty()) first = cranks.loads();
      EXPECT_LT(largest_difference(cranks.loads(), first), 1e-4) << row.name << ", mechanism " << mechanism;
    }
  }
}

// A weight on two pins at one place. Each carries half of it. Without one of them the other carries all.
struct WeightOnTwoPins {
  WeightOnTwoPins(Integrator integrator, double load_1, double load_2)
      : WeightOnTwoPins(method(integrator), load_1, load_2) {}
  WeightOnTwoPins(const Settings& settings, double load_1, double load_2) : world(settings) {
    body = world.add_body({.mass = 1, .inertia = 1});
    for (double load : {load_1, load_2})
      set_breaking_load(world, revolute(world, world.ground(), body, 0, 0, 0, 0), load);
    run(world, 0.2, 0.01);
  }
  static Settings method(Integrator integrator) {
    Settings s = settings(Solver::direct, Drift::projection, -10);
    s.integrator = integrator;
    return s;
  }
  World<double> world;
  int body;
};

TEST(BreakingLoad, RedundantJointsShareTheLoad) {
  for (const IntegratorRow& row : integrator_rows) {
    WeightOnTwoPins both_hold(row.integrator, 6, 6);
    EXPECT_FALSE(both_hold.world.broken(0)) << row.name;
    EXPECT_FALSE(both_hold.world.broken(1)) << row.name;
    for (int joint : {0, 1}) EXPECT_NEAR(both_hold.world.reaction(joint, both_hold.body).force_y, 5, 1e-9) << row.name;
    EXPECT_NEAR(both_hold.world.pose(both_hold.body).y, 0, 1e-9);
  }
}

// After steps of h at acceleration level, in ascending order.
std::vector<double> forces_under_laws(World<double>& world, double h) {
  std::vector<double> forces;
  world.data().islands.at(0).system.each_row([&](int, const auto& batch, int i) {
    if (batch.law && batch.law->guard) forces.push_back(std::abs(batch.lambda[i]) / h);
  });
  std::ranges::sort(forces);
  return forces;
}

// Two brakes of 1 and 100 N m hold the weight 0.5 m beside the pins. An equal share would be 2.5 N m. The weak one
// slips at none, so it carries all that it can.
TEST(BreakingLoad, RedundantJointsShareTheLoadBesideBrakes) {
  for (const IntegratorRow& row : integrator_rows)
    for (const double strong : {100.0, 3.0}) {
      World<double> world(WeightOnTwoPins::method(row.integrator));
      const int body = world.add_body({.x = 0.5, .mass = 1, .inertia = 1});
      for (const double torque : {1.0, strong}) {
        const int pin = revolute(world, world.ground(), body, 0, 0, -0.5, 0);
        set_breaking_load(world, pin, 1e3);
        add_effect(world, pin, "angle", SpecEffect{"friction", {{"max", {torque}}}});
      }
      run(world, 0.1, 0.01);
      const bool holds = strong == 100;
      EXPECT_NEAR(world.pose(body).angle, holds ? 0 : -0.5 * 1 / 1.25 * 0.01, holds ? 1e-9 : 5e-4) << row.name;
      const double y = world.reaction(0, body).force_y;
      EXPECT_NEAR(y, world.reaction(1, body).force_y, 1e-6) << row.name << " beside " << strong << " N m";
      EXPECT_NEAR(y, holds ? 5 : y, 1e-9) << row.name;
      if (row.level != Level::acceleration) continue;  // the others keep impulses of parts of the step
      const std::vector<double> brakes = forces_under_laws(world, 0.01);
      ASSERT_EQ(brakes.size(), 2u);
      EXPECT_NEAR(brakes[0], 1, 1e-6) << row.name << " beside " << strong << " N m";
      EXPECT_NEAR(brakes[1], holds ? 4 : 3, 1e-6) << row.name << " beside " << strong << " N m";
    }
}

// The load grows from 0. First both brakes carry half of it, then the weak one all that it can.
TEST(BreakingLoad, RedundantBrakesShareALoadThatGrows) {
  for (const IntegratorRow& row : integrator_rows) {
    if (row.level != Level::acceleration) continue;
    Settings s = WeightOnTwoPins::method(row.integrator);
    s.gravity_y = 0;
    World<double> world(s);
    const int body = world.add_body({.mass = 1, .inertia = 1});
    for (const double torque : {1.0, 100.0}) {
      const int pin = revolute(world, world.ground(), body, 0, 0, 0, 0);
      set_breaking_load(world, pin, 1e3);
      add_effect(world, pin, "angle", SpecEffect{"friction", {{"max", {torque}}}});
    }
    add_effect(world, 0, "angle", SpecEffect{"load", {in_time("push", {sine(0, 5, 10)})}});
    for (int k = 1; k <= 20; ++k) {
      ASSERT_TRUE(world.step(0.005));
      const double whole = 5 * std::sin(10 * world.time());
      const std::vector<double> brakes = forces_under_laws(world, 0.005);
      ASSERT_EQ(brakes.size(), 2u);
      EXPECT_NEAR(brakes[0], std::min(whole / 2, 1.0), 1e-6) << row.name << " at " << world.time() << " s";
      EXPECT_NEAR(brakes[0] + brakes[1], whole, 1e-6) << row.name << " at " << world.time() << " s";
    }
    EXPECT_EQ(world.step_counts().events, 0) << row.name;
  }
}

TEST(BreakingLoad, OneJointBreaksWhereTheOtherCarriesAll) {
  for (const IntegratorRow& row : integrator_rows) {
    for (int weak : {0, 1}) {
      WeightOnTwoPins one_holds(row.integrator, weak == 0 ? 4 : 11, weak == 0 ? 11 : 4);
      EXPECT_EQ(one_holds.world.broken(0), weak == 0) << row.name;
      EXPECT_EQ(one_holds.world.broken(1), weak == 1) << row.name;
      EXPECT_NEAR(one_holds.world.pose(one_holds.body).y, 0, 1e-9);
      WeightOnTwoPins none_holds(row.integrator, weak == 0 ? 4 : 9, weak == 0 ? 9 : 4);
      EXPECT_TRUE(none_holds.world.broken(0) && none_holds.world.broken(1)) << row.name;
    }
  }
}

// Sweeps load the first of two pins alone.
TEST(BreakingLoad, BySweepsRedundantJointsShareTheLoadToo) {
  for (Drift drift : {Drift::soft, Drift::baumgarte, Drift::projection, Drift::none})
    for (const IntegratorRow& row : integrator_rows) {
      Settings s = settings(Solver::iterative, drift, -10);
      s.integrator = row.integrator;
      if (mistake_in_methods(s)) continue;
      for (double load : {9.0, 11.0}) {  // what both can carry
        WeightOnTwoPins pins(s, load / 2, load / 2);
        EXPECT_EQ(pins.world.broken(0) && pins.world.broken(1), load < 10) << row.name;
        EXPECT_EQ(pins.world.broken(0), pins.world.broken(1)) << row.name;
      }
    }
}

}  // namespace
}  // namespace cdot::test
