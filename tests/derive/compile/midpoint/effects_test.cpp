// Scenes with effects by forces and in time, and those that roll, compiled to the implicit midpoint rule.
#include <gtest/gtest.h>

#include "coin_implicit.hpp"
#include "effects_implicit.hpp"
#include "geared_implicit.hpp"
#include "pushed_implicit.hpp"
#include "rolling_implicit.hpp"
#include "tailgate_implicit.hpp"
#include "tests/derive/compile/beside_world.hpp"
#include "thrown_implicit.hpp"
#include "timed_joints_implicit.hpp"
#include "torsion_implicit.hpp"
#include "tumbling_implicit.hpp"

namespace {

using cdot::Integrator;
using namespace cdot::scenes;

const std::string scenes = "tests/derive/compile/scenes/";

TEST(CompiledMidpoint, MovesWithEffectsAsTheWorld) {
  const auto runs = [](auto compiled, const std::string& file) {
    cdot::runs_as_the_world<decltype(compiled)>(file, Integrator::implicit);
  };
  runs(effects_implicit<double>(), scenes + "effects.toml");
  runs(thrown_implicit<double>(), scenes + "thrown.toml");
  runs(pushed_implicit<double>(), scenes + "pushed.toml");
  runs(torsion_implicit<double>(), scenes + "torsion.toml");
  runs(geared_implicit<double>(), scenes + "geared.toml");
  runs(tumbling_implicit<double>(), scenes + "tumbling.toml");
  runs(tailgate_implicit<double>(), "specs/scenes/tailgate.toml");
}

// Rates follow the mean spin of the drift: a coin's moments of inertia differ.
TEST(CompiledMidpoint, RollsAsTheWorld) {
  cdot::runs_as_the_world<rolling_implicit<double>>(scenes + "rolling.toml", Integrator::implicit);
  cdot::runs_as_the_world<coin_implicit<double>>("specs/scenes/gallery/coin.toml", Integrator::implicit);
}

TEST(CompiledMidpoint, IsDrivenAsTheWorld) {
  cdot::runs_as_the_world<timed_joints_implicit<double>>(scenes + "timed_joints.toml", Integrator::implicit);
}

TEST(CompiledMidpoint, LanesWithEffectsAreAsAlone) { cdot::lanes_are_as_alone<effects_implicit>(); }

}  // namespace
