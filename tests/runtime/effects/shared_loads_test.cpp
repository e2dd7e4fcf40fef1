// Brakes, pins, ropes and joints that hold one motion together: which of them breaks is the same by every method.
#include <numeric>
#include <string>
#include <vector>

#include "tests/runtime/effects/generated_effects.hpp"

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

}  // namespace
}  // namespace cdot::test
