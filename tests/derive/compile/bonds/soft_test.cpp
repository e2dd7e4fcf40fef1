// Effects and soft joints that break: compiled scenes lose them in the step in which the World does. Soft gears.
#include <gtest/gtest.h>
#include <numeric>

#include "soft_alone_dop853.hpp"
#include "soft_alone_euler.hpp"
#include "soft_alone_implicit.hpp"
#include "soft_alone_radau5.hpp"
#include "soft_alone_rattle.hpp"
#include "soft_alone_rk4.hpp"
#include "soft_dop853.hpp"
#include "soft_euler.hpp"
#include "soft_gear_dop853.hpp"
#include "soft_gear_euler.hpp"
#include "soft_gear_implicit.hpp"
#include "soft_gear_radau5.hpp"
#include "soft_gear_rattle.hpp"
#include "soft_gear_rk4.hpp"
#include "soft_implicit.hpp"
#include "soft_in_space_dop853.hpp"
#include "soft_in_space_euler.hpp"
#include "soft_in_space_implicit.hpp"
#include "soft_in_space_radau5.hpp"
#include "soft_in_space_rattle.hpp"
#include "soft_in_space_rk4.hpp"
#include "soft_radau5.hpp"
#include "soft_rattle.hpp"
#include "soft_rk4.hpp"
#include "tests/derive/compile/bonds/breaks.hpp"

namespace {

using cdot::Integrator;
using namespace cdot::scenes;

// At the end all of them are broken.
template <class Scene>
void breaks_as_in_the_world(const std::string& name, Integrator integrator, double until, double step = 0.001) {
  std::vector<int> all(Scene::joints);
  std::iota(all.begin(), all.end(), 0);
  cdot::breaks_as_in_the_world<Scene>(name, integrator, all, until, step);
}

// Steps of 1/60 s are too long for the explicit ones.
TEST(CompiledBonds, SoftOnesBreakAsInTheWorld) {
  for (const double step : {0.001, 1.0 / 60}) {
    breaks_as_in_the_world<soft_euler<double>>("soft", Integrator::euler, 1.5, step);
    breaks_as_in_the_world<soft_implicit<double>>("soft", Integrator::implicit, 1.5, step);
    breaks_as_in_the_world<soft_rattle<double>>("soft", Integrator::rattle, 1.5, step);
  }
  breaks_as_in_the_world<soft_rk4<double>>("soft", Integrator::rk4, 1.5);
  breaks_as_in_the_world<soft_dop853<double>>("soft", Integrator::dop853, 1.5);
  breaks_as_in_the_world<soft_radau5<double>>("soft", Integrator::radau5, 1.5);
}

TEST(CompiledBonds, SoftOnesBreakAloneAsInTheWorld) {
  for (const double step : {0.001, 1.0 / 60}) {
    breaks_as_in_the_world<soft_alone_euler<double>>("soft_alone", Integrator::euler, 1, step);
    breaks_as_in_the_world<soft_alone_implicit<double>>("soft_alone", Integrator::implicit, 1, step);
    breaks_as_in_the_world<soft_alone_rattle<double>>("soft_alone", Integrator::rattle, 1, step);
    breaks_as_in_the_world<soft_alone_rk4<double>>("soft_alone", Integrator::rk4, 1, step);
    breaks_as_in_the_world<soft_alone_dop853<double>>("soft_alone", Integrator::dop853, 1, step);
    breaks_as_in_the_world<soft_alone_radau5<double>>("soft_alone", Integrator::radau5, 1, step);
  }
}

TEST(CompiledBonds, SoftOnesBreakInSpaceAsInTheWorld) {
  for (const double step : {0.001, 1.0 / 60}) {
    breaks_as_in_the_world<soft_in_space_euler<double>>("soft_in_space", Integrator::euler, 1, step);
    breaks_as_in_the_world<soft_in_space_implicit<double>>("soft_in_space", Integrator::implicit, 1, step);
    breaks_as_in_the_world<soft_in_space_rattle<double>>("soft_in_space", Integrator::rattle, 1, step);
    breaks_as_in_the_world<soft_in_space_radau5<double>>("soft_in_space", Integrator::radau5, 1, step);
  }
  breaks_as_in_the_world<soft_in_space_rk4<double>>("soft_in_space", Integrator::rk4, 1);
  breaks_as_in_the_world<soft_in_space_dop853<double>>("soft_in_space", Integrator::dop853, 1);
}

// On a spring that is stretched by x0 at rest at the start, m x'' = m g - k x until k x = F; then it falls.
template <class Scene>
void breaks_at_its_time() {
  constexpr double k = 60, g = 9.81, x0 = 0.1, F = 12, at_rest = g / k, until = 0.6;
  const double w = std::sqrt(k), t = std::acos((F / k - at_rest) / (x0 - at_rest)) / w, fall = until - t;
  const double v = (at_rest - x0) * w * std::sin(w * t), y = -1 + x0 - F / k - v * fall - g / 2 * fall * fall;
  typename Scene::State state;
  Scene::reset(state);
  for (int i = 0; i < 600; ++i) Scene::step(state, until / 600);
  EXPECT_NEAR(state.q[3].y, y, 1e-7);
}

TEST(CompiledBonds, SoftOnesBreakAtTheirTime) {
  breaks_at_its_time<soft_rk4<double>>();
  breaks_at_its_time<soft_dop853<double>>();
  breaks_at_its_time<soft_radau5<double>>();
}

// Where the play is used up, w1 = 2 w2; the gear keeps I1 w1 + I2 w2 / 2.
template <class Scene>
void turns_on(Integrator integrator) {
  cdot::runs_as_the_world<Scene>("tests/derive/compile/scenes/soft_gear.toml", integrator, 1e-9, 3);
  const auto state = cdot::state_after<Scene>(3000, 0.001);
  EXPECT_NEAR(state.v[0].wz, 6, 1e-8);
  EXPECT_NEAR(state.v[1].wz, 3, 1e-8);
}

TEST(CompiledGears, SoftOnesTurnOnAsInTheWorld) {
  turns_on<soft_gear_euler<double>>(Integrator::euler);
  turns_on<soft_gear_implicit<double>>(Integrator::implicit);
  turns_on<soft_gear_rattle<double>>(Integrator::rattle);
  turns_on<soft_gear_rk4<double>>(Integrator::rk4);
  turns_on<soft_gear_dop853<double>>(Integrator::dop853);
  turns_on<soft_gear_radau5<double>>(Integrator::radau5);
}

TEST(CompiledBonds, LanesOfSoftOnesAreAsAlone) {
  cdot::lanes_are_as_alone<soft_gear_rattle>();
  cdot::lanes_are_as_alone<soft_euler>();
  cdot::lanes_are_as_alone<soft_alone_implicit>();
  cdot::lanes_are_as_alone<soft_in_space_implicit>();
  cdot::lanes_are_as_alone<soft_rattle, float>();
  cdot::lanes_are_as_alone<soft_rk4>();
  cdot::lanes_are_as_alone<soft_alone_rk4, float>();
  cdot::lanes_are_as_alone<soft_in_space_dop853>();
  cdot::lanes_are_as_alone<soft_in_space_radau5>();
  cdot::snapshot_keeps<soft_implicit<double>>(0.002);
}

}  // namespace
