// Effects of specs on the coordinates of joints: they move as the same effects between bodies do.
#include <cmath>
#include <fmt/format.h>

#include "tests/runtime/effects/generated_effects.hpp"

namespace cdot::test {
namespace {

using effects::with;

struct Numbers {
  const char* effect;
  std::vector<NamedValue> parameters;
};

const Numbers of_turns[] = {
    {"servo", {{"target", {0.4}}, {"k", {5}}, {"d", {0.3}}, {"most", {2}}}},
    {"position_drive", {{"target", {0.4}}, {"k", {5}}, {"d", {0.3}}, {"most", {1}}}},
    {"torsion_spring", {{"k", {5}}, {"d", {0.3}}}},
    {"dc_motor", {{"stall", {2}}, {"idle", {4}}}},
    {"induction_motor", {{"synchronous", {4}}, {"pull_out", {2}}, {"pull_out_slip", {0.2}}}},
    {"bearing_friction", {{"most", {0.5}}, {"creep", {0.8}}}},
    {"detent", {{"count", {4}}, {"most", {0.6}}, {"d", {0.1}}}},
    {"brake", {{"torque", {0.6}}}},
    {"air_brake", {{"torque", {0.6}}, {"rise", {0.3}}}},
    {"freewheel", {{"most", {0.6}}}},
    {"spindle", {{"speed", {2}}, {"ramp", {0.2}}, {"most", {3}}}},
    {"backlash", {{"play", {0.5}}}},
};

// Of what points of both bodies have between them, at 1 m from each other.
const Numbers of_ways[] = {
    {"duffing_spring", {{"k", {5}}, {"k3", {2}}, {"rest", {0.8}}}},
    {"bungee", {{"k", {5}}, {"rest", {0.8}}}},
    {"soft_stop", {{"least", {1.2}}, {"k", {5}}}},
    {"gas_spring", {{"F", {3}}, {"rest", {1}}}},
    {"linear_actuator", {{"k", {5}}, {"rest", {1}}, {"stroke", {0.2}}, {"omega", {2}}}},
    {"conveyor", {{"speed", {0.7}}, {"most", {1.5}}}},
    {"press_fit", {{"c", {4}}}},
    {"end_stops", {{"lower", {0.6}}, {"upper", {1.3}}}},
};

bool has_parameter(const std::string& effect, std::string_view name) {
  for (const ParameterInfo& info : find_joint_type(Dimension::planar, effect)->parameters)
    if (info.name == name) return true;
  return false;
}

std::vector<NamedValue> known(const Numbers& numbers) {
  std::vector<NamedValue> values;
  for (const NamedValue& value : numbers.parameters)
    if (has_parameter(numbers.effect, value.name)) values.push_back(value);
  EXPECT_EQ(values.size(), numbers.parameters.size()) << numbers.effect;
  return values;
}

// A wheel on its axle, under a torque; the angle of a revolute is that of its second body.
template <class Add>
std::pair<double, double> turn_of(Integrator integrator, const Add& add) {
  World<double> world(with(integrator));
  const int wheel = world.add_body({.w = -1.5, .mass = 1, .inertia = 0.5, .torque = 0.2});
  const int axle = revolute(world, world.ground(), wheel, 0, 0, 0, 0);
  add(world, axle, wheel);
  for (int n = 0; n < 100; ++n) EXPECT_TRUE(world.step(0.01));
  return {world.pose(wheel).angle, world.velocity(wheel).w};
}

TEST(CoordinateEffects, OnAnAngleActAsBetweenItsBodies) {
  for (const Numbers& numbers : of_turns) {
    for (const IntegratorRow& row : integrator_rows) {
      const auto own = turn_of(row.integrator, [&](World<double>& world, int, int wheel) {
        world.add_joint({numbers.effect, {wheel, world.ground()}, known(numbers), {}});
      });
      const auto on_angle = turn_of(row.integrator, [&](World<double>& world, int axle, int) {
        add_effect(world, axle, "angle", SpecEffect{numbers.effect, known(numbers)});
      });
      const auto without = turn_of(row.integrator, [](World<double>&, int, int) {});
      EXPECT_NEAR(on_angle.first, own.first, 1e-9) << numbers.effect << ", " << row.name;
      EXPECT_NEAR(on_angle.second, own.second, 1e-9) << numbers.effect << ", " << row.name;
      EXPECT_GT(std::abs(without.second - own.second), 1e-3) << numbers.effect << " does nothing";
    }
  }
}

// A slide along x, at x = 1.
template <class Add>
std::pair<double, double> way_of(Integrator integrator, const Add& add) {
  World<double> world(with(integrator));
  const int slide = world.add_body({.x = 1, .vx = 0.9, .mass = 2, .inertia = 1});
  const int rail =
      world.add_joint({"prismatic", {slide, world.ground()}, {{"pa", {0, 0}}, {"pb", {0, 0}}, {"t", {0, 1}}}, {}});
  add(world, rail, slide);
  for (int n = 0; n < 100; ++n) EXPECT_TRUE(world.step(0.01));
  return {world.pose(slide).x, world.velocity(slide).x};
}

TEST(CoordinateEffects, OnASlideActAsBetweenPoints) {
  for (const Numbers& numbers : of_ways) {
    for (const IntegratorRow& row : integrator_rows) {
      const auto own = way_of(row.integrator, [&](World<double>& world, int, int slide) {
        std::vector<NamedValue> values = known(numbers);
        values.push_back({"pa", {0, 0}}), values.push_back({"pb", {0, 0}});
        if (has_parameter(numbers.effect, "t")) values.push_back({"t", {1, 0}});
        world.add_joint({numbers.effect, {slide, world.ground()}, values, {}});
      });
      double sign = 0;
      const auto on_slide = way_of(row.integrator, [&](World<double>& world, int rail, int) {
        sign = world.coordinate(rail, "slide");
        add_effect(world, rail, "slide", SpecEffect{numbers.effect, known(numbers)});
      });
      ASSERT_NEAR(sign, 1, 1e-12);
      EXPECT_NEAR(on_slide.first, own.first, 1e-9) << numbers.effect << ", " << row.name;
      EXPECT_NEAR(on_slide.second, own.second, 1e-9) << numbers.effect << ", " << row.name;
    }
  }
}

TEST(CoordinateEffects, OnAHingeInSpaceActAsOnAPinInThePlane) {
  for (const Numbers& numbers : of_turns) {
    const auto in_plane = turn_of(Integrator::dop853, [&](World<double>& world, int axle, int) {
      add_effect(world, axle, "angle", SpecEffect{numbers.effect, known(numbers)});
    });
    SpatialWorld<double> world(with(Integrator::dop853));
    SpatialBodyDefinition d;
    d.wx = -1.5, d.mass = 1, d.inertia = {0.5, 0.7, 0.7}, d.torque_x = 0.2;
    const int wheel = world.add_body(d);
    const int hinge = world.add_joint(
        {"hinge", {world.ground(), wheel}, {{"pa", {0, 0, 0}}, {"fa", {1, 0, 0}}, {"pb", {0, 0, 0}}}, {}});
    add_effect(world, hinge, "angle", SpecEffect{numbers.effect, known(numbers)});
    for (int n = 0; n < 100; ++n) ASSERT_TRUE(world.step(0.01));
    EXPECT_NEAR(world.velocity(wheel).wx, in_plane.second, 1e-9) << numbers.effect;
  }
}

TEST(CoordinateEffects, TakeOtherNumbersInARun) {
  World<double> world(with(Integrator::rk4));
  const int wheel = world.add_body({.mass = 1, .inertia = 0.5, .torque = 0.5});
  const int axle = revolute(world, world.ground(), wheel, 0, 0, 0, 0);
  const int brake = add_effect(world, axle, "angle", SpecEffect{"brake", {{"torque", {0.7}}}});
  run(world, 1, 0.01);
  EXPECT_NEAR(world.velocity(wheel).w, 0, 1e-12);
  set_effect(world, axle, brake, SpecEffect{"brake", {{"torque", {0.3}}}});
  run(world, 1, 0.01);
  EXPECT_NEAR(world.velocity(wheel).w, 0.2 / 0.5, 1e-9);
  EXPECT_THROW(set_effect(world, axle, brake, SpecEffect{"servo", {{"k", {1}}}}), Error);
  EXPECT_THROW(set_effect(world, axle, brake, SpecEffect{"brake", {{"torque", {-1}}}}), Error);
}

std::string refusal(const SpecEffect& effect, const char* joint = "revolute", const char* coordinate = "angle") {
  World<double> world(with(Integrator::euler));
  const int body = world.add_body({.x = 1, .mass = 1, .inertia = 1});
  std::vector<NamedValue> values = {{"pa", {0, 0}}, {"pb", {0, 0}}};
  if (std::string_view(joint) == "prismatic") values.push_back({"t", {0, 1}});
  const int number = world.add_joint({joint, {body, world.ground()}, values, {}});
  try {
    add_effect(world, number, coordinate, effect);
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

TEST(CoordinateEffects, WrongUsesAreRefused) {
  EXPECT_EQ(refusal({"drag", {}}), "there is no effect `drag` for the coordinate of a joint");
  EXPECT_EQ(refusal({"brake", {{"torque", {1}}}}, "prismatic", "slide"),
            "effect `brake` acts on a coordinate in rad; `slide` of joint `prismatic` is in m");
  EXPECT_EQ(refusal({"servo", {{"k", {1}}}}),
            "effect `servo` needs its parameter `most` (it has no default on a coordinate)");
  EXPECT_EQ(refusal({"press_fit", {{"c", {1}}, {"t", {1, 0}}}}, "prismatic", "slide"),
            "parameter `t` of effect `press_fit` has no meaning on the coordinate of a joint: leave it out");
  EXPECT_EQ(
      refusal({"end_stops", {{"lower", {2}}, {"upper", {1}}}}, "prismatic", "slide"),
      "effect `end_stops` has bounds from 2 to 1: the lower one must not lie above the upper one (lower = 2, upper "
      "= 1)");
  EXPECT_EQ(refusal({"brake", {{"torque", {1}}}}), "");
  EXPECT_EQ(refusal({"gas_spring", {{"F", {2}}, {"rest", {-1}}}}, "prismatic", "slide"),
            "effect `gas_spring` has no finite force and energy here (F = 2, rest = -1, kappa = 1.4). Likely fix: the "
            "sign of a parameter, or another place at the start");
}

// By default the target is the angle that the joint has.
TEST(CoordinateEffects, AServoHoldsWhatItFinds) {
  World<double> world(with(Integrator::rk4));
  const int arm = world.add_body({.angle = 0.3, .mass = 1, .inertia = 0.5});
  const int axle = revolute(world, world.ground(), arm, 0, 0, 0, 0);
  add_effect(world, axle, "angle", SpecEffect{"servo", {{"k", {5}}, {"most", {2}}}});
  run(world, 1, 0.01);
  EXPECT_NEAR(world.pose(arm).angle, 0.3, 1e-12);
}

}  // namespace
}  // namespace cdot::test
