// Rows that begin or end to act at an event: a latch, a switch, a time. Compiled scenes move as the World does.
#include <gtest/gtest.h>

#include "events_euler.hpp"
#include "events_rattle.hpp"
#include "tests/derive/compile/beside_world.hpp"

namespace {

using cdot::Integrator;
using namespace cdot::scenes;

const std::string events = "tests/derive/compile/scenes/events.toml";

// By RATTLE an event makes its own mechanism start anew: the lift, which rests on its limit, goes on.
TEST(CompiledEvents, MoveAsTheWorld) {
  cdot::runs_as_the_world<events_euler<double>>(events, Integrator::euler, 1e-10, 1.5);
  cdot::runs_as_the_world<events_rattle<double>>(events, Integrator::rattle, 1e-11, 1.5);
}

TEST(CompiledEvents, HappenInTheTest) {
  using Scene = events_euler<double>;
  Scene::State state;
  Scene::reset(state);
  EXPECT_EQ(state.events.acts[Scene::hinge_angle_latch], 0);
  EXPECT_EQ(state.events.acts[Scene::rail_slide_limit_switch], 1);
  EXPECT_EQ(state.events.acts[Scene::hub_angle_timed_motor], 0);
  while (state.time < 0.5) Scene::step(state, 0.001);
  EXPECT_EQ(state.events.acts[Scene::rail_slide_limit_switch], 0);
  EXPECT_EQ(state.events.acts[Scene::hub_angle_timed_motor], 1);
  while (state.time < 1.5) Scene::step(state, 0.001);
  EXPECT_EQ(state.events.acts[Scene::hinge_angle_latch], 1);
  EXPECT_NEAR(state.q[Scene::gate].angle, 80 * 3.14159265358979 / 180, 1e-9);
  EXPECT_EQ(state.events.acts[Scene::hub_angle_timed_motor], 0);
}

TEST(CompiledEvents, ASnapshotKeepsThem) {
  using Scene = events_euler<double>;
  Scene::State kept = cdot::snapshot_keeps<Scene>(0.001);
  Scene::reset(kept);
  EXPECT_EQ(kept.events.acts[Scene::hub_angle_timed_motor], 0);
}

TEST(CompiledEvents, LanesAreAsAlone) {
  cdot::lanes_are_as_alone<events_euler>();
  cdot::lanes_are_as_alone<events_rattle>();
}

}  // namespace
