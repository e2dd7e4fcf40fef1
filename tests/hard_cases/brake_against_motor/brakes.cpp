// Two bounded forces on one coordinate: what is left of the stronger one moves the wheel.
#include <algorithm>
#include <cmath>

#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::brake_against_motor {
namespace {

double rate_of(const Trial& t, int joint) {
  return t.ask([&](const auto& world) { return double(world.coordinate_rate(joint, "angle")); });
}

void wrestle(Trial& t) {
  t.start();
  double shaken = 0;
  t.run(2, 0, [&] { shaken = std::max({shaken, std::abs(rate_of(t, 1)), std::abs(rate_of(t, 2))}); });
  t.near("the weaker brake yields [rad/s]", rate_of(t, 0), 0.1 / 0.5 * 2, 1e-6, 1e-3);
  t.at_most("the others hold [rad/s]", shaken, 1e-9, 1e-3);
}

const Register planar({"brake_against_motor", "planar", all_ways(), wrestle});
const Register spatial({"brake_against_motor", "spatial", all_ways(), wrestle});

}  // namespace
}  // namespace cdot::hard::brake_against_motor
