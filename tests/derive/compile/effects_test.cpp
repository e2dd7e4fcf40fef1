// Compiled scenes with effects move as the World does, to round-off; a lane has the bits that it has alone.
#include <gtest/gtest.h>

#include "effects_dop853.hpp"
#include "effects_euler.hpp"
#include "effects_rk4.hpp"
#include "tailgate_dop853.hpp"
#include "tailgate_euler.hpp"
#include "tailgate_rk4.hpp"
#include "tests/derive/compile/beside_world.hpp"
#include "thrown_dop853.hpp"
#include "thrown_euler.hpp"
#include "thrown_rk4.hpp"

namespace {

using cdot::Integrator;
using namespace cdot::scenes;

const std::string tailgate = "specs/scenes/tailgate.toml", effects = "tests/derive/compile/scenes/effects.toml",
                  thrown = "tests/derive/compile/scenes/thrown.toml";

TEST(CompiledEffects, MoveByEulerAsTheWorld) {
  cdot::runs_as_the_world<tailgate_euler<double>>(tailgate, Integrator::euler);
  cdot::runs_as_the_world<effects_euler<double>>(effects, Integrator::euler);
  cdot::runs_as_the_world<thrown_euler<double>>(thrown, Integrator::euler);
}

TEST(CompiledEffects, MoveByRk4AsTheWorld) {
  cdot::runs_as_the_world<tailgate_rk4<double>>(tailgate, Integrator::rk4);
  cdot::runs_as_the_world<effects_rk4<double>>(effects, Integrator::rk4);
  cdot::runs_as_the_world<thrown_rk4<double>>(thrown, Integrator::rk4);
}

TEST(CompiledEffects, MoveByDop853AsTheWorld) {
  cdot::runs_as_the_world<tailgate_dop853<double>>(tailgate, Integrator::dop853);
  cdot::runs_as_the_world<effects_dop853<double>>(effects, Integrator::dop853);
  cdot::runs_as_the_world<thrown_dop853<double>>(thrown, Integrator::dop853);
}

TEST(CompiledEffects, LanesAreAsAlone) {
  cdot::lanes_are_as_alone<effects_euler>();
  cdot::lanes_are_as_alone<effects_rk4>();
  cdot::lanes_are_as_alone<tailgate_euler>();
}

}  // namespace
