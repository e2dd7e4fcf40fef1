// Ends, lengths, places and rates that follow functions of time: compiled scenes move as the World does, to round-off.
#include <gtest/gtest.h>

#include "braked_rk4.hpp"
#include "clutches_euler.hpp"
#include "clutches_rk4.hpp"
#include "crossing_euler.hpp"
#include "crossing_rk4.hpp"
#include "drives_euler.hpp"
#include "drives_implicit.hpp"
#include "drives_rattle.hpp"
#include "drives_rk4.hpp"
#include "ends_dop853.hpp"
#include "ends_euler.hpp"
#include "ends_implicit.hpp"
#include "ends_rattle.hpp"
#include "ends_rk4.hpp"
#include "falling_rk4.hpp"
#include "pressing_radau5.hpp"
#include "pressing_rk4.hpp"
#include "ropes_euler.hpp"
#include "ropes_implicit.hpp"
#include "ropes_radau5.hpp"
#include "ropes_rattle.hpp"
#include "ropes_rk4.hpp"
#include "stop_implicit.hpp"
#include "tests/derive/compile/beside_world.hpp"
#include "turning_implicit.hpp"

namespace {

using cdot::Integrator;
using namespace cdot::scenes;

const std::string room = "tests/derive/compile/in_time/";
// Round-off decides the last digits of the time of an event.
constexpr double by_events = 1e-9;

// A gate that pushes, one end by a table, equal ends that lead a wheel, and ends that cross.
TEST(CompiledMoving, EndsPushAsInTheWorld) {
  const std::string ends = room + "ends.toml";
  cdot::runs_as_the_world<ends_euler<double>>(ends, Integrator::euler, 1e-11);
  cdot::runs_as_the_world<ends_rattle<double>>(ends, Integrator::rattle, 1e-11);
  cdot::runs_as_the_world<ends_implicit<double>>(ends, Integrator::implicit, 1e-11);
  cdot::runs_as_the_world<ends_rk4<double>>(ends, Integrator::rk4, 1e-11);
  cdot::runs_as_the_world<ends_dop853<double>>(ends, Integrator::dop853, 1e-11);
}

TEST(CompiledMoving, LengthsAndPlacesMoveAsInTheWorld) {
  const std::string ropes = room + "ropes.toml";
  cdot::runs_as_the_world<ropes_euler<double>>(ropes, Integrator::euler, 1e-11);
  cdot::runs_as_the_world<ropes_rattle<double>>(ropes, Integrator::rattle, 1e-11);
  cdot::runs_as_the_world<ropes_implicit<double>>(ropes, Integrator::implicit, 1e-11);
  cdot::runs_as_the_world<ropes_rk4<double>>(ropes, Integrator::rk4, by_events);
  cdot::runs_as_the_world<ropes_radau5<double>>(ropes, Integrator::radau5, by_events, 0.3);
}

TEST(CompiledMoving, RatesOfSpecsAreThoseOfTheWorld) {
  const std::string drives = room + "drives.toml";
  cdot::runs_as_the_world<drives_euler<double>>(drives, Integrator::euler, 1e-11);
  cdot::runs_as_the_world<drives_rattle<double>>(drives, Integrator::rattle, 1e-11);
  cdot::runs_as_the_world<drives_implicit<double>>(drives, Integrator::implicit, 1e-11);
  cdot::runs_as_the_world<drives_rk4<double>>(drives, Integrator::rk4, by_events);
}

// Parts of steps of 5 s have no middle: linearly implicit Euler takes them.
TEST(CompiledMoving, IsRescuedAsTheWorld) {
  cdot::runs_as_the_world<stop_implicit<double>>(room + "stop.toml", Integrator::implicit, 1e-11, 50, 5);
}

TEST(CompiledMoving, AMotorThatTurnsBackLeavesItsEnd) {
  cdot::runs_as_the_world<turning_implicit<double>>(room + "turning.toml", Integrator::implicit, 1e-11);
  turning_implicit<double>::State state;
  turning_implicit<double>::reset(state);
  for (int k = 0; k < 700; ++k) turning_implicit<double>::step(state, 0.001);
  EXPECT_NEAR(state.q[turning_implicit<double>::rod].angle, 0.3 - 2 / M_PI * (1 - std::sin(0.7 * M_PI)), 1e-4);
}

// tests/derive/compile/in_time/clutches.py: the angles by backward Euler at 2e-6 s, with the torques as sets.
template <class Clutches>
void slips_as_by_backward_euler(Integrator integrator, double within) {
  cdot::runs_as_the_world<Clutches>(room + "clutches.toml", integrator, by_events, 1.5);
  typename Clutches::State state;
  Clutches::reset(state);
  for (const auto& [t, angle] : {std::pair{0.25, 0.20794}, std::pair{0.75, 0.49522}, std::pair{1.0, 0.44142},
                                 std::pair{1.25, 0.25182}, std::pair{1.5, -0.02717}}) {
    while (state.time < t - 1e-9) Clutches::step(state, 0.001);
    EXPECT_NEAR(state.q[Clutches::rod].angle, angle, within) << t << " s";
  }
}
TEST(CompiledMoving, AMotorSlipsBesideFriction) {
  slips_as_by_backward_euler<clutches_euler<double>>(Integrator::euler, 2e-3);
  slips_as_by_backward_euler<clutches_rk4<double>>(Integrator::rk4, 1.5e-5);
}

// Friction holds the rod neither at its start nor as a program turns the motor round.
TEST(CompiledMoving, AMotorStartsAgainstFriction) {
  using Braked = braked_rk4<double>;
  Braked::State state;
  Braked::reset(state);
  for (int k = 0; k < 50; ++k) Braked::step(state, 0.01);
  EXPECT_NEAR(state.q[Braked::rod].angle, 1, 1e-9);
  state.p.hinge_angle_motor_speed = -1;
  for (int k = 0; k < 50; ++k) Braked::step(state, 0.01);
  EXPECT_NEAR(state.q[Braked::rod].angle, 0.5, 1e-9);
  EXPECT_NEAR(state.v[Braked::rod].w, -1, 1e-9);
}

// Off its ends the rod goes 2/pi sin(pi t) beyond its place at the time when the motor turned round.
template <class Pressing>
void leaves_its_ends(Integrator integrator) {
  cdot::runs_as_the_world<Pressing>(room + "pressing.toml", integrator, by_events, 3, 0.01);
  typename Pressing::State state;
  Pressing::reset(state);
  const auto expect_angle = [&](double t, double angle) {
    while (state.time < t - 1e-9) Pressing::step(state, 0.01);
    EXPECT_NEAR(state.q[Pressing::rod].angle, angle, 1e-8) << t << " s";
  };
  const double way = 2 / M_PI * (1 - std::sin(0.7 * M_PI));
  expect_angle(0.4, 0.3), expect_angle(0.7, 0.3 - way);
  expect_angle(1.4, -0.3), expect_angle(1.7, -0.3 + way);
  expect_angle(2.4, 0.3), expect_angle(2.7, 0.3 - way);
}
TEST(CompiledMoving, AMotorPressesOnItsEndsInTurn) {
  leaves_its_ends<pressing_rk4<double>>(Integrator::rk4);
  leaves_its_ends<pressing_radau5<double>>(Integrator::radau5);
}

// Between 0.46 and 0.64 s the ends -0.2 cos(4 t) and 0.1 + 0.2 cos(4 t) have crossed.
template <class Crossing>
void holds_at_the_lower_end(double within) {
  typename Crossing::State state;
  Crossing::reset(state);
  for (int k = 0; k < 600; ++k) Crossing::step(state, 0.001);
  EXPECT_NEAR(state.q[Crossing::bolt].y, -0.2 * std::cos(2.4), 1e-12);
  EXPECT_NEAR(state.v[Crossing::bolt].y, 0.8 * std::sin(2.4), within);
}
TEST(CompiledMoving, EndsThatCrossHold) {
  holds_at_the_lower_end<crossing_rk4<double>>(1e-9);
  holds_at_the_lower_end<crossing_euler<double>>(0.01);  // of first order
}

// The block passes its end before the ends cross, both within a step whose error is none.
TEST(CompiledMoving, EndsThatCrossWithinAStepHold) {
  using Falling = falling_rk4<double>;
  Falling::State state;
  Falling::reset(state);
  Falling::step(state, 0.6);
  EXPECT_NEAR(state.q[Falling::block].y, 0.2 * std::cos(2.4), 1e-9);
  EXPECT_NEAR(state.v[Falling::block].y, -0.8 * std::sin(2.4), 1e-9);
}

// The wheel goes where its equal ends lead it: 0.5 sin(2 t)^2.
TEST(CompiledMoving, EqualEndsLead) {
  using Ends = ends_rk4<double>;
  Ends::State state;
  Ends::reset(state);
  for (int k = 0; k < 700; ++k) Ends::step(state, 0.001);
  EXPECT_NEAR(state.q[Ends::wheel].angle, 0.5 * std::sin(1.4) * std::sin(1.4), 1e-12);
}

// Each row is at a bound at some time, and off it at another: but for the wheel, which is led, the haul, which pulls,
// and the friction beside an end that moves.
TEST(CompiledMoving, AreMetInTheTest) {
  const cdot::MetBounds<ends_euler<double>> ends(700, 0.001);
  for (int i = 0; i < ends_euler<double>::bounded; ++i) {
    EXPECT_EQ(ends.at_bound[i], i != ends_euler<double>::hub_angle_limit) << "end " << i;
    EXPECT_TRUE(ends.between[i]) << "end " << i;
  }
  const cdot::MetBounds<ropes_euler<double>> ropes(700, 0.001);
  for (int i = 0; i < ropes_euler<double>::bounded; ++i)
    EXPECT_TRUE(i == ropes_euler<double>::hinge_angle_friction ? ropes.at_bound[i] : ropes.between[i]) << "rope " << i;
  const cdot::MetBounds<drives_euler<double>> drives(700, 0.001);
  for (int i = 0; i < drives_euler<double>::bounded; ++i)
    EXPECT_TRUE(drives.at_bound[i] && drives.between[i]) << "drive " << i;
}

TEST(CompiledMoving, LanesAreAsAlone) {
  cdot::lanes_are_as_alone<ends_euler>();
  cdot::lanes_are_as_alone<ends_rattle>();
  cdot::lanes_are_as_alone<ropes_implicit>();
  cdot::lanes_are_as_alone<ropes_rk4>();
}

}  // namespace
