// Effects of specs/coordinate, on coordinates in any unit: under their names in programs and by their structs they are
// one law; what is unlimited acts by impulses.
#include "tests/runtime/effects/generated_effects.hpp"

namespace cdot::test {
namespace {

using effects::with;

struct Pair {
  const char* name;
  int (*by_struct)(World<double>&, int joint, const char* coordinate);
  SpecEffect spec;
};

const Pair pairs[] = {
    {"motor",
     [](World<double>& w, int joint, const char* c) {
       return add_motor(w, joint, c, {1.5, 2});
     },
     {"motor", {{"speed", {1.5}}, {"max", {2}}}}},
    {"friction",
     [](World<double>& w, int joint, const char* c) { return add_friction(w, joint, c, {0.8}); },
     {"friction", {{"max", {0.8}}}}},
    {"limit",
     [](World<double>& w, int joint, const char* c) {
       return add_limit(w, joint, c, {-0.3, 1.4});
     },
     {"limit", {{"lower", {-0.3}}, {"upper", {1.4}}}}},
    {"spring",
     [](World<double>& w, int joint, const char* c) {
       return add_spring(w, joint, c, {{.by_frequency = false, .stiffness = 30, .damping = 0.4}, 0.2});
     },
     {"spring", {{"stiffness", {30}}, {"damping", {0.4}}, {"rest", {0.2}}}}},
    {"spring by frequency",
     [](World<double>& w, int joint, const char* c) {
       return add_spring(w, joint, c, {{.frequency = 1.2, .damping_ratio = 0.1}, 0.2});
     },
     {"spring", {{"frequency", {1.2}}, {"damping_ratio", {0.1}}, {"rest", {0.2}}}}},
    {"load",
     [](World<double>& w, int joint, const char* c) { return add_effect(w, joint, c, Load{0.7}); },
     {"load", {{"push", {0.7}}}}},
};

// A slider on a rail and a wheel on an axle, each with the effect on its coordinate.
template <class Add>
std::array<double, 4> motion(Integrator integrator, const Add& add) {
  World<double> world(with(integrator));
  const int slide = world.add_body({.x = 1, .vx = 0.9, .mass = 2, .inertia = 1});
  const int rail =
      world.add_joint({"prismatic", {slide, world.ground()}, {{"pa", {0, 0}}, {"pb", {0, 0}}, {"t", {0, 1}}}, {}});
  const int rotor = world.add_body({.w = -1.5, .mass = 1, .inertia = 0.5, .torque = 0.2});
  const int axle = revolute(world, world.ground(), rotor, 0, 0, 0, 0);
  add(world, rail, "slide"), add(world, axle, "angle");
  for (int n = 0; n < 100; ++n) EXPECT_TRUE(world.step(0.01));
  return {world.pose(slide).x, world.velocity(slide).x, world.pose(rotor).angle, world.velocity(rotor).w};
}

TEST(FreeEffects, AStructAndTheNameOfItsSpecAreOneLaw) {
  for (const Pair& pair : pairs) {
    for (const IntegratorRow& row : integrator_rows) {
      const auto of_struct = motion(row.integrator, pair.by_struct);
      const auto of_spec = motion(row.integrator, [&](World<double>& world, int joint, const char* coordinate) {
        return add_effect(world, joint, coordinate, pair.spec);
      });
      const auto none = motion(row.integrator, [](World<double>&, int, const char*) { return 0; });
      EXPECT_EQ(of_struct, of_spec) << pair.name << ", " << row.name;
      EXPECT_GT(std::abs(none[1] - of_spec[1]), 1e-3) << pair.name << " does nothing to the slider";
      EXPECT_GT(std::abs(none[3] - of_spec[3]), 1e-3) << pair.name << " does nothing to the wheel";
    }
  }
}

// A limit becomes a lock and a limit again; a spring changes from its stiffness to its frequency.
TEST(FreeEffects, ChangeTheirKindInARun) {
  for (const IntegratorRow& row : integrator_rows) {
    World<double> world(with(row.integrator));
    const int wheel = world.add_body({.w = 1, .mass = 1, .inertia = 0.5});
    const int axle = revolute(world, world.ground(), wheel, 0, 0, 0, 0);
    const int limit = add_limit(world, axle, "angle", {-1, 1});
    for (int n = 0; n < 50; ++n) ASSERT_TRUE(world.step(0.01));
    EXPECT_NEAR(world.pose(wheel).angle, 0.5, 1e-9) << row.name;
    set_limit(world, axle, limit, {0.5, 0.5});
    for (int n = 0; n < 50; ++n) ASSERT_TRUE(world.step(0.01));
    EXPECT_NEAR(world.pose(wheel).angle, 0.5, 1e-6) << row.name;
    EXPECT_NEAR(world.velocity(wheel).w, 0, 1e-9) << row.name;
    set_limit(world, axle, limit, {-1, unlimited});
    world.set_velocity(wheel, {0, 0, 3});
    for (int n = 0; n < 100; ++n) ASSERT_TRUE(world.step(0.01));
    EXPECT_NEAR(world.pose(wheel).angle, 3.5, 1e-6) << row.name;
  }
}

// A clutch without a largest torque: b is at once as fast as a, where a would be behind, and free ahead of it.
TEST(FreeEffects, AFreewheelWithoutALimitDrivesAtOnce) {
  constexpr double I[2] = {0.5, 0.8};
  for (const IntegratorRow& row : integrator_rows) {
    for (const double ahead : {1.0, -1.0}) {
      World<double> world(with(row.integrator));
      const int a = effects::wheel(world, I[0], 0, 2 + ahead), b = effects::wheel(world, I[1], 0, 2);
      world.add_joint({"freewheel", {a, b}, {}, {}});
      for (int n = 0; n < 20; ++n) ASSERT_TRUE(world.step(0.01));
      const double common = (I[0] * (2 + ahead) + I[1] * 2) / (I[0] + I[1]);
      EXPECT_NEAR(world.velocity(a).w, ahead > 0 ? 2 + ahead : common, 1e-9) << row.name;
      EXPECT_NEAR(world.velocity(b).w, ahead > 0 ? 2 : common, 1e-9) << row.name;
      EXPECT_NEAR(world.pose(b).angle, 0.2 * (ahead > 0 ? 2 : common), ahead > 0 ? 1e-9 : 6e-3) << row.name;
    }
  }
}

// A clutch holds a wheel against a torque that changes: the wheel stays, and where the torque is constant it rests.
TEST(FreeEffects, AFreewheelHoldsALoadThatChanges) {
  for (const IntegratorRow& row : integrator_rows) {
    World<double> world(with(row.integrator));
    const int wheel = effects::wheel(world, 0.4);
    world.add_joint({"freewheel", {wheel, world.ground()}, {{"most", {10}}}, {}});
    for (int n = 0; n < 200; ++n) {
      world.set_force(wheel, {0, 0, -3 - 2 * std::sin(0.1 * n)});
      ASSERT_TRUE(world.step(0.01));
    }
    EXPECT_NEAR(world.pose(wheel).angle, 0, row.integrator == Integrator::euler ? 1e-9 : 1e-3) << row.name;
    EXPECT_NEAR(world.velocity(wheel).w, 0, 1e-9) << row.name;
    for (int n = 0; n < 10; ++n) ASSERT_TRUE(world.step(0.01));
    const double angle = world.pose(wheel).angle;
    ASSERT_TRUE(world.step(0.01));
    EXPECT_NEAR(world.pose(wheel).angle, angle, 1e-14) << row.name;
  }
}

// A clutch of 13 N m holds a wheel against 12 N m, slips under 20, stops it again under 6, and lets it go at once where
// the load turns round: angle = -7 t^2/(2 I), its mirror image, and 5 t^2/(2 I). No part of what it gave stays. Where
// it begins to slip, RATTLE takes half of 12 N m at the start of the step and half of 13 N m at its end.
TEST(FreeEffects, AFreewheelSlipsStopsAndLetsGo) {
  constexpr double h = 0.004, I = 0.4;
  struct Part {
    double torque, angle, rate;
  };
  constexpr Part parts[] = {{-12, 0, 0}, {-20, -0.35, -3.5}, {-6, -0.7, 0}, {-6, -0.7, 0}, {5, -0.45, 2.5}};
  for (const IntegratorRow& row : integrator_rows) {
    const double bound = row.integrator == Integrator::euler ? 0.03 : 3e-3;
    World<double> world(with(row.integrator));
    const int wheel = effects::wheel(world, I);
    world.add_joint({"freewheel", {wheel, world.ground()}, {{"most", {13}}}, {}});
    for (const Part& part : parts) {
      world.set_force(wheel, {0, 0, part.torque});
      for (int n = 0; n < 50; ++n) ASSERT_TRUE(world.step(h));
      EXPECT_NEAR(world.pose(wheel).angle, part.angle, bound) << row.name << " at " << world.time() << " s";
      EXPECT_NEAR(world.velocity(wheel).w, part.rate, 1.01 * h / (2 * I)) << row.name << " at " << world.time() << " s";
    }
    const double angle = world.pose(wheel).angle, rate = world.velocity(wheel).w;
    ASSERT_TRUE(world.step(h));
    const double mean =
        row.integrator == Integrator::euler ? world.velocity(wheel).w : (rate + world.velocity(wheel).w) / 2;
    EXPECT_NEAR(world.pose(wheel).angle, angle + h * mean, 1e-12) << row.name;
  }
}

// A driven hub drags a wheel along for as long as the hub is faster; a brake stops the hub, and the wheel runs on.
TEST(FreeEffects, AFreewheelLetsGoWhenItsDriveSlows) {
  constexpr double hub_inertia = 0.3, wheel_inertia = 0.9, torque = 2.4;
  for (const IntegratorRow& row : integrator_rows) {
    World<double> world(with(row.integrator));
    const int hub = effects::wheel(world, hub_inertia), wheel = effects::wheel(world, wheel_inertia);
    world.add_joint({"freewheel", {wheel, hub}, {}, {}});
    const int motor = world.add_joint({"brake", {hub, world.ground()}, {{"torque", {1e-9}}}, {}});
    world.set_force(hub, {0, 0, torque});
    for (int n = 0; n < 100; ++n) ASSERT_TRUE(world.step(0.01));
    const double together = torque / (hub_inertia + wheel_inertia);
    EXPECT_NEAR(world.velocity(wheel).w, together, 1e-6) << row.name;
    EXPECT_NEAR(world.velocity(hub).w, together, 1e-6) << row.name;
    world.set_force(hub, {0, 0, 0});
    world.set_parameters(motor, {{"torque", {1.5}}});
    for (int n = 0; n < 100; ++n) ASSERT_TRUE(world.step(0.01));
    EXPECT_NEAR(world.velocity(wheel).w, together, 1e-6) << row.name;
    EXPECT_NEAR(world.velocity(hub).w, 0, 1e-9) << row.name;
  }
}

TEST(FreeEffects, NumbersOutOfRangeAreErrors) {
  World<double> world(with(Integrator::euler));
  const int wheel = world.add_body({.mass = 1, .inertia = 0.5});
  const int axle = revolute(world, world.ground(), wheel, 0, 0, 0, 0);
  const auto refused = [&](const SpecEffect& effect) -> std::string {
    try {
      add_effect(world, axle, "angle", effect);
    } catch (const Error& error) {
      return error.what();
    }
    return "taken";
  };
  EXPECT_EQ(refused({"motor", {{"max", {-1}}}}),
            "parameter `max` of joint `motor` is -1 [kg*m^2/any/s^2]. Likely fix: a number from 0");
  EXPECT_EQ(refused({"motor", {{"speed", {unlimited}}}}), "parameter `speed` of joint `motor` is not finite");
  EXPECT_EQ(refused({"motor", {{"max", {NAN}}}}), "parameter `max` of joint `motor` is not finite");
  EXPECT_EQ(refused({"motor", {{"max", {unlimited}}}}), "taken");
  EXPECT_EQ(refused({"friction", {}}),
            "effect `friction` needs its parameter `max` (it has no default on a coordinate)");
}

}  // namespace
}  // namespace cdot::test
