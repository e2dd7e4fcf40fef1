// 41 joints with a mass ratio of 672 at their end.
#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::ball_and_chain {
namespace {

void swing(Trial& t) {
  t.start();
  const Watch w = t.run(10);
  t.at_most("gap [m]", w.gap, 5e-3);
}

void rest(Trial& t) {
  t.start();
  t.run(1);
  t.near("top joint, relative to its load", t.force(0) / 41795.6, 1, 1e-3);
}

const Register planar({"ball_and_chain", "planar", only(direct(), {Integrator::implicit}), swing});
const Register spatial({"ball_and_chain", "spatial", only(direct(), {Integrator::implicit}), swing});
const Register planar_at_rest({"ball_and_chain", "planar_at_rest",
                               only(direct(), {Integrator::implicit, Integrator::rk4, Integrator::dop853}) +
                                   in_double(direct()),
                               rest});

}  // namespace
}  // namespace cdot::hard::ball_and_chain
