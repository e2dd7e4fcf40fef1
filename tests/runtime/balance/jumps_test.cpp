// A number of a spring jumps, or the rate of a joint's: who moves it puts in the energy that appears at that moment.
#include "runtime/state/world_data.hpp"
#include "tests/methods.hpp"
#include "tests/runtime/effects/generated_effects.hpp"

namespace cdot::test {
namespace {

using effects::ball;
using effects::wheel;
using effects::with;

// A spring of 50 N/m holds a ball at rest until its rest length jumps from 1 m to 2 m: 50/2 1^2 = 25 J.
World<double> world_of_a_jump(Settings settings, double at) {
  World<double> world(settings);
  const int body = ball(world, 1, 0, 0, 0, 2);
  const Profile rest = Profile::table({.times = {0, at}, .values = {1, 2}, .interpolation = Interpolation::step});
  world.add_joint(
      {"spring", {body, world.ground()}, {{"pa", {0, 0}}, {"pb", {0, 0}}, {"k", {50}}, in_time("rest", {rest})}, {}});
  return world;
}

TEST(Jumps, OfASpringPutInItsEnergy) {
  for (const IntegratorRow& row : integrator_rows)
    for (const double at : {0.37, 0.3712}) {  // at a step's end, and within one
      World<double> world = world_of_a_jump(with(row.integrator), at);
      for (int k = 0; k < 50; ++k) ASSERT_TRUE(world.step(0.01));
      const Balance balance = world.balance();
      EXPECT_NEAR(balance.put_in, 25, 1e-9) << row.name << ", jump at " << at;
      EXPECT_NEAR(balance.taken, 0, 1e-9) << row.name << ", jump at " << at;
      EXPECT_NEAR(world.energy(), 25, row.order == 1 ? 1 : 0.05) << row.name << ", jump at " << at;
    }
}

// Runge-Kutta methods that choose their steps reject some on the way: each jump counts once.
TEST(Jumps, CountOnceBesideRejectedSteps) {
  for (const Integrator integrator : {Integrator::rk4, Integrator::dop853, Integrator::radau5}) {
    Settings settings = with(integrator);
    settings.local_error = 1e-9;
    World<double> world = world_of_a_jump(settings, 0.3712);
    for (int k = 0; k < 5; ++k) ASSERT_TRUE(world.step(0.2));
    EXPECT_NEAR(world.balance().put_in, 25, 1e-9) << name_of(integrators, integrator);
    EXPECT_NEAR(world.energy(), 25, 1e-6) << name_of(integrators, integrator);
  }
}

// A rod grows by 2 m/s between two kinks of its length, at the ends of steps and within: its mover gives 2 kg 4 J and
// takes them back.
TEST(Jumps, OfARodsRatePutInItsMotion) {
  const Profile length = Profile::table({.times = {0, 0.3, 0.8012, 2}, .values = {1, 1, 2.0024, 2.0024}});
  for (const IntegratorRow& row : integrator_rows)
    for (const double local_error : {0.0, 1e-8}) {
      if (local_error > 0 && row.level != Level::acceleration) continue;
      Settings settings = with(row.integrator);
      settings.local_error = local_error;
      World<double> world(settings);
      const int body = ball(world, 1, 0, 0, 0, 2);
      world.add_joint(
          {"distance", {world.ground(), body}, {{"pa", {0, 0}}, {"pb", {0, 0}}, in_time("l", {length})}, {}});
      BalanceWatch watch;
      for (int k = 0; k < 100; ++k) {
        ASSERT_TRUE(world.step(0.01));
        watch.look(world.balance());
        if (k == 50) {
          EXPECT_NEAR(world.balance().put_in, 4, 1e-9) << row.name;
        }
      }
      EXPECT_NEAR(world.place(body).x, 2.0024, 1e-12) << row.name;
      EXPECT_NEAR(world.energy(), 0, 1e-12) << row.name;
      EXPECT_NEAR(world.balance().put_in - world.balance().taken, 0, 1e-9) << row.name;
      EXPECT_LT(std::abs(watch.energy.amount), 1e-9) << row.name;
    }
}

// A kink within round-off of a step's end leaves no part of 1e-16 s behind: RATTLE's kicks would make speeds of the
// round-off of C.
TEST(Jumps, AtStepEndsUpToRoundOffLeaveNoSlivers) {
  const Profile length = Profile::table({.times = {0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1},
                                         .values = {1, 1.1, 1, 1.1, 1, 1.1, 1, 1.1, 1, 1.1, 1}});
  for (const Integrator integrator : {Integrator::euler, Integrator::rattle, Integrator::implicit}) {
    World<double> world(with(integrator, -9.81));
    const int body = ball(world, 1, 0);
    world.add_joint({"distance", {world.ground(), body}, {{"pa", {0, 0}}, {"pb", {0, 0}}, in_time("l", {length})}, {}});
    for (int k = 0; k < 1000; ++k) {
      ASSERT_TRUE(world.step(0.001));
      ASSERT_GT(double(world.data().last_step), 1e-6) << name_of(integrators, integrator) << ", step " << k;
    }
  }
}

// The torque on a wheel jumps at each tenth step's end, up to round-off: the sum of steps lies just before or after it.
// Accelerations kept from the end of a step belong to the torque before.
TEST(Jumps, AtStepEndsUpToRoundOffLeaveMotionsExact) {
  constexpr double h = 0.001, I = 2;
  const Profile torque = Profile::table(
      {.times = {0, 0.01, 0.02}, .values = {4, -3, 4}, .interpolation = Interpolation::step, .beyond = Beyond::repeat});
  double angle = 0, w = 0;
  for (int k = 0; k < 400; ++k) {
    const double acceleration = (k % 2 == 0 ? 4 : -3) / I, t = 10 * h;
    angle += w * t + acceleration * t * t / 2, w += acceleration * t;
  }
  for (const Integrator integrator : {Integrator::rk4, Integrator::dop853, Integrator::radau5}) {
    World<double> world(with(integrator));
    const int body = wheel(world, I);
    add_effect(world, 0, "angle", SpecEffect{"load", {in_time("push", {torque})}});
    for (int k = 0; k < 4000; ++k) ASSERT_TRUE(world.step(h));
    EXPECT_NEAR(world.place(body).angle, angle, 1e-10) << name_of(integrators, integrator);
    EXPECT_NEAR(world.velocity(body).w, w, 1e-11) << name_of(integrators, integrator);
  }
}

}  // namespace
}  // namespace cdot::test
