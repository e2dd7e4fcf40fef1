// Compiled scenes with motors, limits, friction, brakes, contacts and drives move by Euler's steps as the World does.
#include <gtest/gtest.h>

#include "bounds_euler.hpp"
#include "ends_euler.hpp"
#include "machine_euler.hpp"
#include "robot_arm_euler.hpp"
#include "tests/derive/compile/beside_world.hpp"
#include "tethers_euler.hpp"

namespace {

using cdot::Integrator;
using namespace cdot::scenes;

TEST(CompiledBounds, MoveAsTheWorld) {
  cdot::runs_as_the_world<machine_euler<double>>("specs/scenes/machine.toml", Integrator::euler);
  cdot::runs_as_the_world<robot_arm_euler<double>>("specs/scenes/robot_arm.toml", Integrator::euler);
  cdot::runs_as_the_world<bounds_euler<double>>("tests/derive/compile/scenes/bounds.toml", Integrator::euler, 1e-10, 2);
}

TEST(CompiledBounds, AreCorrectedAsInTheWorld) {
  const std::string scenes = "tests/derive/compile/scenes/";
  cdot::runs_as_the_world<ends_euler<double>>(scenes + "ends.toml", Integrator::euler);
  cdot::runs_as_the_world<tethers_euler<double>>(scenes + "tethers.toml", Integrator::euler, 1e-11, 1);
}

// Every row of the scene is at a bound at some time, and off it at another: else the tests above would miss it. The
// rotor's motor pulls with all it has at every time.
TEST(CompiledBounds, AreMetInTheTest) {
  using Scene = bounds_euler<double>;
  const cdot::MetBounds<Scene> met(2000);
  for (int i = 0; i < Scene::bounded; ++i) {
    EXPECT_TRUE(met.at_bound[i]) << "row " << i;
    EXPECT_EQ(met.between[i], i != Scene::axle_angle_motor) << "row " << i;
  }
}

TEST(CompiledBounds, LanesAreAsAlone) {
  cdot::lanes_are_as_alone<bounds_euler>();
  cdot::lanes_are_as_alone<ends_euler>();
  cdot::lanes_are_as_alone<robot_arm_euler>();
}

}  // namespace
