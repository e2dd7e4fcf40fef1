// Motors without a largest force are equations of a compiled scene, and specs beside a scene are compiled too: both
// move as the World does, to round-off.
#include <gtest/gtest.h>

#include "bennett_dop853.hpp"
#include "bennett_rk4.hpp"
#include "brakes_euler.hpp"
#include "brakes_rk4.hpp"
#include "cam_dop853.hpp"
#include "cam_rk4.hpp"
#include "tests/derive/compile/beside_world.hpp"
#include "van_der_pol_dop853.hpp"
#include "van_der_pol_rk4.hpp"

namespace {

using cdot::Integrator;
using namespace cdot::scenes;

const std::string gallery = "specs/scenes/gallery/";

TEST(CompiledMotors, MoveByRk4AsTheWorld) {
  cdot::runs_as_the_world<cam_rk4<double>>(gallery + "cam.toml", Integrator::rk4);
  cdot::runs_as_the_world<bennett_rk4<double>>(gallery + "bennett.toml", Integrator::rk4);
}

TEST(CompiledMotors, MoveByDop853AsTheWorld) {
  cdot::runs_as_the_world<cam_dop853<double>>(gallery + "cam.toml", Integrator::dop853);
  cdot::runs_as_the_world<bennett_dop853<double>>(gallery + "bennett.toml", Integrator::dop853);
}

// J of wheels on fixed pins is constant.
TEST(CompiledMotors, ResetSetsEveryByteBesideAConstantJ) {
  cdot::sets_every_byte<brakes_euler<double>>();
  cdot::sets_every_byte<brakes_rk4<double>>();
}

TEST(CompiledMotors, AnEffectBesideTheSceneMovesAsInTheWorld) {
  cdot::runs_as_the_world<van_der_pol_rk4<double>>(gallery + "van_der_pol.toml", Integrator::rk4);
  cdot::runs_as_the_world<van_der_pol_dop853<double>>(gallery + "van_der_pol.toml", Integrator::dop853);
}

}  // namespace
