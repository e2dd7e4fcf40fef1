// A pendulum in eight steps a swing.
#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::very_large_step {
namespace {

void swing(Trial& t, double step) {
  t.start();
  const Watch w = t.run(100, step);
  t.at_most("gap [m]", w.gap, 1e-3);
  t.at_most("energy gained, of 4.905 J", w.rise / (0.5 * g), 0.01);
}
void tenth(Trial& t) { swing(t, 0.1); }
void quarter(Trial& t) { swing(t, 0.25); }

const Register planar({"very_large_step", "planar", without(all_ways(), {Integrator::euler}), tenth, "0.1 s"});
const Register spatial({"very_large_step", "spatial", without(all_ways(), {Integrator::euler}), tenth, "0.1 s"});
const Register planar_quarter({"very_large_step", "planar",
                               only(direct(), {Integrator::euler, Integrator::rattle}) +
                                   only(all_ways(), {Integrator::implicit, Integrator::dop853}),
                               quarter, "0.25 s"});
const Register spatial_quarter({"very_large_step", "spatial",
                                direct() +
                                    only(iterative(), {Integrator::implicit, Integrator::rk4, Integrator::dop853}),
                                quarter, "0.25 s"});

}  // namespace
}  // namespace cdot::hard::very_large_step
