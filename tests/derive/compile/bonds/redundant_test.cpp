// Joints that break beside redundant ones: compiled scenes share loads as the World does.
#include <gtest/gtest.h>

#include "redundant_dop853.hpp"
#include "redundant_euler.hpp"
#include "redundant_implicit.hpp"
#include "redundant_in_space_dop853.hpp"
#include "redundant_in_space_euler.hpp"
#include "redundant_in_space_implicit.hpp"
#include "redundant_in_space_radau5.hpp"
#include "redundant_in_space_rattle.hpp"
#include "redundant_in_space_rk4.hpp"
#include "redundant_radau5.hpp"
#include "redundant_rattle.hpp"
#include "redundant_rk4.hpp"
#include "tests/derive/compile/bonds/breaks.hpp"

namespace {

using cdot::breaks_as_in_the_world;
using cdot::Integrator;
using namespace cdot::scenes;

TEST(CompiledBonds, BreakBesideRedundantOnesAsInTheWorld) {
  const std::vector<int> broken = {0, 1, 2, 3, 4};
  breaks_as_in_the_world<redundant_euler<double>>("redundant", Integrator::euler, broken, 1.1);
  breaks_as_in_the_world<redundant_implicit<double>>("redundant", Integrator::implicit, broken, 1.1);
  breaks_as_in_the_world<redundant_rattle<double>>("redundant", Integrator::rattle, broken, 1.1);
  breaks_as_in_the_world<redundant_rk4<double>>("redundant", Integrator::rk4, broken, 1.1);
  breaks_as_in_the_world<redundant_dop853<double>>("redundant", Integrator::dop853, broken, 1.1);
  breaks_as_in_the_world<redundant_radau5<double>>("redundant", Integrator::radau5, {3, 4}, 0.69);
}

// A beam on pins at x = -1, 0.5 and 1 from its centre: the least sum of squares with sum f = m g and sum f x = 0.
template <class Scene>
void shares_its_weight() {
  typename Scene::State state;
  Scene::reset(state);
  Scene::step(state, 1e-7);
  constexpr double weight = 4 * 9.81, b = -weight / 13, a = (weight - b / 2) / 3;
  EXPECT_EQ(state.bonds.holds[3], 0) << a - b;
  EXPECT_GT(a - b, 16);
  EXPECT_NEAR(state.bonds.load[3], a - b, 1e-5);
}

TEST(CompiledBonds, ShareTheWeightOfABeam) {
  shares_its_weight<redundant_euler<double>>();
  shares_its_weight<redundant_implicit<double>>();
  shares_its_weight<redundant_rattle<double>>();
}

TEST(CompiledBonds, LanesBesideRedundantOnesAreAsAlone) {
  cdot::lanes_are_as_alone<redundant_euler>();
  cdot::lanes_are_as_alone<redundant_implicit>();
  cdot::lanes_are_as_alone<redundant_rattle>();
  cdot::lanes_are_as_alone<redundant_rk4>();
  cdot::lanes_are_as_alone<redundant_radau5>();
}

TEST(CompiledBonds, BreakBesideRedundantOnesInSpaceAsInTheWorld) {
  const std::vector<int> broken = {0};
  breaks_as_in_the_world<redundant_in_space_euler<double>>("redundant_in_space", Integrator::euler, broken, 1);
  breaks_as_in_the_world<redundant_in_space_implicit<double>>("redundant_in_space", Integrator::implicit, broken, 1);
  breaks_as_in_the_world<redundant_in_space_rattle<double>>("redundant_in_space", Integrator::rattle, broken, 1);
  breaks_as_in_the_world<redundant_in_space_rk4<double>>("redundant_in_space", Integrator::rk4, broken, 1);
  breaks_as_in_the_world<redundant_in_space_dop853<double>>("redundant_in_space", Integrator::dop853, broken, 1);
  breaks_as_in_the_world<redundant_in_space_radau5<double>>("redundant_in_space", Integrator::radau5, broken, 1);
}

}  // namespace
