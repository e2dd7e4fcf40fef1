// A scene compiled to Radau IIA moves as the World does, to round-off; with fifth order, and at any stiffness.
#include <gtest/gtest.h>

#include "bounds_radau5.hpp"
#include "chain_10_radau5.hpp"
#include "crank_rocker_radau5.hpp"
#include "double_pendulum_dop853.hpp"
#include "double_pendulum_radau5.hpp"
#include "dry_arm_radau5.hpp"
#include "events_radau5.hpp"
#include "geared_radau5.hpp"
#include "gyroscope_radau5.hpp"
#include "machine_radau5.hpp"
#include "overdamped_radau5.hpp"
#include "robot_arm_radau5.hpp"
#include "rolling_radau5.hpp"
#include "slider_crank_radau5.hpp"
#include "tabled_radau5.hpp"
#include "tailgate_radau5.hpp"
#include "tests/derive/compile/beside_world.hpp"
#include "three_bodies_radau5.hpp"
#include "timed_joints_radau5.hpp"
#include "torsion_radau5.hpp"

namespace {

using namespace cdot::scenes;

const std::string scenes = "tests/derive/compile/scenes/", catalogue = "specs/scenes/";

template <class Compiled>
void runs(const std::string& file, double within = 1e-11, double until = 0.7, double step = 0.001) {
  cdot::runs_as_the_world<Compiled>(file, cdot::Integrator::radau5, within, until, step);
}

TEST(CompiledRadau, MovesAsTheWorld) {
  runs<chain_10_radau5<double>>(catalogue + "chain_10.toml");
  runs<crank_rocker_radau5<double>>(catalogue + "crank_rocker.toml");
  runs<double_pendulum_radau5<double>>(catalogue + "double_pendulum.toml", 1e-11, 2, 0.02);
  runs<slider_crank_radau5<double>>(catalogue + "slider_crank.toml");
}

TEST(CompiledRadau, MovesInSpaceAsTheWorld) {
  runs<gyroscope_radau5<double>>(catalogue + "spatial/gyroscope.toml");
  runs<three_bodies_radau5<double>>(catalogue + "spatial/three_bodies.toml");
  runs<rolling_radau5<double>>(scenes + "rolling.toml");
  runs<torsion_radau5<double>>(scenes + "torsion.toml");
  runs<geared_radau5<double>>(scenes + "geared.toml");
}

TEST(CompiledRadau, MovesWithEffectsAndBoundsAsTheWorld) {
  runs<tailgate_radau5<double>>(catalogue + "tailgate.toml");
  runs<machine_radau5<double>>(catalogue + "machine.toml");
  runs<robot_arm_radau5<double>>(catalogue + "robot_arm.toml", 1e-11, 1);
  runs<dry_arm_radau5<double>>(scenes + "dry_arm.toml", 1e-11, 2);
  runs<events_radau5<double>>(scenes + "events.toml", 1e-11, 1.5);
}

TEST(CompiledRadau, IsDrivenAsTheWorld) {
  runs<timed_joints_radau5<double>>(scenes + "timed_joints.toml");
  runs<tabled_radau5<double>>(scenes + "tabled.toml", 1e-9);
}

// Where a bob is after a second, in steps of h.
template <class Pendulum>
double end_of(double h) {
  typename Pendulum::State state;
  Pendulum::reset(state);
  for (int k = 0; k < static_cast<int>(std::lround(1 / h)); ++k) Pendulum::step(state, h);
  return state.q[1].x;
}

TEST(CompiledRadau, HasFifthOrder) {
  const double exact = end_of<double_pendulum_dop853<double>>(0.001);
  const double coarse = std::abs(end_of<double_pendulum_radau5<double>>(0.05) - exact);
  const double fine = std::abs(end_of<double_pendulum_radau5<double>>(0.025) - exact);
  EXPECT_GT(coarse, 1e-9);
  EXPECT_NEAR(std::log2(coarse / fine), 5, 0.3);
}

// At rest m g / k below the end of the spring, in steps 25 times as long as explicit methods may take.
TEST(CompiledRadau, CalmsAStiffSpring) {
  using Weight = overdamped_radau5<double>;
  Weight::State state;
  Weight::reset(state);
  for (int k = 0; k < 60; ++k) EXPECT_LT(Weight::step(state, 0.05), 1e-12);
  EXPECT_NEAR(state.q[0].y, -1 - 9.81e-4, 1e-12);
  EXPECT_NEAR(state.v[0].y, 0, 1e-12);
  runs<overdamped_radau5<double>>(scenes + "overdamped.toml", 1e-12, 1, 0.05);
}

// A step that no sixteenth of it settles: the State stays, and the answer says so.
TEST(CompiledRadau, SaysThatItDoesNotSettle) {
  using Pendulum = double_pendulum_radau5<double>;
  Pendulum::State state;
  Pendulum::reset(state);
  const double x = state.q[0].x, angle = state.q[0].angle;
  EXPECT_EQ(Pendulum::step(state, 1e4), 1e30);
  EXPECT_EQ(state.time, 0);
  EXPECT_EQ(state.q[0].x, x);
  EXPECT_EQ(state.q[0].angle, angle);
}

TEST(CompiledRadau, LanesAreAsAlone) {
  cdot::lanes_are_as_alone<slider_crank_radau5>();
  cdot::lanes_are_as_alone<double_pendulum_radau5, float>();
  cdot::lanes_are_as_alone<three_bodies_radau5>();
  cdot::lanes_are_as_alone<bounds_radau5>();
}

TEST(CompiledRadau, ASnapshotKeepsIt) { cdot::snapshot_keeps<chain_10_radau5<double>>(0.001); }

}  // namespace
