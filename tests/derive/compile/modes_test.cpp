// Rows with bounds by Runge-Kutta methods: events are located in time, and compiled scenes move as the World does.
#include <gtest/gtest.h>

#include "bounds_dop853.hpp"
#include "bounds_rk4.hpp"
#include "contradicting_rk4.hpp"
#include "dry_arm_dop853.hpp"
#include "dry_arm_rk4.hpp"
#include "ends_rk4.hpp"
#include "events_dop853.hpp"
#include "events_rk4.hpp"
#include "hinges_dop853.hpp"
#include "hinges_rk4.hpp"
#include "machine_dop853.hpp"
#include "machine_rk4.hpp"
#include "robot_arm_dop853.hpp"
#include "robot_arm_rk4.hpp"
#include "sledge_dop853.hpp"
#include "sledge_rk4.hpp"
#include "stopped_rk4.hpp"
#include "strong_motors_rk4.hpp"
#include "tests/derive/compile/beside_world.hpp"
#include "timed_bounds_dop853.hpp"
#include "timed_bounds_rk4.hpp"

namespace {

using cdot::Integrator;
using cdot::runs_as_the_world;
using namespace cdot::scenes;

const std::string scenes = "tests/derive/compile/scenes/";

TEST(CompiledModes, MoveByRk4AsTheWorld) {
  runs_as_the_world<dry_arm_rk4<double>>(scenes + "dry_arm.toml", Integrator::rk4, 1e-12, 2);
  runs_as_the_world<robot_arm_rk4<double>>("specs/scenes/robot_arm.toml", Integrator::rk4, 1e-11, 1);
  runs_as_the_world<machine_rk4<double>>("specs/scenes/machine.toml", Integrator::rk4, 1e-12);
  runs_as_the_world<events_rk4<double>>(scenes + "events.toml", Integrator::rk4, 1e-11, 1.5);
  runs_as_the_world<timed_bounds_rk4<double>>(scenes + "timed_bounds.toml", Integrator::rk4, 1e-9, 1);
}

TEST(CompiledModes, MoveByDop853AsTheWorld) {
  runs_as_the_world<dry_arm_dop853<double>>(scenes + "dry_arm.toml", Integrator::dop853, 1e-12, 2);
  runs_as_the_world<robot_arm_dop853<double>>("specs/scenes/robot_arm.toml", Integrator::dop853, 1e-12, 1);
  runs_as_the_world<machine_dop853<double>>("specs/scenes/machine.toml", Integrator::dop853, 1e-12);
  runs_as_the_world<events_dop853<double>>(scenes + "events.toml", Integrator::dop853, 1e-11, 1.5);
  runs_as_the_world<timed_bounds_dop853<double>>(scenes + "timed_bounds.toml", Integrator::dop853, 1e-9, 1);
}

// An event of one mechanism shortens the strides of all in the header, of its own alone in the World. Where friction
// holds a body at an end, round-off decides whether the end pulls it back: by the resolution of events, 1e-9.
TEST(CompiledModes, OfSeveralMechanismsMoveAsTheWorldToTheResolutionOfEvents) {
  runs_as_the_world<bounds_rk4<double>>(scenes + "bounds.toml", Integrator::rk4, 1e-6, 2);
  runs_as_the_world<bounds_dop853<double>>(scenes + "bounds.toml", Integrator::dop853, 1e-6, 2);
  runs_as_the_world<hinges_rk4<double>>(scenes + "hinges.toml", Integrator::rk4, 1e-8, 1);
  runs_as_the_world<hinges_dop853<double>>(scenes + "hinges.toml", Integrator::dop853, 1e-8, 1);
  runs_as_the_world<ends_rk4<double>>(scenes + "ends.toml", Integrator::rk4, 1e-8, 1);
}

// v^2 / (2 a) in steps of a twentieth of a second: without a located event the error would be a h^2.
template <class Sledge>
void stops_where_friction_says() {
  typename Sledge::State state;
  Sledge::reset(state);
  for (int k = 0; k < 20; ++k) Sledge::step(state, 0.05);
  EXPECT_NEAR(state.q[Sledge::sledge].x, 2.0 / 3, 2e-9);
  EXPECT_NEAR(state.v[Sledge::sledge].x, 0, 1e-15);
  EXPECT_EQ(state.hold[Sledge::rail_slide_friction], 0);
  EXPECT_NEAR(state.modes.force[Sledge::rail_slide_friction], 0, 1e-12);
}

TEST(CompiledModes, StopASledgeWhereFrictionSays) {
  stops_where_friction_says<sledge_rk4<double>>();
  stops_where_friction_says<sledge_dop853<double>>();
}

// Motors without a largest torque: a limit on the same coordinate and a rope stop them.
TEST(CompiledModes, EndsStopStrongMotorsAsInTheWorld) {
  runs_as_the_world<stopped_rk4<double>>(scenes + "stopped.toml", Integrator::rk4, 1e-12);
  runs_as_the_world<strong_motors_rk4<double>>("tests/hard_cases/motor_against_limit/planar.toml", Integrator::rk4,
                                               1e-12);
}

// An angle that is given in time passes the end of a rope: no motion can meet both. Where the rope's row is off, C of
// the joints is met; the step tells of the rope. The rod's end is at most 2 m from the other end of the rope of 0.5 m,
// so no step may throw it further off.
TEST(CompiledModes, TellHowFarAnEndIsPassed) {
  using Rod = contradicting_rk4<double>;
  Rod::State state;
  Rod::reset(state);
  for (int k = 0; k < 100; ++k) EXPECT_LT(Rod::step(state), 1e-12);  // slack up to 0.168 s
  int only_told = 0;
  for (int k = 0; k < 2000; ++k) {
    const double told = Rod::step(state);
    EXPECT_GE(told, state.residual);
    ASSERT_LE(told, 1.5) << "step " << k;
    only_told += told > 0.1 && state.residual < 1e-12;
  }
  EXPECT_GT(only_told, 10);
}

// Every row of the scene is at a bound at some time, and off it at another, but for the motors that pull with all they
// have at every time.
TEST(CompiledModes, AreMetInTheTest) {
  using Scene = bounds_rk4<double>;
  const cdot::MetBounds<Scene> met(2000);
  for (int i = 0; i < Scene::bounded; ++i) {
    EXPECT_TRUE(met.at_bound[i]) << "row " << i;
    EXPECT_EQ(met.between[i], i != Scene::axle_angle_motor && i != Scene::elbow_angle_friction) << "row " << i;
  }
}

TEST(CompiledModes, ASnapshotKeepsThem) { cdot::snapshot_keeps<dry_arm_rk4<double>>(0.001); }

TEST(CompiledModes, LanesAreAsAlone) {
  cdot::lanes_are_as_alone<bounds_rk4>();
  cdot::lanes_are_as_alone<events_rk4>();
  cdot::lanes_are_as_alone<dry_arm_dop853>();
  cdot::lanes_are_as_alone<robot_arm_rk4>();
  cdot::lanes_are_as_alone<hinges_rk4>();
  cdot::lanes_are_as_alone<dry_arm_rk4, float>();
}

}  // namespace
