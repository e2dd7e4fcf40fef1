// A scene compiled to the implicit midpoint rule moves as the World does, to round-off: in parts where a step is too
// long.
#include <gtest/gtest.h>

// clang-format off
#include "ball_and_chain_planar_implicit.hpp"
#include "ball_and_chain_spatial_implicit.hpp"
#include "cantilever_implicit.hpp"
#include "chain_10_implicit.hpp"
#include "chain_10_space_implicit.hpp"
#include "compound_pendulum_implicit.hpp"
#include "crank_rocker_implicit.hpp"
#include "double_pendulum_implicit.hpp"
#include "double_pendulum_space_implicit.hpp"
#include "four_bar_implicit.hpp"
#include "four_bar_space_implicit.hpp"
#include "gyroscope_space_implicit.hpp"
#include "heavy_load_planar_beads_implicit.hpp"
#include "heavy_load_planar_implicit.hpp"
#include "heavy_load_spatial_beads_implicit.hpp"
#include "pulley_ratio1_implicit.hpp"
#include "pulley_ratio2_implicit.hpp"
#include "simple_pendulum_implicit.hpp"
#include "slider_crank_implicit.hpp"
#include "slider_crank_space_implicit.hpp"
#include "three_bodies_space_implicit.hpp"
#include "torque_free_body_space_implicit.hpp"
// clang-format on
#include "tests/derive/compile/beside_world.hpp"

namespace {

using cdot::Integrator;
using namespace cdot::scenes;

#define CDOT_BY_MIDPOINT(scene) \
  cdot::runs_as_the_world<scene##_implicit<double>>("specs/scenes/" #scene ".toml", Integrator::implicit)
#define CDOT_IN_SPACE_BY_MIDPOINT(scene) \
  cdot::runs_as_the_world<scene##_space_implicit<double>>("specs/scenes/spatial/" #scene ".toml", Integrator::implicit)

TEST(CompiledMidpoint, MovesAsTheWorld) {
  CDOT_BY_MIDPOINT(cantilever);
  CDOT_BY_MIDPOINT(chain_10);
  CDOT_BY_MIDPOINT(compound_pendulum);
  CDOT_BY_MIDPOINT(crank_rocker);
  CDOT_BY_MIDPOINT(double_pendulum);
  CDOT_BY_MIDPOINT(four_bar);
  CDOT_BY_MIDPOINT(pulley_ratio1);
  CDOT_BY_MIDPOINT(pulley_ratio2);
  CDOT_BY_MIDPOINT(simple_pendulum);
  CDOT_BY_MIDPOINT(slider_crank);
}

TEST(CompiledMidpoint, MovesInSpaceAsTheWorld) {
  CDOT_IN_SPACE_BY_MIDPOINT(chain_10);
  CDOT_IN_SPACE_BY_MIDPOINT(double_pendulum);
  CDOT_IN_SPACE_BY_MIDPOINT(four_bar);
  CDOT_IN_SPACE_BY_MIDPOINT(gyroscope);
  CDOT_IN_SPACE_BY_MIDPOINT(slider_crank);
  CDOT_IN_SPACE_BY_MIDPOINT(three_bodies);
  CDOT_IN_SPACE_BY_MIDPOINT(torque_free_body);
}

const std::string cases = "tests/hard_cases/";

// Light chains under heavy loads at 60 steps a second: rounds of Newton without the stiffness of tension would fail.
TEST(CompiledMidpoint, MovesUnderHeavyLoadsAsTheWorld) {
  cdot::runs_as_the_world<heavy_load_planar_implicit<double>>(cases + "heavy_load/planar.toml", Integrator::implicit,
                                                              1e-9, 2, 1.0 / 60);
  cdot::runs_as_the_world<ball_and_chain_planar_implicit<double>>(cases + "ball_and_chain/planar.toml",
                                                                  Integrator::implicit, 1e-9, 2, 1.0 / 60);
  cdot::runs_as_the_world<ball_and_chain_spatial_implicit<double>>(cases + "ball_and_chain/spatial.toml",
                                                                   Integrator::implicit, 1e-9, 2, 1.0 / 60);
}

// A taut bar couples the displacements of two beads. Without its stiffness between them a step goes in more parts.
TEST(CompiledMidpoint, MovesBeadsOnTautBarsAsTheWorld) {
  cdot::runs_as_the_world<heavy_load_planar_beads_implicit<double>>(cases + "heavy_load/planar_beads.toml",
                                                                    Integrator::implicit, 1e-9, 2, 1.0 / 60);
  cdot::runs_as_the_world<heavy_load_spatial_beads_implicit<double>>(cases + "heavy_load/spatial_beads.toml",
                                                                     Integrator::implicit, 1e-9, 2, 1.0 / 60);
}

TEST(CompiledMidpoint, LanesAreAsAlone) {
  cdot::lanes_are_as_alone<heavy_load_planar_beads_implicit>();
  cdot::lanes_are_as_alone<slider_crank_implicit>();
  cdot::lanes_are_as_alone<chain_10_implicit, float>();
  cdot::lanes_are_as_alone<three_bodies_space_implicit>();
}

}  // namespace
