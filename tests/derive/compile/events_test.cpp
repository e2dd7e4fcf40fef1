// Rows that begin or end to act at an event: a latch, a switch, a time. Compiled scenes move as the World does.
#include <gtest/gtest.h>

#include "events_euler.hpp"
#include "events_rattle.hpp"
#include "late_ends_euler.hpp"
#include "late_ends_implicit.hpp"
#include "late_ends_radau5.hpp"
#include "late_ends_rattle.hpp"
#include "late_ends_rk4.hpp"
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

// Runge-Kutta methods meet the event within a step, which tells that an end is passed. The next one moves the bodies.
template <class Scene>
void tells_as_the_world(const std::string& file, Integrator integrator) {
  auto world = cdot::world_of(cdot::read_scene(std::string(CDOT_SOURCE_DIR) + "/" + file), integrator);
  typename Scene::State state;
  Scene::reset(state);
  int told = 0;
  for (int k = 0; k < 700; ++k) {
    ASSERT_TRUE(world.step(0.001));
    const double by = Scene::step(state, 0.001);
    EXPECT_NEAR(by, world.worst_passed_end().by, 1e-8);
    EXPECT_LT(cdot::distance<Scene>(state, world), 1e-10);
    told += by > 1e-3;
  }
  EXPECT_EQ(told, 2);
}

// A step that closed such an end on its way would throw the bodies: a bob at 0.06 rad from it by 60 rad/s.
TEST(CompiledEvents, EndsThatArePassedAsTheyBeginThrowNoBody) {
  const std::string scene = "tests/derive/compile/scenes/late_ends.toml";
  cdot::runs_as_the_world<late_ends_euler<double>>(scene, Integrator::euler, 1e-10);
  cdot::runs_as_the_world<late_ends_implicit<double>>(scene, Integrator::implicit, 1e-10);
  cdot::runs_as_the_world<late_ends_rattle<double>>(scene, Integrator::rattle, 1e-10);
  tells_as_the_world<late_ends_rk4<double>>(scene, Integrator::rk4);
  tells_as_the_world<late_ends_radau5<double>>(scene, Integrator::radau5);
}

TEST(CompiledEvents, LanesAreAsAlone) {
  cdot::lanes_are_as_alone<events_euler>();
  cdot::lanes_are_as_alone<events_rattle>();
  cdot::lanes_are_as_alone<late_ends_rattle>();
  cdot::lanes_are_as_alone<late_ends_rk4>();
}

}  // namespace
