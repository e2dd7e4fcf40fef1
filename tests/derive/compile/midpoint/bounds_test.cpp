// Scenes with motors, limits, friction, ropes and events, compiled to the implicit midpoint rule.
#include <gtest/gtest.h>

#include "bounds_implicit.hpp"
#include "ends_implicit.hpp"
#include "events_implicit.hpp"
#include "hinges_implicit.hpp"
#include "robot_arm_implicit.hpp"
#include "ropes_implicit.hpp"
#include "tests/derive/compile/beside_world.hpp"
#include "tethers_implicit.hpp"
#include "timed_bounds_implicit.hpp"

namespace {

using cdot::Integrator;
using namespace cdot::scenes;

const std::string scenes = "tests/derive/compile/scenes/";

template <class Scene>
void runs(const std::string& file, double until, double step = 0.001) {
  cdot::runs_as_the_world<Scene>(file, Integrator::implicit, 1e-11, until, step);
}

// Motors keep to the bounds of the middle of a step, ends act on its end.
TEST(CompiledMidpoint, MovesWithinBoundsAsTheWorld) {
  runs<bounds_implicit<double>>(scenes + "bounds.toml", 2);
  runs<ends_implicit<double>>(scenes + "ends.toml", 1.5);
  runs<hinges_implicit<double>>(scenes + "hinges.toml", 1.5);
  runs<robot_arm_implicit<double>>("specs/scenes/robot_arm.toml", 0.7);
  runs<tethers_implicit<double>>(scenes + "tethers.toml", 1.5);
  runs<timed_bounds_implicit<double>>(scenes + "timed_bounds.toml", 1.5);
}

TEST(CompiledMidpoint, MovesInLongStepsWithinBoundsAsTheWorld) {
  runs<bounds_implicit<double>>(scenes + "bounds.toml", 2, 1.0 / 60);
  runs<ends_implicit<double>>(scenes + "ends.toml", 1.5, 1.0 / 60);
  runs<tethers_implicit<double>>(scenes + "tethers.toml", 1.5, 0.05);
  runs<ropes_implicit<double>>("tests/hard_cases/chattering_ropes/spatial.toml", 1, 1.0 / 60);
}

// Parts of steps of 3 s have no middle: linearly implicit Euler takes them.
TEST(CompiledMidpoint, IsRescuedWithinBoundsAsTheWorld) { runs<ends_implicit<double>>(scenes + "ends.toml", 60, 3); }

TEST(CompiledMidpoint, MeetsEventsAsTheWorld) { runs<events_implicit<double>>(scenes + "events.toml", 1.5); }

TEST(CompiledMidpoint, MeetsBoundsInTheTest) {
  using Scene = bounds_implicit<double>;
  const cdot::MetBounds<Scene> met(2000, 0.001);
  for (int i = 0; i < Scene::bounded; ++i) {
    EXPECT_TRUE(met.at_bound[i]) << "row " << i;
    EXPECT_EQ(met.between[i], i != Scene::axle_angle_motor) << "row " << i;
  }
}

// At rest a motor of 60 N that pushes a lift of 3 kg against its stop leaves it the rest.
TEST(CompiledMidpoint, TellsTheForcesOfBounds) {
  using Scene = bounds_implicit<double>;
  Scene::State state;
  Scene::reset(state);
  for (int k = 0; k < 2000; ++k) Scene::step(state, 0.001);
  EXPECT_NEAR(std::abs(state.force[Scene::shaft_slide_motor]), 60, 1e-9);
  EXPECT_NEAR(std::abs(state.force[Scene::shaft_slide_motor] + state.force[Scene::shaft_slide_limit]), 3 * 9.81, 1e-9);
}

TEST(CompiledMidpoint, SnapshotsKeepBounds) {
  cdot::snapshot_keeps<events_implicit<double>>(0.001);
  cdot::snapshot_keeps<bounds_implicit<double>>(0.001);
}

TEST(CompiledMidpoint, LanesWithinBoundsAreAsAlone) {
  cdot::lanes_are_as_alone<bounds_implicit>();
  cdot::lanes_are_as_alone<ends_implicit>();
  cdot::lanes_are_as_alone<robot_arm_implicit, float>();
}

}  // namespace
