// Contacts between round bodies and a sheet between three: impacts with friction, rolling, and an effect of three
// bodies.
#include <gtest/gtest.h>

#include "balls_implicit.hpp"
#include "balls_rattle.hpp"
#include "balls_rk4.hpp"
#include "round_implicit.hpp"
#include "round_rattle.hpp"
#include "round_rk4.hpp"
#include "tests/derive/compile/beside_world.hpp"

namespace {

using cdot::Integrator;
using cdot::runs_as_the_world;
using namespace cdot::scenes;

TEST(CompiledRound, MovesAsTheWorld) {
  const std::string file = "tests/derive/compile/scenes/round.toml";
  runs_as_the_world<round_implicit<double>>(file, Integrator::implicit, 1e-11, 0.5);
  runs_as_the_world<round_rattle<double>>(file, Integrator::rattle, 1e-11, 0.5);
  runs_as_the_world<round_rk4<double>>(file, Integrator::rk4, 1e-9, 0.5);  // both locate impacts to a resolution
}

TEST(CompiledRound, MovesAsTheWorldInSpace) {
  const std::string file = "tests/derive/compile/scenes/balls.toml";
  runs_as_the_world<balls_implicit<double>>(file, Integrator::implicit, 1e-11, 0.5);
  runs_as_the_world<balls_rattle<double>>(file, Integrator::rattle, 1e-11, 0.5);
  runs_as_the_world<balls_rk4<double>>(file, Integrator::rk4, 1e-9, 0.5);  // both locate impacts to a resolution
}

TEST(CompiledRound, LanesAreAsAlone) {
  cdot::lanes_are_as_alone<round_rattle>();
  cdot::lanes_are_as_alone<balls_rattle>();
}

}  // namespace
