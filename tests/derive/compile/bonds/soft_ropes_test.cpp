// Soft ropes: compiled scenes move as the World does, slack and taut.
#include <gtest/gtest.h>

#include "elastic_ropes_euler.hpp"
#include "elastic_ropes_rattle.hpp"
#include "elastic_ropes_rk4.hpp"
#include "soft_ropes_dop853.hpp"
#include "soft_ropes_euler.hpp"
#include "soft_ropes_radau5.hpp"
#include "soft_ropes_rk4.hpp"
#include "tests/derive/compile/beside_world.hpp"

namespace {

using cdot::Integrator;
using namespace cdot::scenes;

// At the end the string is torn.
template <class Scene>
void moves_as_in_the_world(const std::string& name, Integrator integrator, double step = 0.001) {
  const std::string file = "tests/derive/compile/bonds/" + name + ".toml";
  SCOPED_TRACE(file + ", step " + std::to_string(step));
  cdot::runs_as_the_world<Scene>(file, integrator, 1e-9, 1.5, step);
  EXPECT_EQ(cdot::state_after<Scene>(int(1.5 / step), step).bonds.holds[0], 0);
}

TEST(CompiledRopes, SoftOnesMoveAsInTheWorld) {
  for (const double step : {0.001, 1.0 / 60})
    moves_as_in_the_world<soft_ropes_euler<double>>("soft_ropes", Integrator::euler, step);
  moves_as_in_the_world<soft_ropes_rk4<double>>("soft_ropes", Integrator::rk4);
  moves_as_in_the_world<soft_ropes_dop853<double>>("soft_ropes", Integrator::dop853);
  moves_as_in_the_world<soft_ropes_radau5<double>>("soft_ropes", Integrator::radau5);
}

TEST(CompiledRopes, ElasticOnesMoveAsInTheWorld) {
  moves_as_in_the_world<elastic_ropes_euler<double>>("elastic_ropes", Integrator::euler);
  moves_as_in_the_world<elastic_ropes_rattle<double>>("elastic_ropes", Integrator::rattle);
  moves_as_in_the_world<elastic_ropes_rk4<double>>("elastic_ropes", Integrator::rk4);
}

// Slack ropes do not push.
template <class Scene>
void flies_freely() {
  const auto state = cdot::state_after<Scene>(100, 0.001);
  EXPECT_NEAR(state.q[0].x, 0.03, 1e-12);
  EXPECT_NEAR(state.q[0].y, -0.5 + 3 * 0.1 - 9.81 / 2 * 0.01, 1e-12);
}

TEST(CompiledRopes, SoftOnesFlyFreelyWhereTheyAreSlack) {
  flies_freely<elastic_ropes_rattle<double>>();
  flies_freely<soft_ropes_rk4<double>>();
  flies_freely<soft_ropes_dop853<double>>();
}

// Elastic ones take no energy, but for the error of the step in which they become taut.
TEST(CompiledRopes, ElasticOnesKeepEnergy) {
  using Scene = elastic_ropes_rk4<double>;
  Scene::State state;
  Scene::reset(state);
  const double energy = Scene::energy(state);
  for (; state.time < 1.5 && state.bonds.holds[0] > 0; Scene::step(state, 0.001))
    EXPECT_NEAR(Scene::energy(state), energy, 1e-3);
  EXPECT_GT(state.time, 0.2);
}

TEST(CompiledRopes, LanesOfSoftOnesAreAsAlone) {
  cdot::lanes_are_as_alone<soft_ropes_euler>();
  cdot::lanes_are_as_alone<elastic_ropes_rattle>();
  cdot::lanes_are_as_alone<soft_ropes_rk4>();
}

}  // namespace
