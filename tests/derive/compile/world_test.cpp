// A compiled scene moves as the World does, to round-off.
#include <gtest/gtest.h>

#include "tests/derive/compile/beside_world.hpp"

#define CDOT_EACH_SCENE(X, method) \
  X(cantilever, method)            \
  X(chain_10, method)              \
  X(compound_pendulum, method)     \
  X(crank_rocker, method)          \
  X(double_pendulum, method)       \
  X(four_bar, method)              \
  X(pulley_ratio1, method)         \
  X(pulley_ratio2, method)         \
  X(simple_pendulum, method)

// clang-format off
#include "cantilever_dop853.hpp"
#include "cantilever_euler.hpp"
#include "cantilever_rk4.hpp"
#include "chain_10_dop853.hpp"
#include "chain_10_euler.hpp"
#include "chain_10_rk4.hpp"
#include "compound_pendulum_dop853.hpp"
#include "compound_pendulum_euler.hpp"
#include "compound_pendulum_rk4.hpp"
#include "crank_rocker_dop853.hpp"
#include "crank_rocker_euler.hpp"
#include "crank_rocker_rk4.hpp"
#include "double_pendulum_dop853.hpp"
#include "double_pendulum_euler.hpp"
#include "double_pendulum_rk4.hpp"
#include "four_bar_dop853.hpp"
#include "four_bar_euler.hpp"
#include "four_bar_rk4.hpp"
#include "pulley_ratio1_dop853.hpp"
#include "pulley_ratio1_euler.hpp"
#include "pulley_ratio1_rk4.hpp"
#include "pulley_ratio2_dop853.hpp"
#include "pulley_ratio2_euler.hpp"
#include "pulley_ratio2_rk4.hpp"
#include "simple_pendulum_dop853.hpp"
#include "simple_pendulum_euler.hpp"
#include "simple_pendulum_rk4.hpp"
#include "slider_crank_dop853.hpp"
#include "slider_crank_euler.hpp"
#include "slider_crank_rk4.hpp"
#include "unturned_euler.hpp"
#include "unturned_rattle.hpp"
// clang-format on

namespace {

using cdot::Integrator;

#define CDOT_RUN(scene, method) \
  runs_as_the_world<cdot::scenes::scene##_##method<double>>("specs/scenes/" #scene ".toml", Integrator::method);

// The World stops Newton at 1e-13, which changes velocities by 1e-10 in a step. Its slider crank at 150 rad/s is 1.1e-9
// away from one that goes on to 1e-16.
TEST(CompiledScene, MovesByEulerAsTheWorld) {
  CDOT_EACH_SCENE(CDOT_RUN, euler)
  const char* const crank = "specs/scenes/slider_crank.toml";
  runs_as_the_world<cdot::scenes::slider_crank_euler<double>>(crank, Integrator::euler, 1e-10, 0.05);
  runs_as_the_world<cdot::scenes::slider_crank_euler<double>>(crank, Integrator::euler, 2e-9);
}

// K is 0 for the rows that hold angles.
TEST(CompiledScene, OfBodiesThatCannotTurnMovesAsTheWorld) {
  const char* const scene = "tests/derive/compile/scenes/unturned.toml";
  runs_as_the_world<cdot::scenes::unturned_euler<double>>(scene, Integrator::euler);
  runs_as_the_world<cdot::scenes::unturned_rattle<double>>(scene, Integrator::rattle);
}

TEST(CompiledScene, MovesByRk4AsTheWorld){CDOT_EACH_SCENE(CDOT_RUN, rk4) CDOT_RUN(slider_crank, rk4)}

TEST(CompiledScene, MovesByDop853AsTheWorld) {
  CDOT_EACH_SCENE(CDOT_RUN, dop853) CDOT_RUN(slider_crank, dop853)
}

}  // namespace
