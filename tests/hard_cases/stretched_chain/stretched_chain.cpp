// A start that violates every joint by a metre.
#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::stretched_chain {
namespace {

void snap(Trial& t) {
  t.start();
  const Watch w = t.run(1);
  t.at_most("gap after 1 s [m]", t.gap(), 5e-3);
  t.at_most("speed [m/s]", w.speed, 40);
  // Potential energy of the chain above the vertical pose.
  const double mass = 40 * 0.12566370614359174;
  t.at_most("energy gained, of the fall's", w.rise / (mass * g * 40), 0.01);
}

const Register planar({"stretched_chain", "planar", direct(), snap});
const Register spatial({"stretched_chain", "spatial", direct(), snap});

}  // namespace
}  // namespace cdot::hard::stretched_chain
