// A compiled scene in space moves as the World does, to round-off.
#include <gtest/gtest.h>

#include "tests/derive/compile/beside_world.hpp"

#define CDOT_EACH_SCENE_IN_SPACE(X, method) \
  X(chain_10, method)                       \
  X(double_pendulum, method)                \
  X(four_bar, method)                       \
  X(gyroscope, method)                      \
  X(three_bodies, method)                   \
  X(torque_free_body, method)

// clang-format off
#include "chain_10_space_dop853.hpp"
#include "chain_10_space_euler.hpp"
#include "chain_10_space_rk4.hpp"
#include "double_pendulum_space_dop853.hpp"
#include "double_pendulum_space_euler.hpp"
#include "double_pendulum_space_rk4.hpp"
#include "four_bar_space_dop853.hpp"
#include "four_bar_space_euler.hpp"
#include "four_bar_space_rk4.hpp"
#include "geared_dop853.hpp"
#include "geared_euler.hpp"
#include "geared_rattle.hpp"
#include "geared_rk4.hpp"
#include "gyroscope_space_dop853.hpp"
#include "gyroscope_space_euler.hpp"
#include "gyroscope_space_rk4.hpp"
#include "hinges_euler.hpp"
#include "pushed_dop853.hpp"
#include "pushed_euler.hpp"
#include "pushed_rattle.hpp"
#include "pushed_rk4.hpp"
#include "slider_crank_space_dop853.hpp"
#include "slider_crank_space_euler.hpp"
#include "slider_crank_space_rk4.hpp"
#include "three_bodies_space_dop853.hpp"
#include "three_bodies_space_euler.hpp"
#include "three_bodies_space_rk4.hpp"
#include "torsion_dop853.hpp"
#include "torsion_euler.hpp"
#include "torsion_rk4.hpp"
#include "torque_free_body_space_dop853.hpp"
#include "torque_free_body_space_euler.hpp"
#include "torque_free_body_space_rk4.hpp"
// clang-format on

namespace {

using cdot::Integrator;

#define CDOT_RUN_IN_SPACE(scene, method)                                                                        \
  cdot::runs_as_the_world<cdot::scenes::scene##_space_##method<double>>("specs/scenes/spatial/" #scene ".toml", \
                                                                        Integrator::method);

const std::string slider_crank = "specs/scenes/spatial/slider_crank.toml";

// With steps of 1 ms, at 150 rad/s, Newton turns a change of 1e-15 at the start into 1e-7. Rotations of rounds do not
// commute: corrections of 1e-4 rad in other rounds are 1e-11 rad apart.
TEST(CompiledSpace, MovesByEulerAsTheWorld) {
  CDOT_EACH_SCENE_IN_SPACE(CDOT_RUN_IN_SPACE, euler)
  cdot::runs_as_the_world<cdot::scenes::slider_crank_space_euler<double>>(slider_crank, Integrator::euler, 1e-10, 0.05,
                                                                          1e-4);
  cdot::runs_as_the_world<cdot::scenes::slider_crank_space_euler<double>>(slider_crank, Integrator::euler, 2e-10, 0.07,
                                                                          1e-4);
}

TEST(CompiledSpace,
     MovesByRk4AsTheWorld){CDOT_EACH_SCENE_IN_SPACE(CDOT_RUN_IN_SPACE, rk4) CDOT_RUN_IN_SPACE(slider_crank, rk4)}

TEST(CompiledSpace, MovesByDop853AsTheWorld){CDOT_EACH_SCENE_IN_SPACE(CDOT_RUN_IN_SPACE, dop853)
                                                 CDOT_RUN_IN_SPACE(slider_crank, dop853)}

TEST(CompiledSpace, ForcesTorquesAndDampingActAsInTheWorld) {
  const std::string file = "tests/derive/compile/scenes/pushed.toml";
  cdot::runs_as_the_world<cdot::scenes::pushed_euler<double>>(file, Integrator::euler);
  cdot::runs_as_the_world<cdot::scenes::pushed_rattle<double>>(file, Integrator::rattle);
  cdot::runs_as_the_world<cdot::scenes::pushed_rk4<double>>(file, Integrator::rk4);
  cdot::runs_as_the_world<cdot::scenes::pushed_dop853<double>>(file, Integrator::dop853);
}

