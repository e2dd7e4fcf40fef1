// Inequality rows that come and go at every step.
#include "tests/hard_cases/trial.hpp"

namespace cdot::hard {
namespace {

void swing(Trial& t) {
  t.start();
  const double start = 0.5 * 9 + 0.5 * (1.25 / 12) * 4;
  const Watch w = t.run(10);
  t.at_most("a rope too long by [m]", w.gap, 1e-3);
  t.at_most("energy gained, of the throw's", w.rise / start, 0.01);
}

const Register planar({"chattering_ropes", "planar", all_ways(), swing});
const Register spatial({"chattering_ropes", "spatial", all_ways(), swing});

}  // namespace
}  // namespace cdot::hard
