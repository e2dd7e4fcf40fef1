// Joints that are inequalities: ropes that go slack and taut move as in the World.
#include <gtest/gtest.h>

#include "planar_ropes_euler.hpp"
#include "planar_ropes_rattle.hpp"
#include "planar_ropes_rk4.hpp"
#include "spatial_ropes_euler.hpp"
#include "spatial_ropes_rattle.hpp"
#include "tests/derive/compile/beside_world.hpp"

namespace {

using cdot::Integrator;
using namespace cdot::scenes;

const std::string planar = "tests/hard_cases/chattering_ropes/planar.toml",
                  spatial = "tests/hard_cases/chattering_ropes/spatial.toml";

TEST(CompiledRopes, MoveAsTheWorld) {
  cdot::runs_as_the_world<planar_ropes_euler<double>>(planar, Integrator::euler, 1e-10, 3);
  cdot::runs_as_the_world<planar_ropes_rattle<double>>(planar, Integrator::rattle, 1e-10, 3);
  cdot::runs_as_the_world<spatial_ropes_euler<double>>(spatial, Integrator::euler, 1e-11, 1);
  cdot::runs_as_the_world<spatial_ropes_rattle<double>>(spatial, Integrator::rattle, 1e-11, 1);
}

// A rope that never goes slack, or never is taut, would miss half of the test.
TEST(CompiledRopes, GoSlackAndTaut) {
  using Ropes = planar_ropes_euler<double>;
  const cdot::MetBounds<Ropes> met(3000, 0.001);
  for (int i = 0; i < Ropes::bounded; ++i) EXPECT_TRUE(met.between[i] && met.at_bound[i]) << "rope " << i;
}

TEST(CompiledRopes, LanesAreAsAlone) {
  cdot::lanes_are_as_alone<planar_ropes_euler>();
  cdot::lanes_are_as_alone<planar_ropes_rattle>();
}

// Impacts that quicken until both ropes are taut are over at 0.24 s, at 1.1 s and later.
TEST(CompiledRopes, MoveByRk4AsTheWorld) {
  cdot::runs_as_the_world<planar_ropes_rk4<double>>(planar, Integrator::rk4, 1e-9, 3);
}

}  // namespace