// Angles go on beyond half a turn: the wheel turns by more than three.
TEST(CompiledSpace, EffectsOnCoordinatesActAsInTheWorld) {
  const std::string wound = "tests/derive/compile/scenes/torsion.toml",
                    hinges = "tests/derive/compile/scenes/hinges.toml";
  cdot::runs_as_the_world<cdot::scenes::torsion_euler<double>>(wound, Integrator::euler);
  cdot::runs_as_the_world<cdot::scenes::torsion_rk4<double>>(wound, Integrator::rk4);
  cdot::runs_as_the_world<cdot::scenes::torsion_dop853<double>>(wound, Integrator::dop853);
  cdot::runs_as_the_world<cdot::scenes::hinges_euler<double>>(hinges, Integrator::euler);
  using Wound = cdot::scenes::torsion_euler<double>;
  Wound::State state;
  Wound::reset(state);
  double most = 0;
  for (int k = 0; k < 700; ++k) Wound::step(state, 0.001), most = std::max(most, std::abs(state.angles.angle[0]));
  EXPECT_GT(most, 3 * 6.2831853);
}

// Teeth count the whole turns of their wheels: some of the three have made 2 or 3 of these.
TEST(CompiledSpace, GearsCountWholeTurns) {
  using namespace cdot::scenes;
  const std::string geared = "tests/derive/compile/scenes/geared.toml";
  cdot::runs_as_the_world<geared_euler<double>>(geared, Integrator::euler, 1e-11);
  cdot::runs_as_the_world<geared_rattle<double>>(geared, Integrator::rattle, 1e-11);
  cdot::runs_as_the_world<geared_rk4<double>>(geared, Integrator::rk4, 1e-11);
  cdot::runs_as_the_world<geared_dop853<double>>(geared, Integrator::dop853, 1e-11);
  const auto state = cdot::state_after<geared_rk4<double>>(700);
  EXPECT_GT(std::ranges::max(state.angles.turns), 12);  // [rad]
}

// Spins of a symmetric body, of one without symmetry, and of bodies with joints.
TEST(CompiledSpace, LanesAreAsAlone) {
  cdot::lanes_are_as_alone<cdot::scenes::gyroscope_space_euler>();
  cdot::lanes_are_as_alone<cdot::scenes::torque_free_body_space_euler>();
  cdot::lanes_are_as_alone<cdot::scenes::three_bodies_space_euler>();
  cdot::lanes_are_as_alone<cdot::scenes::three_bodies_space_rk4>();
  cdot::lanes_are_as_alone<cdot::scenes::torque_free_body_space_euler, float>();
  cdot::lanes_are_as_alone<cdot::scenes::gyroscope_space_dop853, float>();
  cdot::lanes_are_as_alone<cdot::scenes::torsion_rk4>();
  cdot::lanes_are_as_alone<cdot::scenes::geared_rattle>();
  cdot::lanes_are_as_alone<cdot::scenes::hinges_euler>();
}

// The series of all lengths against the functions.
TEST(CompiledSpace, RotationsAreExactToRoundOff) {
  for (double angle = 1e-6; angle < 3; angle *= 1.003) {
    double c;
    const double s = cdot::scenes::half_turn(angle * angle, c);
    EXPECT_NEAR(c, std::cos(angle / 2), 3e-16) << angle;
    EXPECT_NEAR(s * angle / std::sin(angle / 2), 1, 6e-16) << angle;
  }
  for (double x = 1e-12; x < 1; x *= 1.1)
    for (const double length : {1 + x, 1 - 0.9 * x})
      EXPECT_NEAR(cdot::scenes::inverse_root(length) * std::sqrt(length), 1, 4e-16) << length;
}

template <class Compiled>
void solves_for_its_rows(double within) {
  const auto state = cdot::state_after<Compiled>(150);
  cdot::solves_for_rows<Compiled>(
      state.J, within, [&](auto& b, auto& lambda, auto& d) { Compiled::solve(state.q, state.J, b, lambda, d); });
}

TEST(CompiledSpace, SolvesForItsRows) {
  solves_for_its_rows<cdot::scenes::chain_10_space_euler<double>>(1e-12);
  solves_for_its_rows<cdot::scenes::chain_10_space_rk4<double>>(1e-12);
  solves_for_its_rows<cdot::scenes::double_pendulum_space_euler<double>>(1e-13);
  solves_for_its_rows<cdot::scenes::three_bodies_space_rk4<double>>(1e-13);
}

}  // namespace
