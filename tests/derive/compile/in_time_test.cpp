// Numbers that follow functions of time: compiled scenes move as the World does, to round-off.
#include <gtest/gtest.h>

#include "knee_dop853.hpp"
#include "knee_euler.hpp"
#include "knee_rattle.hpp"
#include "knee_rk4.hpp"
#include "tests/derive/compile/beside_world.hpp"
#include "tests/derive/compile/command.hpp"
#include "timed_bounds_euler.hpp"
#include "timed_bounds_rattle.hpp"
#include "timed_dop853.hpp"
#include "timed_euler.hpp"
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
}

}  // namespace
