// A four-bar lies flat twice per turn: the rank drops, and two branches cross there.
#include <algorithm>
#include <cmath>

#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::change_point {
namespace {

// |angle| of the coupler, which stays level on the parallel branch; in space from its orientation.
double tilt(const BodyState& coupler, Dimension dimension) {
  if (dimension == Dimension::planar) return std::abs(std::remainder(coupler.angle, 2 * pi));
  return 2 * std::atan2(std::hypot(coupler.e1, coupler.e2, coupler.e3), std::abs(coupler.e0));
}

void turn(Trial& t) {
  t.start();
  double worst = 0;
  const Watch w = t.run(10, 1.0 / 240, [&] { worst = std::max(worst, tilt(t.body("h0"), t.scene.dimension)); });
  t.at_most("gap [m]", w.gap, 1e-4);
  t.at_most("energy off, of 20.45 J", w.drift() / 20.4533, 5e-3);
  t.at_most("off the parallel branch [rad]", worst, 1e-3);
}

const Register planar({"change_point", "planar",
                       in_double(only(direct(), {Integrator::rattle, Integrator::dop853})) +
                           only(direct(), {Integrator::rk4}) +
                           only(iterative(), {Integrator::rattle, Integrator::rk4, Integrator::dop853}),
                       turn});
const Register spatial({"change_point", "spatial",
                        in_double(only(direct(), {Integrator::rattle, Integrator::dop853})) +
                            only(direct(), {Integrator::rk4}) +
                            only(iterative(), {Integrator::rattle, Integrator::rk4, Integrator::dop853}),
                        turn});

}  // namespace
}  // namespace cdot::hard::change_point
