// Where a joint breaks or a pin shears in equal steps, the estimate of the error sees that its force acted for too
// long.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cdot/methods.hpp>

#include "runtime/tool/run/simulate.hpp"
#include "tests/runtime/tool/support.hpp"

namespace cdot::test::release_watch_test {
namespace {

TrajectoryError estimate(const Scene& scene) {
  std::string warnings;
  return simulate(scene, {}, warnings).error;
}

Scene scene_of(const std::string& rest, Integrator integrator, double step) {
  Scene scene = read_scene("duration = 1\n[[body]]\nname = \"rod\"\nmass = 1\nshape = { rod = 1 }\n" + rest, "test");
  scene.settings.integrator = integrator, scene.step = step;
  return scene;
}

// A rod falls from level about a pin that carries m g / 4 there, and 5 m g / 2 at the bottom.
std::string rod_on_a_pin(double strength) {
  return fmt::format(
      "position = [0.5, 0]\n[[joint]]\nname = \"pin\"\ntype = \"revolute\"\nbodies = [\"world\", \"rod\"]\n"
      "at = [0, 0]\nbreaking = {}\n",
      strength);
}

void expect_told(const Scene& scene, const std::string& of) {
  const double is = true_error(scene).larger();
  const TrajectoryError said = estimate(scene);
  const double larger = std::max(said.position, said.angle);
  fmt::print("{}: off by {:.2g}, estimated {:.2g}\n", of, is, larger);
  EXPECT_GT(is, 0.005) << of;
  EXPECT_GT(larger, 0.4 * is) << of;
  EXPECT_LT(larger, 3 * is) << of;
}

TEST(ReleaseWatch, KnowsTheErrorOfBreaking) {
  for (const Integrator integrator : {Integrator::euler, Integrator::implicit, Integrator::rattle})
    for (const double strength : {5.0, 8.0, 12.0, 14.0})
      for (const double step : {0.004, 0.01})
        expect_told(scene_of(rod_on_a_pin(strength), integrator, step),
                    fmt::format("{} by {} of {} s", strength, name_of(integrators, integrator), step));
}

// It carries m g / 4 from the start on, but equal steps know that at the end of the first one alone.
TEST(ReleaseWatch, KnowsTheErrorOfALoadThatIsTooLargeFromTheStart) {
  for (const Integrator integrator : {Integrator::euler, Integrator::implicit, Integrator::rattle})
    expect_told(scene_of(rod_on_a_pin(1), integrator, 0.01), std::string(name_of(integrators, integrator)));
}

// The level rod puts m g / 2 times 1 m on three pins: 1.635 N m each, then 2.45 on two, and 4.905 on the last one. All
// shear at once, but equal steps know of each overload at the end of a step of its own.
TEST(ReleaseWatch, KnowsTheErrorOfPinsThatShearOneAfterAnother) {
  std::string pins = "position = [0.5, 0]\n";
  for (const double strength : {1.6, 2.4, 4.8})
    pins += fmt::format(
        "[[joint]]\ntype = \"revolute\"\nbodies = [\"world\", \"rod\"]\nat = [0, 0]\n"
        "angle.shear_pin = {{ strength = {} }}\n",
        strength);
  for (const Integrator integrator : {Integrator::euler, Integrator::implicit, Integrator::rattle})
    expect_told(scene_of(pins, integrator, 0.01), std::string(name_of(integrators, integrator)));
}

// The stop of the upper rod gives the lower one a blow, which shears the pin between them. The blow is no force that
// ends too late.
TEST(ReleaseWatch, TakesNoBlowForAForce) {
  for (const Integrator integrator : {Integrator::implicit, Integrator::rattle}) {
    const Scene scene = scene_of(
        "position = [0.5, 0]\n[[body]]\nname = \"lower\"\nmass = 1\nshape = { rod = 1 }\nposition = [1.5, 0]\n"
        "[[joint]]\ntype = \"revolute\"\nbodies = [\"world\", \"rod\"]\nat = [0, 0]\nangle.limit = { lower = -0.5 }\n"
        "[[joint]]\ntype = \"revolute\"\nbodies = [\"rod\", \"lower\"]\nat = [1, 0]\n"
        "angle.shear_pin = { strength = 20 }\n",
        integrator, 0.002);
    const double is = true_error(scene).larger();
    const TrajectoryError said = estimate(scene);
    fmt::print("off by {:.2g}, estimated {:.2g}\n", is, std::max(said.position, said.angle));
    EXPECT_LT(std::max(said.position, said.angle), 2 * is) << name_of(integrators, integrator);
  }
}

// Runs with steps that locate the break have no such error, nor have joints that hold.
TEST(ReleaseWatch, AddsNothingWhereNothingIsLate) {
  const Scene breaks = scene_of(rod_on_a_pin(12), Integrator::rk4, 0.01);
  EXPECT_LT(true_error(breaks).larger(), 1e-5);
  EXPECT_LT(estimate(breaks).angle, 1e-5);
  const Scene holds = scene_of(rod_on_a_pin(100), Integrator::rattle, 0.01);
  EXPECT_LT(estimate(holds).angle, 3 * true_error(holds).angle);
}

}  // namespace
}  // namespace cdot::test::release_watch_test
