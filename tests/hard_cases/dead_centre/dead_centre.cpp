// A slider crank starts at a dead centre and passes others at 150 rad/s, with an inertia of 2.7e-6 kg m^2.
#include <algorithm>
#include <cmath>

#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::dead_centre {
namespace {

// Final angle of the shared problem slider_crank, by Gauss-Legendre of order 12 [rad].
constexpr double angle_at_end = 18.394450982997107;

void turn(Trial& t) {
  t.start();
  double guide = 0;
  const double step = 0.2 / 6554;
  const Watch w = t.run(0.2, step, [&] {
    const BodyState slider = t.body("slider");
    guide = std::max(guide, std::abs(t.scene.dimension == Dimension::planar ? slider.y : slider.z));
  });
  const BodyState crank = t.body("crank");
  const double angle = t.scene.dimension == Dimension::planar ? crank.angle : -2 * std::atan2(crank.e2, crank.e0);
  t.at_most("crank's angle off [rad]", std::abs(std::remainder(angle - angle_at_end, 2 * pi)), 1e-3, 1e-1);
  t.at_most("guide [m]", guide, 1e-5, 1e-5);
  t.at_most("gap [m]", w.gap, 1e-5, 1e-5);
}

const Register planar({"dead_centre", "planar",
                       only(all_ways(), {Integrator::rattle, Integrator::rk4, Integrator::dop853}) +
                           in_double(only(direct(), {Integrator::euler})),
                       turn});
const Register spatial({"dead_centre", "spatial",
                        only(all_ways(), {Integrator::rattle, Integrator::rk4, Integrator::dop853}) +
                            in_double(only(direct(), {Integrator::euler})),
                        turn});

}  // namespace
}  // namespace cdot::hard::dead_centre
