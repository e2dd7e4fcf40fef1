// Friction in proportion to a load that no finite force balances. By hand, for an impulse P along the line's normal and
// -Q along the line at the end: it stops if Q / P < mu. Afterwards the rod turns about it and conserves its energy.
#include <algorithm>
#include <array>
#include <cmath>

#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::jamming_rod {
namespace {

// [m/s] Of the end along the line, or along two directions of the plane.
std::array<double, 2> slip(const Trial& t) {
  const auto rate = [&](const char* slip) {
    return t.ask([&](const auto& world) { return double(world.coordinate_rate(0, slip)); });
  };
  if (t.scene.dimension == Dimension::planar) return {rate("slip"), 0};
  return {rate("slip_y"), rate("slip_z")};
}

void jam(Trial& t) {
  t.start();
  constexpr double c = 1, s = 2, I = 5.0 / 3;  // the end is at (c, -s) from the centre of the rod of 1 kg
  const auto start = slip(t);
  const double speed = std::hypot(start[0], start[1]);
  const double first = t.energy();
  double sunk = 0, last = first, gained = 0, slid = 0;
  t.run(0.1, 0, [&] {
    sunk = std::max(sunk, -t.coordinate(0, "gap"));
    const auto now = slip(t);
    slid = std::max(slid, (now[0] * start[0] + now[1] * start[1]) / speed);
    gained = std::max(gained, t.energy() - last);
    last = t.energy();
  });
  // K (-Q, P) = -(4, 0), the end's velocity before; the impulse takes half of 4 Q.
  constexpr double kxx = 1 + s * s / I, kyy = 1 + c * c / I, kxy = s * c / I;
  const double Q = 4 / (kxx - kxy * kxy / kyy), left = first - 0.5 * 4 * Q;
  t.at_most("sunk by [m]", sunk, 1e-3);
  t.at_most("end slides [m/s]", slid, 1e-3);
  t.at_most("energy gained in a step, relative", gained / first, 1e-3);
  t.near("energy left, relative", last / first, left / first, 5e-3);
}

const Register planar({"jamming_rod", "planar", direct() + without(iterative(), {Integrator::rattle}), jam});
const Register spatial({"jamming_rod", "spatial", direct() + without(iterative(), {Integrator::rattle}), jam});

}  // namespace
}  // namespace cdot::hard::jamming_rod
