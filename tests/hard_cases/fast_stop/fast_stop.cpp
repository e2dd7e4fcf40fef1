// A limit a hundredth of a step away: the wheel stands at it.
#include <algorithm>
#include <cmath>

#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::fast_stop {
namespace {

void hit(Trial& t) {
  t.start();
  t.run(0.5);
  double rate = 0, off = 0;
  const Watch w = t.run(0.5, 0, [&] {
    rate =
        std::max(rate, std::abs(t.ask([&](const auto& world) { return double(world.coordinate_rate(0, "angle")); })));
    off = std::max(off, std::abs(t.coordinate(0, "angle") - 1));
  });
  t.at_most("off the stop [rad]", off, 1e-3, 1e-2);
  t.at_most("rate at the stop [rad/s]", rate, 1e-3, 1);
  t.at_most("gap [m]", w.gap, 1e-6, 1e-4);
}

const Register planar({"fast_stop", "planar", without(all_ways(), {Integrator::rattle}), hit});
const Register spatial({"fast_stop", "spatial", without(all_ways(), {Integrator::rattle}), hit});

}  // namespace
}  // namespace cdot::hard::fast_stop
