// Stiffnesses of one mount that differ by a million: the soft swing goes on, the stiff axis stays.
#include <algorithm>
#include <cmath>

#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::lopsided_bushing {
namespace {

void swing(Trial& t) {
  t.start();
  double along = 0, across = 0;
  const double c = std::sqrt(0.75), s = 0.5;
  const Watch w = t.run(5, 0, [&] {
    const BodyState box = t.body("box");
    along = std::max(along, std::abs(c * box.x + s * box.y));
    across = std::max(across, std::abs(c * box.y - s * box.x));
  });
  t.at_most("along the stiff axis [m]", along, 1e-6, 1e-4);
  t.at_most("across [m]", across, 0.101);
  t.at_most("energy gained, of the swing's", w.rise / 0.5, 1e-2);
}

const auto damping_ways = only(all_ways(), {Integrator::euler, Integrator::implicit});
const Register planar({"lopsided_bushing", "planar", damping_ways, swing});
const Register spatial({"lopsided_bushing", "spatial", damping_ways, swing});

}  // namespace
}  // namespace cdot::hard::lopsided_bushing
