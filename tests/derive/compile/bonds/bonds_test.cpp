// Joints that break: compiled scenes lose them in the step in which the World does, and pins that shear.
#include <gtest/gtest.h>

#include "blows_dop853.hpp"
#include "blows_euler.hpp"
#include "blows_implicit.hpp"
#include "blows_radau5.hpp"
#include "blows_rattle.hpp"
#include "blows_rk4.hpp"
#include "bonds_dop853.hpp"
#include "bonds_euler.hpp"
#include "bonds_implicit.hpp"
#include "bonds_in_space_dop853.hpp"
#include "bonds_in_space_euler.hpp"
#include "bonds_in_space_implicit.hpp"
#include "bonds_in_space_radau5.hpp"
#include "bonds_in_space_rattle.hpp"
#include "bonds_in_space_rk4.hpp"
#include "bonds_radau5.hpp"
#include "bonds_rattle.hpp"
#include "bonds_rk4.hpp"
#include "everything_dop853.hpp"
#include "everything_euler.hpp"
#include "everything_implicit.hpp"
#include "everything_radau5.hpp"
#include "everything_rattle.hpp"
#include "everything_rk4.hpp"
#include "latched_dop853.hpp"
#include "latched_rattle.hpp"
#include "latched_rk4.hpp"
#include "links_dop853.hpp"
#include "links_euler.hpp"
#include "links_implicit.hpp"
#include "links_radau5.hpp"
#include "links_rattle.hpp"
#include "links_rk4.hpp"
#include "pins_dop853.hpp"
#include "pins_euler.hpp"
#include "pins_implicit.hpp"
#include "pins_radau5.hpp"
#include "pins_rattle.hpp"
#include "pins_rk4.hpp"
#include "tests/derive/compile/beside_world.hpp"

