// Bounds that grow with a load: friction of pins, rails and contacts, mostly by Runge-Kutta methods.
#include <cmath>
#include <gtest/gtest.h>

#include "jamming_rod_rk4.hpp"
#include "rough_ball_dop853.hpp"
#include "rough_ball_rk4.hpp"
#include "rough_elbow_implicit.hpp"
#include "rough_elbow_rattle.hpp"
#include "rough_pins_dop853.hpp"
#include "rough_pins_rk4.hpp"
#include "rough_rail_dop853.hpp"
#include "rough_rail_rk4.hpp"
#include "tests/derive/compile/beside_world.hpp"
#include "very_rough_pin_euler.hpp"
#include "very_rough_pin_implicit.hpp"
#include "very_rough_pin_rattle.hpp"
#include "very_rough_pin_rk4.hpp"

namespace {

using cdot::Integrator;
using cdot::runs_as_the_world;
using namespace cdot::scenes;

const std::string scenes = "tests/derive/compile/scenes/";

TEST(CompiledLoads, MoveAsTheWorld) {
  runs_as_the_world<rough_ball_rk4<double>>(scenes + "rough_ball.toml", Integrator::rk4, 1e-12, 1);
  runs_as_the_world<rough_ball_dop853<double>>(scenes + "rough_ball.toml", Integrator::dop853, 1e-12, 1);
  runs_as_the_world<rough_pins_rk4<double>>(scenes + "rough_pins.toml", Integrator::rk4, 1e-11, 2);
  runs_as_the_world<rough_pins_dop853<double>>(scenes + "rough_pins.toml", Integrator::dop853, 1e-11, 2);
  runs_as_the_world<rough_rail_rk4<double>>(scenes + "rough_rail.toml", Integrator::rk4, 1e-12, 2);
}

// A motor starts by a blow, and an end takes one. The World is tested by methods that locate blows:
// LoadedEffects.TakeTheirShareOfABlowOnce.
TEST(CompiledLoads, TakeTheirShareOfABlowOnce) {
  const std::string elbow = scenes + "rough_elbow.toml";
  for (const double step : {4e-4, 2.5e-4, 1e-4}) {
    runs_as_the_world<rough_elbow_rattle<double>>(elbow, Integrator::rattle, 1e-10, 0.3, step);
    runs_as_the_world<rough_elbow_implicit<double>>(elbow, Integrator::implicit, 1e-10, 0.3, step);
  }
}

// Two loads solve for the pin. The World takes the least one, and is tested by a closed form in
// LoadedEffects.ARodOnAVeryRoughPinHasTheSmallerOfTwoLoads; with the other one the rod is 0.013 rad/s slower at the
// end.
TEST(CompiledLoads, TakeTheLeastOfTwo) {
  const std::string pin = scenes + "very_rough_pin.toml";
  runs_as_the_world<very_rough_pin_euler<double>>(pin, Integrator::euler, 1e-12, 0.01, 1e-4);
  runs_as_the_world<very_rough_pin_implicit<double>>(pin, Integrator::implicit, 1e-12, 0.01, 1e-4);
  runs_as_the_world<very_rough_pin_rattle<double>>(pin, Integrator::rattle, 1e-12, 0.01, 1e-4);
  runs_as_the_world<very_rough_pin_rk4<double>>(pin, Integrator::rk4, 1e-12, 0.01, 1e-4);
  cdot::lanes_are_as_alone<very_rough_pin_rk4>();
}

// The sledge slides v^2 / (2 mu g). The ball takes mu times the impulse of its landing, then slips until it rolls:
// about its point of contact nothing turns it, and its inertia is 2 m r^2. Of 2 m/s a third remains.
template <template <class> class Rail, template <class> class Ball>
void slides_as_coulomb_says() {
  typename Rail<double>::State rail;
  Rail<double>::reset(rail);
  for (int k = 0; k < 40; ++k) Rail<double>::step(rail, 0.05);
  EXPECT_NEAR(rail.q[0].x, 4 / (2 * 0.2 * 9.81), 3e-9);
  EXPECT_NEAR(rail.v[0].x, 0, 1e-12);
  typename Ball<double>::State ball;
  Ball<double>::reset(ball);
  for (int k = 0; k < 40; ++k) Ball<double>::step(ball, 0.05);
  EXPECT_NEAR(ball.v[0].x, 2.0 / 3, 1e-8);
  EXPECT_NEAR(ball.q[0].y, 0.1, 1e-12);
  EXPECT_NEAR(ball.modes.force[0], 0.4 * 9.81, 1e-9);
  EXPECT_NEAR(ball.modes.load[1], 0.4 * 9.81, 1e-9);
}

TEST(CompiledLoads, SlideAsCoulombSays) {
  slides_as_coulomb_says<rough_rail_rk4, rough_ball_rk4>();
  slides_as_coulomb_says<rough_rail_dop853, rough_ball_dop853>();
}

// Its end, 2 m below and 1 m beside the centre, stops at once. About this end nothing turns the rod: 8 kg m^2/s remain,
// with 5/3 + 5 kg m^2.
TEST(CompiledLoads, StopARodThatJamsAtOnce) {
  jamming_rod_rk4<double>::State state;
  jamming_rod_rk4<double>::reset(state);
  jamming_rod_rk4<double>::step(state, 1e-7);
  EXPECT_NEAR(state.v[0].w, -8 / (20.0 / 3), 1e-6);
  EXPECT_NEAR(state.v[0].x + 2 * state.v[0].w, 0, 1e-6);
  for (int k = 0; k < 30; ++k) jamming_rod_rk4<double>::step(state, 1.0 / 60);
  EXPECT_NEAR(jamming_rod_rk4<double>::energy(state), 0.5 * 64 / (20.0 / 3), 1e-5);  // that of the start is kinetic
}

TEST(CompiledLoads, LanesAreAsAlone) {
  cdot::lanes_are_as_alone<rough_pins_rk4>();
  cdot::lanes_are_as_alone<rough_ball_dop853>();
}

}  // namespace
