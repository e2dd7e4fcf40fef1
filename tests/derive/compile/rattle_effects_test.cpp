// Compiled scenes with effects by RATTLE move as the World does, to round-off; smooth effects leave the method its
// second order. A lane has the bits that it has alone.
#include <gtest/gtest.h>
#include <utility>

#include "bennett_rattle.hpp"
#include "bounds_rattle.hpp"
#include "effects_rattle.hpp"
#include "ends_rattle.hpp"
#include "held_coin_rattle.hpp"
#include "hinges_rattle.hpp"
#include "machine_rattle.hpp"
#include "planar_drive_rattle.hpp"
#include "robot_arm_rattle.hpp"
#include "spatial_drive_rattle.hpp"
#include "tailgate_rattle.hpp"
#include "tests/derive/compile/beside_world.hpp"
#include "tethers_rattle.hpp"
#include "thrown_rattle.hpp"
#include "torsion_rattle.hpp"
#include "tumbling_rattle.hpp"
#include "van_der_pol_rattle.hpp"

namespace {

using cdot::Integrator;
using namespace cdot::scenes;

const std::string scenes = "tests/derive/compile/scenes/", shared = "specs/scenes/";

TEST(CompiledRattle, MovesWithSmoothEffectsAsTheWorld) {
  cdot::runs_as_the_world<effects_rattle<double>>(scenes + "effects.toml", Integrator::rattle);
  cdot::runs_as_the_world<thrown_rattle<double>>(scenes + "thrown.toml", Integrator::rattle);
  cdot::runs_as_the_world<torsion_rattle<double>>(scenes + "torsion.toml", Integrator::rattle);
  cdot::runs_as_the_world<tumbling_rattle<double>>(scenes + "tumbling.toml", Integrator::rattle);
  cdot::runs_as_the_world<tailgate_rattle<double>>(shared + "tailgate.toml", Integrator::rattle);
  cdot::runs_as_the_world<van_der_pol_rattle<double>>(shared + "gallery/van_der_pol.toml", Integrator::rattle);
}

TEST(CompiledRattle, MovesWithMotorsAndFrictionAsTheWorld) {
  cdot::runs_as_the_world<machine_rattle<double>>(shared + "machine.toml", Integrator::rattle);
  cdot::runs_as_the_world<machine_rattle<double>>(shared + "machine.toml", Integrator::rattle, 1e-10, 0.3, 0.0004);
  cdot::runs_as_the_world<robot_arm_rattle<double>>(shared + "robot_arm.toml", Integrator::rattle);
  cdot::runs_as_the_world<bennett_rattle<double>>(shared + "gallery/bennett.toml", Integrator::rattle);
}

TEST(CompiledRattle, MovesWithEndsAsTheWorld) {
  cdot::runs_as_the_world<bounds_rattle<double>>(scenes + "bounds.toml", Integrator::rattle, 1e-11, 1.5);
  cdot::runs_as_the_world<ends_rattle<double>>(scenes + "ends.toml", Integrator::rattle, 1e-11);
  cdot::runs_as_the_world<hinges_rattle<double>>(scenes + "hinges.toml", Integrator::rattle, 1e-11);
  cdot::runs_as_the_world<tethers_rattle<double>>(scenes + "tethers.toml", Integrator::rattle, 1e-11, 1);
}

// Beside effects and ends rows of velocities are free in the first half.
TEST(CompiledRattle, RollsWithEffectsAndEndsAsTheWorld) {
  cdot::runs_as_the_world<held_coin_rattle<double>>(scenes + "held_coin.toml", Integrator::rattle, 1e-11, 1);
  cdot::runs_as_the_world<held_coin_rattle<double>>(scenes + "held_coin.toml", Integrator::rattle, 1e-11, 1, 1.0 / 60);
}

// An end that a step meets is met whatever the way of Newton's rounds: a World moved by 1e-15 m/s stays beside itself.
TEST(CompiledRattle, TheWorldMagnifiesNoRoundOffAtEnds) {
  const cdot::Scene scene = cdot::read_scene(std::string(CDOT_SOURCE_DIR) + "/" + scenes + "ends.toml");
  auto world = cdot::world_of(scene, Integrator::rattle), other = cdot::world_of(scene, Integrator::rattle);
  for (int body = 0; body < other.body_count(); ++body) {
    auto v = other.velocity(body);
    v.y += 1e-15;
    if (!other.is_static(body)) other.set_velocity(body, v);
  }
  for (int k = 0; k < 700; ++k) {
    ASSERT_TRUE(world.step(0.001) && other.step(0.001));
    for (int body = 0; body < world.body_count(); ++body)
      ASSERT_NEAR(world.place(body).angle, other.place(body).angle, 1e-12) << "step " << k;
  }
}

// Their steep part between two saturations is a ten-thousandth of a step's change of the rate. At the target, 0.75 s
// after the start, a step of 1/60 s of the World itself magnifies 1e-15 rad/s to 3e-9 rad/s.
TEST(CompiledRattle, MovesWithSaturatingDrivesAsTheWorld) {
  const std::string drives = "tests/hard_cases/stiff_servo/";
  for (const auto& [step, until] : {std::pair{0.001, 2.0}, std::pair{1.0 / 60, 0.7}}) {
    cdot::runs_as_the_world<planar_drive_rattle<double>>(drives + "planar_drive.toml", Integrator::rattle, 1e-9, until,
                                                         step);
    cdot::runs_as_the_world<spatial_drive_rattle<double>>(drives + "spatial_drive.toml", Integrator::rattle, 1e-9,
                                                          until, step);
  }
}

// The pose of the last body at 0.4 s.
template <class Compiled>
auto end_with(double step) {
  typename Compiled::State state;
  Compiled::reset(state);
  for (int k = 0; k < std::lround(0.4 / step); ++k) Compiled::step(state, step);
  return cdot::numbers_of<Compiled>(state.q[Compiled::bodies - 1]);
}

// Half the step leaves a quarter of the error: between halved steps the change is (1 - 1/4) of it.
template <class Compiled>
void is_of_second_order() {
  const auto coarse = end_with<Compiled>(0.002), middle = end_with<Compiled>(0.001), fine = end_with<Compiled>(0.0005);
  double first = 0, second = 0;
  for (std::size_t k = 0; k < fine.size(); ++k) {
    first = std::max(first, std::abs(coarse[k] - middle[k]));
    second = std::max(second, std::abs(middle[k] - fine[k]));
  }
  EXPECT_NEAR(first / second, 4, 0.2);
  EXPECT_GT(second, 1e-9);
}

TEST(CompiledRattle, KeepsItsOrderWithSmoothEffects) {
  is_of_second_order<effects_rattle<double>>();
  is_of_second_order<thrown_rattle<double>>();
  is_of_second_order<torsion_rattle<double>>();
  is_of_second_order<tumbling_rattle<double>>();
  is_of_second_order<tailgate_rattle<double>>();
}

TEST(CompiledRattle, LanesWithEffectsAreAsAlone) {
  cdot::lanes_are_as_alone<effects_rattle>();
  cdot::lanes_are_as_alone<thrown_rattle, float>();
  cdot::lanes_are_as_alone<bounds_rattle>();
  cdot::lanes_are_as_alone<ends_rattle>();
  cdot::lanes_are_as_alone<planar_drive_rattle>();
  cdot::lanes_are_as_alone<tethers_rattle>();
  cdot::lanes_are_as_alone<robot_arm_rattle>();
}

}  // namespace
