// Friction in a plane of space, one force along two coordinates: compiled scenes move as the World does.
#include <gtest/gtest.h>

#include "puck_dop853.hpp"
#include "puck_euler.hpp"
#include "puck_implicit.hpp"
#include "puck_radau5.hpp"
#include "puck_rattle.hpp"
#include "puck_rk4.hpp"
#include "rough_foot_dop853.hpp"
#include "rough_foot_euler.hpp"
#include "rough_foot_implicit.hpp"
#include "rough_foot_radau5.hpp"
#include "rough_foot_rattle.hpp"
#include "rough_foot_rk4.hpp"
#include "rough_plate_dop853.hpp"
#include "rough_plate_euler.hpp"
#include "rough_plate_implicit.hpp"
#include "rough_plate_radau5.hpp"
#include "rough_plate_rattle.hpp"
#include "rough_plate_rk4.hpp"
#include "tests/derive/compile/beside_world.hpp"

namespace {

using cdot::Integrator;
using namespace cdot::scenes;

const std::string scenes = "tests/derive/compile/scenes/";

// In short and in long steps. `rough`: of long ones, where the rounds that find forces and loads end. The foot stops at
// 0.57 s.
template <class Puck, class Plate, class Foot>
void run(Integrator method, double rough = 1e-11, double until = 1) {
  for (const double step : {0.001, 1.0 / 60}) {
    cdot::runs_as_the_world<Puck>(scenes + "puck.toml", method, 1e-11, 1, step);
    cdot::runs_as_the_world<Plate>(scenes + "rough_plate.toml", method, 1e-11, 1, step);
    cdot::runs_as_the_world<Foot>(scenes + "rough_foot.toml", method, step > 0.01 ? rough : 1e-11, until, step);
  }
}

TEST(CompiledCones, SlipByImpulsesAsInTheWorld) {
  run<puck_euler<double>, rough_plate_euler<double>, rough_foot_euler<double>>(Integrator::euler);
}
TEST(CompiledCones, SlipInTheMiddleAsInTheWorld) {
  run<puck_implicit<double>, rough_plate_implicit<double>, rough_foot_implicit<double>>(Integrator::implicit, 1e-9);
}
// Where a foot has stopped, RATTLE's forces alternate in the World, too, and magnify round-off.
TEST(CompiledCones, SlipByRattleAsInTheWorld) {
  run<puck_rattle<double>, rough_plate_rattle<double>, rough_foot_rattle<double>>(Integrator::rattle, 1e-11, 0.5);
}
TEST(CompiledCones, SlipByForcesAsInTheWorld) {
  run<puck_rk4<double>, rough_plate_rk4<double>, rough_foot_rk4<double>>(Integrator::rk4);
  run<puck_dop853<double>, rough_plate_dop853<double>, rough_foot_dop853<double>>(Integrator::dop853);
}
// Where the foot stops, the World takes parts of a step that it chooses by its error.
TEST(CompiledCones, SlipByRadauAsInTheWorld) {
  cdot::runs_as_the_world<puck_radau5<double>>(scenes + "puck.toml", Integrator::radau5, 1e-11, 1);
  cdot::runs_as_the_world<rough_plate_radau5<double>>(scenes + "rough_plate.toml", Integrator::radau5, 1e-11, 1);
  cdot::runs_as_the_world<rough_foot_radau5<double>>(scenes + "rough_foot.toml", Integrator::radau5, 1e-11, 0.5);
}

// Nothing turns the ball about its point of contact. So it rolls with v = 5/7 v0 + 2/7 r w0 x n, of landing with
// v0 = (1, 0.5) m/s and w0 = (3, -6, 2) rad/s.
template <class Puck>
void rolls() {
  typename Puck::State state;
  Puck::reset(state);
  for (int k = 0; k < 100; ++k) Puck::step(state, 0.01);
  EXPECT_NEAR(state.v[0].x, 5.0 / 7 - 0.1 * 6 * 2 / 7, 1e-9);
  EXPECT_NEAR(state.v[0].y, 0.5 * 5 / 7 - 0.1 * 3 * 2 / 7, 1e-9);
  EXPECT_NEAR(state.v[0].x, 0.1 * state.v[0].wy, 1e-9);
  EXPECT_NEAR(state.v[0].y, -0.1 * state.v[0].wx, 1e-9);
}
TEST(CompiledCones, RollByEachMethod) {
  rolls<puck_euler<double>>();
  rolls<puck_implicit<double>>();
  rolls<puck_rattle<double>>();
  rolls<puck_rk4<double>>();
  rolls<puck_dop853<double>>();
  rolls<puck_radau5<double>>();
}

TEST(CompiledCones, LanesAreAsAlone) {
  cdot::lanes_are_as_alone<rough_plate_euler>();
  cdot::lanes_are_as_alone<rough_plate_implicit>();
  cdot::lanes_are_as_alone<rough_plate_rattle, float>();
  cdot::lanes_are_as_alone<rough_plate_rk4>();
  cdot::lanes_are_as_alone<rough_foot_dop853, float>();
}

TEST(CompiledCones, ASnapshotKeepsDirections) {
  cdot::snapshot_keeps<rough_plate_euler<double>>(0.001);
  cdot::snapshot_keeps<rough_plate_rk4<double>>(0.001);
}

}  // namespace
