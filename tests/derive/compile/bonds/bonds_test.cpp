// Joints that break: compiled scenes lose them in the step in which the World does.
#include <gtest/gtest.h>

#include "bonds_implicit.hpp"
#include "tests/derive/compile/beside_world.hpp"

namespace {

using cdot::Integrator;
using namespace cdot::scenes;

const std::string bonds = "tests/derive/compile/scenes/bonds.toml";

TEST(CompiledBonds, BreakAsInTheWorld) {
  cdot::runs_as_the_world<bonds_implicit<double>>(bonds, Integrator::implicit, 1e-11, 2);
  cdot::runs_as_the_world<bonds_implicit<double>>(bonds, Integrator::implicit, 1e-11, 2, 1.0 / 60);
}

// The chain loses its last link first, the door leaves its frame with all that acts on its angle. Where two joints
// carry too much, only the one breaks that is further beyond its strength.
TEST(CompiledBonds, BreakInTheTest) {
  using Scene = bonds_implicit<double>;
  Scene::State state;
  Scene::reset(state);
  double broke[6] = {};
  while (state.time < 2) {
    Scene::step(state, 0.001);
    for (int k = 0; k < 6; ++k)
      if (broke[k] == 0 && state.bonds.holds[k] == 0) broke[k] = state.time;
  }
  for (int k = 0; k < 4; ++k) EXPECT_GT(broke[k], 0.05) << k;
  EXPECT_EQ(broke[5], 0.001);
  EXPECT_EQ(broke[4], 0);
  EXPECT_LT(broke[1], broke[0]);
  const double spin = state.v[Scene::door].w, w = state.q[Scene::door].angle;
  Scene::step(state, 0.001);
  EXPECT_EQ(state.v[Scene::door].w, spin);
  EXPECT_NEAR(state.q[Scene::door].angle, w + 0.001 * spin, 1e-12);
  EXPECT_EQ(state.hold[Scene::hinge_angle_motor] * state.force[Scene::hinge_angle_motor], 0);
}

// The load of a pendulum at rest is its weight.
TEST(CompiledBonds, TellTheirLoads) {
  using Scene = bonds_implicit<double>;
  Scene::State state;
  Scene::reset(state);
  state.q[Scene::weight].x = 3, state.q[Scene::weight].y = -0.55;
  state.v[Scene::weight] = {0, 0, 0};
  Scene::begin(state);
  for (int k = 0; k < 100; ++k) Scene::step(state, 0.001);
  EXPECT_NEAR(state.bonds.load[3], 3 * 9.81, 1e-9);
  EXPECT_EQ(state.bonds.holds[3], 1);
}

TEST(CompiledBonds, ASnapshotKeepsThem) {
  const auto kept = cdot::snapshot_keeps<bonds_implicit<double>>(0.002);
  EXPECT_EQ(kept.bonds.holds[0], 0);
}

TEST(CompiledBonds, LanesAreAsAlone) { cdot::lanes_are_as_alone<bonds_implicit>(); }

}  // namespace
