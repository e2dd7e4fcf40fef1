// A scene compiled to RATTLE moves as the World does, in the plane and in space, to round-off.
#include <gtest/gtest.h>

// clang-format off
#include "cantilever_rattle.hpp"
#include "chain_10_rattle.hpp"
#include "chain_10_space_rattle.hpp"
#include "coin_rattle.hpp"
#include "compound_pendulum_rattle.hpp"
#include "crank_rocker_rattle.hpp"
#include "double_pendulum_rattle.hpp"
#include "double_pendulum_space_rattle.hpp"
#include "four_bar_rattle.hpp"
#include "four_bar_space_rattle.hpp"
#include "gyroscope_space_rattle.hpp"
#include "pulley_ratio1_rattle.hpp"
#include "pulley_ratio2_rattle.hpp"
#include "rolling_rattle.hpp"
#include "simple_pendulum_rattle.hpp"
#include "slider_crank_rattle.hpp"
#include "slider_crank_space_rattle.hpp"
#include "three_bodies_space_rattle.hpp"
#include "torque_free_body_space_rattle.hpp"
// clang-format on
#include "tests/derive/compile/beside_world.hpp"

namespace {

using cdot::Integrator;
using namespace cdot::scenes;

#define CDOT_BY_RATTLE(scene) \
  cdot::runs_as_the_world<scene##_rattle<double>>("specs/scenes/" #scene ".toml", Integrator::rattle);
#define CDOT_IN_SPACE_BY_RATTLE(scene, ...)                                                                         \
  cdot::runs_as_the_world<scene##_space_rattle<double>>("specs/scenes/spatial/" #scene ".toml", Integrator::rattle, \
                                                        ##__VA_ARGS__);

TEST(CompiledRattle, MovesAsTheWorld){
    CDOT_BY_RATTLE(cantilever) CDOT_BY_RATTLE(chain_10) CDOT_BY_RATTLE(compound_pendulum) CDOT_BY_RATTLE(crank_rocker)
        CDOT_BY_RATTLE(double_pendulum) CDOT_BY_RATTLE(four_bar) CDOT_BY_RATTLE(pulley_ratio1)
            CDOT_BY_RATTLE(pulley_ratio2) CDOT_BY_RATTLE(simple_pendulum) CDOT_BY_RATTLE(slider_crank)}

TEST(CompiledRattle, MovesInSpaceAsTheWorld){
    CDOT_IN_SPACE_BY_RATTLE(chain_10) CDOT_IN_SPACE_BY_RATTLE(double_pendulum) CDOT_IN_SPACE_BY_RATTLE(four_bar)
        CDOT_IN_SPACE_BY_RATTLE(gyroscope) CDOT_IN_SPACE_BY_RATTLE(slider_crank) CDOT_IN_SPACE_BY_RATTLE(three_bodies)
            CDOT_IN_SPACE_BY_RATTLE(torque_free_body)}

// Rows of velocities repeat their forces in the first half of a step; a run starts with those at its start.
TEST(CompiledRattle, RollsAsTheWorld) {
  const std::string coin = "specs/scenes/gallery/coin.toml";
  cdot::runs_as_the_world<coin_rattle<double>>(coin, Integrator::rattle, 1e-11, 2);
  cdot::runs_as_the_world<coin_rattle<double>>(coin, Integrator::rattle, 1e-11, 2, 1.0 / 60);
  cdot::runs_as_the_world<rolling_rattle<double>>("tests/derive/compile/scenes/rolling.toml", Integrator::rattle);
}

TEST(CompiledRattle, LanesAreAsAlone) {
  cdot::lanes_are_as_alone<coin_rattle>();
  cdot::lanes_are_as_alone<slider_crank_rattle>();
  cdot::lanes_are_as_alone<chain_10_rattle, float>();
  cdot::lanes_are_as_alone<gyroscope_space_rattle>();
  cdot::lanes_are_as_alone<three_bodies_space_rattle>();
}

}  // namespace
