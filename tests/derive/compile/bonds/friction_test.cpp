// Friction that grows with what a contact or a joint carries, by impulses: compiled scenes move as the World does.
#include <gtest/gtest.h>

#include "dry_arm_euler.hpp"
#include "dry_arm_implicit.hpp"
#include "dry_arm_rattle.hpp"
#include "hanger_euler.hpp"
#include "hanger_implicit.hpp"
#include "hanger_rattle.hpp"
#include "jamming_rod_euler.hpp"
#include "jamming_rod_implicit.hpp"
#include "jamming_rod_rattle.hpp"
#include "rough_ball_euler.hpp"
#include "rough_ball_rattle.hpp"
#include "rough_pins_euler.hpp"
#include "rough_pins_implicit.hpp"
#include "rough_pins_rattle.hpp"
#include "rough_rail_euler.hpp"
#include "rough_rail_implicit.hpp"
#include "rough_rail_rattle.hpp"
#include "sledge_euler.hpp"
#include "sledge_rattle.hpp"
#include "tests/derive/compile/beside_world.hpp"

namespace {

using cdot::Integrator;
using namespace cdot::scenes;

template <class Scene>
void runs(const std::string& file, double step = 0.001, Integrator integrator = Integrator::euler) {
  cdot::runs_as_the_world<Scene>(file, integrator, 1e-11, 1, step);
}
// By the midpoint rule, in short and in long steps.
template <class Scene>
void runs_by_midpoint(const std::string& file) {
  runs<Scene>(file, 0.001, Integrator::implicit);
  runs<Scene>(file, 1.0 / 60, Integrator::implicit);
}

const std::string scenes = "tests/derive/compile/scenes/";

// Corrections of a step count in the loads of the next one: in long steps they are large.
TEST(CompiledFriction, SlipsByImpulsesAsInTheWorld) {
  runs<dry_arm_euler<double>>(scenes + "dry_arm.toml");
  runs<dry_arm_euler<double>>(scenes + "dry_arm.toml", 1.0 / 60);
  runs<rough_ball_euler<double>>(scenes + "rough_ball.toml");
  runs<rough_pins_euler<double>>(scenes + "rough_pins.toml");
  runs<rough_pins_euler<double>>(scenes + "rough_pins.toml", 1.0 / 60);
  runs<rough_rail_euler<double>>(scenes + "rough_rail.toml");
  runs<hanger_euler<double>>("tests/derive/compile/bonds/hanger.toml");
  runs<hanger_euler<double>>("tests/derive/compile/bonds/hanger.toml", 1.0 / 60);
  runs<sledge_euler<double>>(scenes + "sledge.toml");
}

TEST(CompiledFriction, JamsByImpulsesAsInTheWorld) {
  runs<jamming_rod_euler<double>>("tests/hard_cases/jamming_rod/planar.toml");
  runs<jamming_rod_euler<double>>("tests/hard_cases/jamming_rod/planar.toml", 1.0 / 60);
}

// The bounds of the middle and of the end of a step grow with its whole impulses.
TEST(CompiledFriction, SlipsInTheMiddleAsInTheWorld) {
  runs_by_midpoint<dry_arm_implicit<double>>(scenes + "dry_arm.toml");
  runs_by_midpoint<hanger_implicit<double>>("tests/derive/compile/bonds/hanger.toml");
  runs_by_midpoint<jamming_rod_implicit<double>>("tests/hard_cases/jamming_rod/planar.toml");
  runs_by_midpoint<rough_pins_implicit<double>>(scenes + "rough_pins.toml");
  runs_by_midpoint<rough_rail_implicit<double>>(scenes + "rough_rail.toml");
}

// Loads are those of the whole step; half of the friction that they allow acts at the start of the next one. The start
// of a run finds both together.
template <class Scene>
void runs_by_rattle(const std::string& file) {
  runs<Scene>(file, 0.001, Integrator::rattle);
  runs<Scene>(file, 1.0 / 60, Integrator::rattle);
}

TEST(CompiledFriction, SlipsByRattleAsInTheWorld) {
  runs_by_rattle<dry_arm_rattle<double>>(scenes + "dry_arm.toml");
  runs_by_rattle<rough_ball_rattle<double>>(scenes + "rough_ball.toml");
  runs_by_rattle<rough_pins_rattle<double>>(scenes + "rough_pins.toml");
  runs_by_rattle<rough_rail_rattle<double>>(scenes + "rough_rail.toml");
  runs_by_rattle<sledge_rattle<double>>(scenes + "sledge.toml");
}

// The hook leaves the rail, and then has no friction; it lands at 0.05 s, and sticks from 0.44 s on: there round-off
// must not grow.
TEST(CompiledFriction, LosesContactByRattleAsInTheWorld) {
  runs_by_rattle<hanger_rattle<double>>("tests/derive/compile/bonds/hanger.toml");
  runs_by_rattle<jamming_rod_rattle<double>>("tests/hard_cases/jamming_rod/planar.toml");
}

// A disc of 0.2 m rolls on a rim of 0.1 m, so I = 2 m r^2: from 2 m/s without spin it comes to 2 m/s / (1 + 2).
TEST(CompiledFriction, RollsByRattleInTheTest) {
  using Scene = rough_ball_rattle<double>;
  Scene::State state;
  Scene::reset(state);
  for (int k = 0; k < 1500; ++k) Scene::step(state, 0.001);
  EXPECT_NEAR(state.v[Scene::ball].x, 2.0 / 3, 1e-6);
  EXPECT_NEAR(state.v[Scene::ball].w, -state.v[Scene::ball].x / 0.1, 1e-6);
  EXPECT_NEAR(state.force[Scene::floor], 0.4 * 9.81, 1e-6);
}

TEST(CompiledFriction, ASnapshotKeepsLoads) {
  cdot::snapshot_keeps<rough_pins_euler<double>>(0.001);
  cdot::snapshot_keeps<rough_pins_rattle<double>>(0.001);
}

TEST(CompiledFriction, LanesAreAsAlone) {
  cdot::lanes_are_as_alone<rough_pins_euler>();
  cdot::lanes_are_as_alone<rough_pins_implicit>();
  cdot::lanes_are_as_alone<rough_pins_rattle>();
  cdot::lanes_are_as_alone<rough_ball_rattle, float>();
  cdot::lanes_are_as_alone<dry_arm_euler, float>();
}

}  // namespace
