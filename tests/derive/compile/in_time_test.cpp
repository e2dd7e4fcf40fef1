// Numbers that follow functions of time: compiled scenes move as the World does, to round-off.
#include <gtest/gtest.h>

#include "jump_euler.hpp"
#include "jump_rattle.hpp"
#include "knee_dop853.hpp"
#include "knee_euler.hpp"
#include "knee_rattle.hpp"
#include "knee_rk4.hpp"
#include "tabled_dop853.hpp"
#include "tabled_euler.hpp"
#include "tabled_rattle.hpp"
#include "tabled_rk4.hpp"
#include "tests/derive/compile/beside_world.hpp"
#include "tests/derive/compile/command.hpp"
#include "timed_bounds_euler.hpp"
#include "timed_bounds_rattle.hpp"
#include "timed_dop853.hpp"
#include "timed_euler.hpp"
#include "timed_joints_dop853.hpp"
#include "timed_joints_euler.hpp"
#include "timed_joints_rattle.hpp"
#include "timed_joints_rk4.hpp"
#include "timed_rattle.hpp"
#include "timed_rk4.hpp"

namespace {

using cdot::Integrator;
using namespace cdot::scenes;

const std::string scenes = "tests/derive/compile/scenes/", knee = "specs/scenes/gallery/knee.toml";

TEST(CompiledInTime, NumbersFollowExpressions) {
  cdot::runs_as_the_world<timed_euler<double>>(scenes + "timed.toml", Integrator::euler);
  cdot::runs_as_the_world<timed_rattle<double>>(scenes + "timed.toml", Integrator::rattle);
  cdot::runs_as_the_world<timed_rk4<double>>(scenes + "timed.toml", Integrator::rk4);
  cdot::runs_as_the_world<timed_dop853<double>>(scenes + "timed.toml", Integrator::dop853);
}

TEST(CompiledInTime, BoundsFollowExpressions) {
  cdot::runs_as_the_world<timed_bounds_euler<double>>(scenes + "timed_bounds.toml", Integrator::euler, 1e-10, 2);
  cdot::runs_as_the_world<timed_bounds_rattle<double>>(scenes + "timed_bounds.toml", Integrator::rattle, 1e-10, 2);
}

TEST(CompiledInTime, StrongMotorsFollowExpressions) {
  cdot::runs_as_the_world<knee_euler<double>>(knee, Integrator::euler);
  cdot::runs_as_the_world<knee_rattle<double>>(knee, Integrator::rattle);
  cdot::runs_as_the_world<knee_rk4<double>>(knee, Integrator::rk4);
  cdot::runs_as_the_world<knee_dop853<double>>(knee, Integrator::dop853);
}

// Linear with a kink and a jump, in steps that repeat, and a spline; steps end where the method would lose its order.
TEST(CompiledInTime, NumbersFollowTables) {
  cdot::runs_as_the_world<tabled_euler<double>>(scenes + "tabled.toml", Integrator::euler, 1e-10, 1.2);
  cdot::runs_as_the_world<tabled_rattle<double>>(scenes + "tabled.toml", Integrator::rattle, 1e-10, 1.2);
  cdot::runs_as_the_world<tabled_rk4<double>>(scenes + "tabled.toml", Integrator::rk4, 1e-10, 1.2);
  cdot::runs_as_the_world<tabled_dop853<double>>(scenes + "tabled.toml", Integrator::dop853, 1e-10, 1.2);
}

// The jump lies between two steps of 1/60 s, and on the end of one of 1 ms.
TEST(CompiledInTime, StepsEndAtJumps) {
  const std::string jump = "tests/hard_cases/table_with_a_jump/planar.toml";
  cdot::runs_as_the_world<jump_euler<double>>(jump, Integrator::euler, 1e-10, 6, 1.0 / 60);
  cdot::runs_as_the_world<jump_rattle<double>>(jump, Integrator::rattle, 1e-10, 6, 1.0 / 60);
  cdot::runs_as_the_world<jump_euler<double>>(jump, Integrator::euler, 1e-10, 2.5);
}

// Their steps end at jumps of their own.
TEST(CompiledInTime, LanesHaveTheirOwnTimes) {
  using Lanes = tabled_rattle<cdot::Pack<double, 4>>;
  using Alone = tabled_rattle<double>;
  Lanes::State together;
  Alone::State alone[4];
  Lanes::reset(together);
  for (int lane = 0; lane < 4; ++lane) {
    Alone::reset(alone[lane]);
    alone[lane].time = 0.0307 * lane, together.time.set(lane, 0.0307 * lane);
    Alone::begin(alone[lane]);
  }
  Lanes::begin(together);
  for (int k = 0; k < 300; ++k) {
    Lanes::step(together);
    for (int lane = 0; lane < 4; ++lane) {
      Alone::step(alone[lane]);
      ASSERT_EQ(together.q[0].angle[lane], alone[lane].q[0].angle) << "lane " << lane << ", step " << k;
      ASSERT_EQ(together.time[lane], alone[lane].time) << "lane " << lane << ", step " << k;
    }
  }
  EXPECT_NE(together.q[0].angle[0], together.q[0].angle[3]);
}

// A snapshot is a copy of the State, its time among it.
TEST(CompiledInTime, ASnapshotGoesOnFromItsTime) {
  using Knee = knee_rk4<double>;
  Knee::State first, kept;
  Knee::reset(first);
  for (int k = 0; k < 300; ++k) Knee::step(first);
  std::memcpy(&kept, &first, sizeof first);
  for (int k = 0; k < 200; ++k) Knee::step(first);
  for (int k = 0; k < 200; ++k) Knee::step(kept);
  EXPECT_EQ(std::memcmp(first.q, kept.q, sizeof first.q), 0);
  Knee::reset(kept);
  EXPECT_EQ(kept.time, 0);
}

TEST(CompiledInTime, LanesAreAsAlone) {
  cdot::lanes_are_as_alone<timed_rattle>();
  cdot::lanes_are_as_alone<timed_rk4>();
  cdot::lanes_are_as_alone<timed_euler>();
  cdot::lanes_are_as_alone<tabled_rk4>();
}

TEST(CompiledInTime, NumbersOfJointsFollowExpressions) {
  const std::string joints = scenes + "timed_joints.toml";
  cdot::runs_as_the_world<timed_joints_euler<double>>(joints, Integrator::euler);
  cdot::runs_as_the_world<timed_joints_rattle<double>>(joints, Integrator::rattle);
  cdot::runs_as_the_world<timed_joints_rk4<double>>(joints, Integrator::rk4);
  cdot::runs_as_the_world<timed_joints_dop853<double>>(joints, Integrator::dop853);
}

// Functions of time belong to the scene that has written them.
TEST(CompiledInTime, AreThoseOfTheirScene) {
  const auto read = [](const char* scene) { return cdot::read_scene(std::string(CDOT_SOURCE_DIR) + "/" + scene); };
  (void)read("tests/derive/compile/scenes/timed.toml");  // has others
  const cdot::Scene timed = read("tests/derive/compile/scenes/timed_bounds.toml"),
                    pushed = read("specs/scenes/chain_10.toml");
  ASSERT_EQ(timed.profiles.size(), 4u);
  EXPECT_TRUE(pushed.profiles.empty());
  for (const cdot::WrittenProfile& one : timed.profiles) {
    EXPECT_EQ(cdot::written_profile(timed, one.profile), &one);
    EXPECT_FALSE(one.text.empty());
    EXPECT_EQ(cdot::written_profile(pushed, one.profile), nullptr);
  }
}

}  // namespace
