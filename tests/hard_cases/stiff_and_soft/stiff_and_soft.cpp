// Springs of 1e8 N/m, of 1e4 rad/s, beside soft ones.
#include <cmath>

#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::stiff_and_soft {
namespace {

void hang(Trial& t) {
  t.start();
  const Watch w = t.run(20);
  t.near("sag at 1e8 N/m [m]", -t.body("box1").y, g / 1e8, 1e-9, 1e-6);
  t.near("sag at 10 N/m [m]", -t.body("box2").y, g / 10, 1e-3);
  t.near("sag on a soft pin of 1e8 N/m [m]", -t.body("box4").y, g / 1e8, 1e-9, 1e-6);
  t.at_most("energy gained [J]", w.rise, 1e-3);
}

const Register planar({"stiff_and_soft", "planar", only(all_ways(), {Integrator::euler, Integrator::implicit}), hang});

}  // namespace
}  // namespace cdot::hard::stiff_and_soft
