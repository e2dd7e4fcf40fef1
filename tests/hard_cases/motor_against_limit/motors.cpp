// Rows with different goals for one coordinate: the limit wins without oscillation.
#include <algorithm>
#include <cmath>

#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::motor_against_limit {
namespace {

constexpr double degree = pi / 180;

// Without the motor of unlimited force, which contradicts a limit.
void fight(Trial& t) {
  t.scene.joints.erase(t.scene.joints.begin() + 1);
  t.start();
  t.run(3);
  double rate = 0, off = 0;
  const Watch w = t.run(2, 0, [&] {
    for (int joint : {0, 1})
      rate = std::max(
          rate, std::abs(t.ask([&](const auto& world) { return double(world.coordinate_rate(joint, "angle")); })));
    off = std::max(off, std::abs(t.coordinate(0, "angle") / degree - 90));
  });
  t.at_most("off the limit [deg]", off, 0.5);
  t.at_most("shakes by [rad/s]", rate, 1e-6, 1e-3);
  t.at_most("gap [m]", w.gap, 1e-6, 1e-4);
  t.near("between two motors [rad]", t.coordinate(1, "angle"), 0, 1e-6, 1e-3);
}

const Register planar({"motor_against_limit", "planar",
                       in_double(only(direct(), {Integrator::euler, Integrator::implicit})) +
                           only(direct(), {Integrator::rk4, Integrator::dop853}) +
                           only(iterative(), {Integrator::euler, Integrator::implicit, Integrator::rattle}),
                       fight});
const Register spatial({"motor_against_limit", "spatial",
                        in_double(only(direct(), {Integrator::euler, Integrator::implicit})) +
                            only(direct(), {Integrator::rk4, Integrator::dop853}) +
                            only(iterative(), {Integrator::euler, Integrator::implicit, Integrator::rattle}),
                        fight});

}  // namespace
}  // namespace cdot::hard::motor_against_limit
