// Stick and slip 1600 times per second, or the mean of it: the block never leaves the range of its swing.
#include <algorithm>
#include <cmath>

#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::stick_slip {
namespace {

void drag(Trial& t) {
  constexpr double mean = 1000 / 1e8, swing = 1.0 / 1e4;
  t.start();
  double far = 0;
  const Watch w = t.run(5, 0, [&] { far = std::max(far, std::abs(t.coordinate(0, "slide") - mean)); });
  t.at_most("from the middle of its swing [m]", far, 1.01 * swing, 1.1 * swing);
  t.at_most("speed [m/s]", w.speed, 1.01);
}

const Register planar({"stick_slip", "planar", only(direct(), {Integrator::euler, Integrator::implicit}), drag});
const Register spatial({"stick_slip", "spatial", only(direct(), {Integrator::euler, Integrator::implicit}), drag});

}  // namespace
}  // namespace cdot::hard::stick_slip
