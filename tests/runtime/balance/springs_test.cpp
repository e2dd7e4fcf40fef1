// The balance of energy of springs: their dampers take, and a stiffness that changes with the pose puts in.
#include <cmath>
#include <fmt/core.h>

#include "tests/runtime/balance/method.hpp"
#include "tests/runtime/balance/watch.hpp"
#include "tests/runtime/spatial_support.hpp"

namespace cdot::test {
namespace {

// m x'' = -k x - c x' from x0 at rest, on a vertical slide without gravity.
TEST(Balance, ADampedSpringTakesWhatTheOscillatorLoses) {
  const double k = 9, c = 0.5, x0 = 1, duration = 2, mass = 1;
  const double rate = c / 2 / mass, w = std::sqrt(k / mass - rate * rate);
  const double x = x0 * std::exp(-rate * duration) * (std::cos(w * duration) + rate / w * std::sin(w * duration));
  const double v = -x0 * std::exp(-rate * duration) * (w + rate * rate / w) * std::sin(w * duration);
  const double lost = k * x0 * x0 / 2 - k * x * x / 2 - mass * v * v / 2;
  for (const Method& method : methods()) {
    for (bool on_coordinate : {false, true}) {
      World<double> world(method.settings());
      const int body = world.add_body({.x = 3 + x0, .mass = mass, .inertia = 1});
      if (on_coordinate) {
        const int slide = world.add_joint(
            {"prismatic", {world.ground(), body}, {{"pa", {0, 0}}, {"pb", {-3 - x0, 0}}, {"t", {0, 1}}}, {}});
        add_spring(world, slide, "slide",
                   {.softness = {.by_frequency = false, .stiffness = k, .damping = c},
                    .rest = world.coordinate(slide, "slide") - x0});
      } else {
        world.add_spring({.body_a = world.ground(), .body_b = body, .stiffness = k, .rest_length = 3, .damping = c});
      }
      const BalanceWatch seen = watch(world, duration, 1e-3);
      EXPECT_NEAR(seen.last.taken, lost, 8 * allowed(method)) << method.name() << on_coordinate;
      EXPECT_LT(seen.energy.share(), 2 * allowed(method)) << method.name() << on_coordinate;
      EXPECT_NEAR(seen.last.put_in, 0, 1e-12);
    }
  }
}

// A body of 1 kg hits a spring, whose oscillation is too fast for a step of h, which ends it. Without a damper the
// method has lost that energy. A damper of c would take the share 1 - exp(-h c / m) of it in that time; the rule of the
// step lets it take up to twice as much.
TEST(Balance, ASpringTakesNoMoreThanItsDamperDoes) {
  const double k = 1e6, h = 1.0 / 60, energy = 0.5;
  for (const double c : {0.0, 0.6, 12.0, 60.0, 1e4})
    for (const bool on_coordinate : {false, true}) {
      World<double> world({.integrator = Integrator::implicit});
      const int body = world.add_body({.x = 3, .mass = 1, .inertia = 1});
      const int slide =
          world.add_joint({"prismatic", {world.ground(), body}, {{"pa", {0, 0}}, {"pb", {-3, 0}}, {"t", {0, 1}}}, {}});
      if (on_coordinate) {
        add_spring(world, slide, "slide",
                   {.softness = {.by_frequency = false, .stiffness = k, .damping = c}, .rest = {}});
      } else {
        world.add_spring({.body_a = world.ground(), .body_b = body, .stiffness = k, .rest_length = 3, .damping = c});
      }
      world.set_velocity(body, {1, 0, 0});
      const BalanceWatch seen = watch(world, 1, h);
      const double decays = energy * (1 - std::exp(-h * c));
      fmt::print("  {:5.0f} N s/m: {:.4f} J taken, {:.4f} J by the decay, {:.4f} J left\n", c, seen.last.taken, decays,
                 world.energy());
      EXPECT_LT(world.energy(), 1e-6);
      EXPECT_LE(seen.last.taken, 2 * decays + 1e-9);
      EXPECT_GE(seen.last.taken, 0.5 * decays - 1e-9);
    }
}

// A spring given by its frequency is stiffer where its joint is heavier. Its energy then changes without a force.
TEST(Balance, ASpringByFrequencyPutsInWhatItsStiffnessChanges) {
  for (const Method& method : methods()) {
    if (method.solver == Solver::iterative || method.integrator == Integrator::implicit) continue;
    double before = 0;
    for (double h : {4e-3, 2e-3}) {
      World<double> world(method.settings(-9.81));
      const int a = world.add_body(rod(0, 0, 0)), b = world.add_body(rod(1, 0, 0));
      world.add_joint({"revolute",
                       {world.ground(), a},
                       {{"pa", {0, 0}}, {"pb", {-0.5, 0}}},
                       Softness{.by_frequency = true, .frequency = 2, .damping_ratio = 0.05}});
      const int joint = revolute(world, a, b, 0.5, 0, -0.5, 0);
      add_spring(world, joint, "angle", {.softness = {.frequency = 1, .damping_ratio = 0.1}, .rest = 0});
      const BalanceWatch seen = watch(world, 3, h);
      EXPECT_GT(std::abs(seen.last.put_in), 1) << method.name();
      const double share = seen.energy.share();
      EXPECT_LT(share, method.order() == 1 ? 0.1 : method.order() == 2 ? 1e-3 : 1e-6) << method.name();
      if (before > 0 && method.order() == 2) {
        EXPECT_NEAR(before / share, 4, 0.8) << method.name();
      }
      before = share;
    }
  }
}

// Two rods in a row hang at an end from a spring. Returns its number on joint 0. By frequency it stiffens as they turn.
int hang_rods(World<double>& world, const Softness& softness) {
  const int upper = world.add_body(rod(0, 0, 0)), lower = world.add_body(rod(1, 0, 0));
  world.add_joint({"rope", {world.ground(), upper}, {{"pa", {0, 1}}, {"pb", {-0.5, 0}}, {"l", {10}}}, {}});
  revolute(world, upper, lower, 0.5, 0, -0.5, 0);
  return add_spring(world, 0, "length", {.softness = softness, .rest = {}});
}

// The work of a stiffness that changes is booked as soon as the spring has its frequency, and after a joint has come
// back.
TEST(Balance, ASpringByFrequencyMayComeWhileItRuns) {
  const Softness by_stiffness{.by_frequency = false, .stiffness = 20}, by_frequency{.frequency = 1};
  for (const Integrator integrator : {Integrator::rattle, Integrator::rk4, Integrator::dop853}) {
    SCOPED_TRACE(name_of(integrators, integrator));
    World<double> changed(Method{integrator, Solver::direct}.settings(-9.81));
    const int spring = hang_rods(changed, by_stiffness);
    run(changed, 0.1, 1e-3);
    set_spring(changed, 0, spring, {.softness = by_frequency, .rest = 1});
    EXPECT_LT(watch(changed, 1, 1e-3).energy.share(), 1e-4);

    World<double> restored(Method{integrator, Solver::direct}.settings(-9.81));
    hang_rods(restored, by_frequency);
    run(restored, 0.1, 1e-3);
    const Snapshot whole = restored.snapshot();
    restored.remove_joint(1);
    run(restored, 0.1, 1e-3);
    restored.restore(whole);
    EXPECT_LT(watch(restored, 1, 1e-3).energy.share(), 1e-4);
    EXPECT_GT(std::abs(restored.balance().put_in), 1);
  }
}

// A body on a soft joint by frequency, with time in units of `second`.
BalanceWatch on_a_soft_joint(const std::string& joint, std::vector<NamedValue> parameters, double second) {
  Settings s;
  s.integrator = Integrator::dop853;
  SpatialWorld<double> world(s);
  SpatialBodyDefinition body{.wx = 3 / second, .wy = -2 / second, .wz = 1 / second, .mass = 1};
  body.inertia = {0.2, 0.6, 0.7, 0.05, 0, 0};
  const int top = world.add_body(body);
  world.add_joint(
      {joint, {world.ground(), top}, std::move(parameters), Softness{.by_frequency = true, .frequency = 1 / second}});
  return watch(world, 2 * second, 0.01 * second);
}

// The stiffness follows the effective mass, and with it an inertia tensor that turns with its body, however fast.
TEST(Balance, ASpringByFrequencyFollowsATurningTensor) {
  for (const double second : {1.0, 1e-5}) {
    const BalanceWatch seen = on_a_soft_joint("spherical", {{"pa", {0.3, 0.1, 0}}, {"pb", {0.3, 0, 0.2}}}, second);
    EXPECT_GT(std::abs(seen.last.put_in) * second * second, 5e-3) << second;
    EXPECT_LT(seen.energy.share(), 1e-7) << second;
  }
}

// A stretch that follows time is that of each stage.
TEST(Balance, ASpringByFrequencyFollowsADrive) {
  const BalanceWatch seen =
      on_a_soft_joint("driven", {{"pa", {0.3, 0.1, 0}}, {"pb", {0.3, 0, 0.2}}, {"fa", {0, 0, 1}}, {"rate", {4}}}, 1);
  EXPECT_GT(std::abs(seen.last.put_in), 0.01);
  EXPECT_LT(seen.energy.share(), 1e-7);
}

}  // namespace
}  // namespace cdot::test