namespace {

using cdot::Integrator;
using namespace cdot::scenes;

const std::string scenes = "tests/derive/compile/bonds/";

// Loads are those of whole steps, corrections among them. In long steps corrections are large.
template <class Scene>
void breaks_as_in_the_world(const std::string& file, Integrator integrator) {
  cdot::runs_as_the_world<Scene>(scenes + file, integrator, 1e-10, 2);
  cdot::runs_as_the_world<Scene>(scenes + file, integrator, 1e-10, 2, 1.0 / 60);
}

TEST(CompiledBonds, BreakAsInTheWorld) {
  breaks_as_in_the_world<bonds_euler<double>>("bonds.toml", Integrator::euler);
  breaks_as_in_the_world<bonds_implicit<double>>("bonds.toml", Integrator::implicit);
  breaks_as_in_the_world<bonds_rattle<double>>("bonds.toml", Integrator::rattle);
}

TEST(CompiledBonds, BreakInSpaceAsInTheWorld) {
  breaks_as_in_the_world<bonds_in_space_euler<double>>("bonds_in_space.toml", Integrator::euler);
  breaks_as_in_the_world<bonds_in_space_implicit<double>>("bonds_in_space.toml", Integrator::implicit);
  breaks_as_in_the_world<bonds_in_space_rattle<double>>("bonds_in_space.toml", Integrator::rattle);
}

// Without rows that have bounds, and with numbers that jump.
TEST(CompiledBonds, BreakWithoutBoundsAsInTheWorld) {
  breaks_as_in_the_world<links_euler<double>>("links.toml", Integrator::euler);
  breaks_as_in_the_world<links_implicit<double>>("links.toml", Integrator::implicit);
  breaks_as_in_the_world<links_rattle<double>>("links.toml", Integrator::rattle);
}

// The step after an event begins without the joints' pull: its loads, too.
TEST(CompiledBonds, BreakByALatchAsInTheWorld) {
  cdot::runs_as_the_world<latched_rattle<double>>(scenes + "latched.toml", Integrator::rattle, 1e-10, 1);
  latched_rattle<double>::State state;
  latched_rattle<double>::reset(state);
  for (int k = 0; k < 63; ++k) latched_rattle<double>::step(state, 0.001);
  EXPECT_EQ(state.bonds.holds[0], 1);
  latched_rattle<double>::step(state, 0.001);
  EXPECT_EQ(state.bonds.holds[0], 0);
}

// The blow of the latch is a load of the step in which it closes.
TEST(CompiledBonds, CarryTheBlowOfALatchAsInTheWorld) {
  cdot::runs_as_the_world<latched_rk4<double>>(scenes + "latched.toml", Integrator::rk4, 1e-10, 1);
  cdot::runs_as_the_world<latched_dop853<double>>(scenes + "latched.toml", Integrator::dop853, 1e-10, 1);
  latched_rk4<double>::State state;
  latched_rk4<double>::reset(state);
  for (int k = 0; k < 62; ++k) latched_rk4<double>::step(state, 0.001);
  EXPECT_EQ(state.events.acts[0], 0);
  EXPECT_LT(state.bonds.load[0], 5);
  latched_rk4<double>::step(state, 0.001);
  EXPECT_EQ(state.events.acts[0], 1);
  const double blow = state.bonds.load[0] * 0.001;
  // The last pin alone pushes the last link, beside its weight.
  latched_rk4<double>::reset(state);
  for (int k = 0; k < 62; ++k) latched_rk4<double>::step(state, 0.001);
  auto before = state.v[2];
  while (state.events.acts[0] < 1) before = state.v[2], latched_rk4<double>::step(state, 1e-6);
  EXPECT_NEAR(std::hypot(state.v[2].x - before.x, state.v[2].y - before.y) * 3, blow, 1e-4);
}

// The time at which a joint breaks is located.
template <class Scene>
void breaks_in_time_as_in_the_world(const std::string& file, Integrator integrator, double step = 0.001) {
  cdot::runs_as_the_world<Scene>(scenes + file, integrator, 1e-9, 1.1, step);
}

TEST(CompiledBonds, BreakInTimeAsInTheWorld) {
  breaks_in_time_as_in_the_world<bonds_rk4<double>>("bonds.toml", Integrator::rk4);
  breaks_in_time_as_in_the_world<bonds_dop853<double>>("bonds.toml", Integrator::dop853);
  breaks_in_time_as_in_the_world<bonds_dop853<double>>("bonds.toml", Integrator::dop853, 1.0 / 60);
  breaks_in_time_as_in_the_world<bonds_radau5<double>>("bonds.toml", Integrator::radau5);
}

TEST(CompiledBonds, BreakInTimeInSpaceAsInTheWorld) {
  breaks_in_time_as_in_the_world<bonds_in_space_rk4<double>>("bonds_in_space.toml", Integrator::rk4);
  breaks_in_time_as_in_the_world<bonds_in_space_rk4<double>>("bonds_in_space.toml", Integrator::rk4, 1.0 / 60);
  breaks_in_time_as_in_the_world<bonds_in_space_dop853<double>>("bonds_in_space.toml", Integrator::dop853);
  breaks_in_time_as_in_the_world<bonds_in_space_radau5<double>>("bonds_in_space.toml", Integrator::radau5, 1.0 / 60);
}

TEST(CompiledBonds, BreakInTimeWithoutBoundsAsInTheWorld) {
  breaks_in_time_as_in_the_world<links_rk4<double>>("links.toml", Integrator::rk4);
  breaks_in_time_as_in_the_world<links_dop853<double>>("links.toml", Integrator::dop853, 1.0 / 60);
  breaks_in_time_as_in_the_world<links_radau5<double>>("links.toml", Integrator::radau5);
}

// A joint of the chain breaks at its strength; of a pillar that carries too much from the start only the lower one.
template <class Scene>
void breaks_in_the_test() {
  typename Scene::State state;
  Scene::reset(state);
  double broke[6] = {}, load[6] = {};
  while (state.time < 2) {
    for (int k = 0; k < 6; ++k) load[k] = std::max(load[k], state.bonds.holds[k] * state.bonds.load[k]);
    Scene::step(state, 0.001);
    for (int k = 0; k < 6; ++k)
      if (broke[k] == 0 && state.bonds.holds[k] == 0) broke[k] = state.time;
  }
  EXPECT_LT(broke[1], broke[0]);
  EXPECT_GT(load[1], 29.8);
  EXPECT_LT(load[1], 30);
  EXPECT_EQ(broke[5], 0.001);
  EXPECT_EQ(broke[4], 0);
}

TEST(CompiledBonds, BreakInTimeInTheTest) {
  breaks_in_the_test<bonds_rk4<double>>();
  breaks_in_the_test<bonds_dop853<double>>();
  breaks_in_the_test<bonds_radau5<double>>();
}

// One scene by each method, beside the World.
template <template <class> class Euler, template <class> class Implicit, template <class> class Rattle,
          template <class> class Rk4, template <class> class Dop853, template <class> class Radau5>
void run_by_six_methods(const std::string& file, double until) {
  const auto runs = [&](auto of, Integrator integrator) {
    cdot::runs_as_the_world<decltype(of)>(scenes + file, integrator, 1e-9, until);
  };
  runs(Euler<double>{}, Integrator::euler);
  runs(Implicit<double>{}, Integrator::implicit);
  runs(Rattle<double>{}, Integrator::rattle);
  runs(Rk4<double>{}, Integrator::rk4);
  runs(Dop853<double>{}, Integrator::dop853);
  runs(Radau5<double>{}, Integrator::radau5);
}

// The impulse of a blow is a load of the step in which it falls: by Runge-Kutta methods m v of the weight, so m v / h.
template <class Scene>
void blow_is_a_load() {
  typename Scene::State state;
  Scene::reset(state);
  double blow = 0;
  while (state.time < 0.2) {
    Scene::step(state, 1.0 / 60);
    blow = std::max(blow, state.bonds.load[0]);
  }
  EXPECT_EQ(state.bonds.holds[0], 1);
  EXPECT_NEAR(blow, 3 * 60 * std::sqrt(2 * 9.81 * 0.1), 1e-5);
}

TEST(CompiledBonds, BreakByBlowsAsInTheWorld) {
  run_by_six_methods<blows_euler, blows_implicit, blows_rattle, blows_rk4, blows_dop853, blows_radau5>("blows.toml",
                                                                                                       0.8);
  blow_is_a_load<blows_rk4<double>>();
  blow_is_a_load<blows_dop853<double>>();
  blow_is_a_load<blows_radau5<double>>();
}

// By their own force.
TEST(CompiledBonds, PinsShearAsInTheWorld) {
  breaks_as_in_the_world<pins_euler<double>>("pins.toml", Integrator::euler);
  breaks_as_in_the_world<pins_implicit<double>>("pins.toml", Integrator::implicit);
  breaks_as_in_the_world<pins_rattle<double>>("pins.toml", Integrator::rattle);
}

// The time at which a pin shears is located.
TEST(CompiledBonds, PinsShearInTimeAsInTheWorld) {
  cdot::runs_as_the_world<pins_rk4<double>>(scenes + "pins.toml", Integrator::rk4, 1e-9, 2);
  cdot::runs_as_the_world<pins_dop853<double>>(scenes + "pins.toml", Integrator::dop853, 1e-9, 2, 1.0 / 60);
  cdot::runs_as_the_world<pins_radau5<double>>(scenes + "pins.toml", Integrator::radau5, 1e-9, 1);
}

template <class Scene>
void pin_shears_late() {
  typename Scene::State state;
  Scene::reset(state);
  for (int k = 0; k < 900; ++k) Scene::step(state, 0.001);
  EXPECT_EQ(state.events.acts[Scene::elbow_angle_shear_pin], 1);
  EXPECT_NEAR(state.q[Scene::fore].angle, state.q[Scene::arm].angle, 1e-12);
  for (int k = 0; k < 600; ++k) Scene::step(state, 0.001);
  EXPECT_EQ(state.events.acts[Scene::elbow_angle_shear_pin], 0);
  EXPECT_GT(std::abs(state.q[Scene::fore].angle - state.q[Scene::arm].angle), 1e-3);
  EXPECT_EQ(state.events.acts[Scene::bearing_angle_shear_pin], 0);
  EXPECT_EQ(state.events.acts[Scene::knee_angle_shear_pin], 1);
}

TEST(CompiledBonds, PinsShearInTheTest) {
  pin_shears_late<pins_euler<double>>();
  pin_shears_late<pins_implicit<double>>();
  pin_shears_late<pins_rattle<double>>();
  pin_shears_late<pins_rk4<double>>();
}

// The chain loses its last link first, the door leaves its frame with all that acts on its angle. Where two joints
// carry too much, only the one breaks that is further beyond its strength.
TEST(CompiledBonds, BreakInTheTest) {
  using Scene = bonds_implicit<double>;
  Scene::State state;
  Scene::reset(state);
  double broke[6] = {};
  while (state.time < 2) {
    Scene::step(state, 0.001);
    for (int k = 0; k < 6; ++k)
      if (broke[k] == 0 && state.bonds.holds[k] == 0) broke[k] = state.time;
  }
  for (int k = 0; k < 4; ++k) EXPECT_GT(broke[k], 0.05) << k;
  EXPECT_EQ(broke[5], 0.001);
  EXPECT_EQ(broke[4], 0);
  EXPECT_LT(broke[1], broke[0]);
  const double spin = state.v[Scene::door].w, w = state.q[Scene::door].angle;
  Scene::step(state, 0.001);
  EXPECT_EQ(state.v[Scene::door].w, spin);
  EXPECT_NEAR(state.q[Scene::door].angle, w + 0.001 * spin, 1e-12);
  EXPECT_EQ(state.hold[Scene::hinge_angle_motor] * state.force[Scene::hinge_angle_motor], 0);
}

// The load of a pendulum at rest is its weight.
TEST(CompiledBonds, TellTheirLoads) {
  using Scene = bonds_implicit<double>;
  Scene::State state;
  Scene::reset(state);
  state.q[Scene::weight].x = 3, state.q[Scene::weight].y = -0.55;
  state.v[Scene::weight] = {0, 0, 0};
  Scene::begin(state);
  for (int k = 0; k < 100; ++k) Scene::step(state, 0.001);
  EXPECT_NEAR(state.bonds.load[3], 3 * 9.81, 1e-9);
  EXPECT_EQ(state.bonds.holds[3], 1);
}

TEST(CompiledBonds, ASnapshotKeepsThem) {
  cdot::snapshot_keeps<bonds_rattle<double>>(0.002);
  cdot::snapshot_keeps<bonds_rk4<double>>(0.002);
  cdot::snapshot_keeps<links_dop853<double>>(0.002);
  const auto kept = cdot::snapshot_keeps<bonds_implicit<double>>(0.002);
  EXPECT_EQ(kept.bonds.holds[0], 0);
}

TEST(CompiledBonds, LanesAreAsAlone) {
  cdot::lanes_are_as_alone<bonds_euler>();
  cdot::lanes_are_as_alone<bonds_implicit>();
  cdot::lanes_are_as_alone<bonds_rattle, float>();
  cdot::lanes_are_as_alone<bonds_in_space_rattle>();
  cdot::lanes_are_as_alone<bonds_rk4>();
  cdot::lanes_are_as_alone<blows_rk4>();
  cdot::lanes_are_as_alone<bonds_in_space_dop853>();
  cdot::lanes_are_as_alone<links_rk4, float>();
  cdot::lanes_are_as_alone<links_radau5>();
  cdot::lanes_are_as_alone<pins_rattle>();
  cdot::lanes_are_as_alone<pins_rk4>();
}

// Two types of such a header once had the same name.
TEST(CompiledBonds, GoBesideEverythingElse) {
  run_by_six_methods<everything_euler, everything_implicit, everything_rattle, everything_rk4, everything_dop853,
                     everything_radau5>("everything.toml", 1.5);
}

}  // namespace
