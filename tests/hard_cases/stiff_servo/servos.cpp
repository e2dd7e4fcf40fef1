// A gain far beyond the step: the servo arrives, and stays within what its torque moves in two steps.
#include <algorithm>
#include <cmath>

#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::stiff_servo {
namespace {

void reach(Trial& t) {
  t.start();
  const Watch first = t.run(8);
  double off = 0;
  const Watch then = t.run(2, 0, [&] { off = std::max(off, std::abs(t.coordinate(0, "angle") - 0.5)); });
  // The way of two steps at the largest torque.
  t.at_most("off its target [rad]", off, 2 * 20 / (1.0 / 3) * h * h);
  t.at_most("gap [m]", std::max(first.gap, then.gap), 1e-6, 1e-4);
}

// A limited spring is linear up to its limit, so a step finds the torque that ends at the target.
void arrive(Trial& t) {
  t.start();
  t.run(8);
  double off = 0;
  const Watch w = t.run(2, 0, [&] { off = std::max(off, std::abs(t.coordinate(0, "angle") - 0.5)); });
  t.at_most("off its target [rad]", off, 1e-6, 1e-4);
  t.at_most("gap [m]", w.gap, 1e-6, 1e-4);
}

const Register planar_drive({"stiff_servo", "planar_drive", only(all_ways(), {Integrator::euler}), arrive});
const Register spatial_drive({"stiff_servo", "spatial_drive", only(direct(), {Integrator::euler}), arrive});
const Register planar({"stiff_servo", "planar", all_ways(), reach});
const Register spatial({"stiff_servo", "spatial", all_ways(), reach});

}  // namespace
}  // namespace cdot::hard::stiff_servo
