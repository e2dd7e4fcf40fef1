// Many closed loops, driven for a minute: drift would accumulate.
#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::closed_loops {
namespace {

void walk(Trial& t) {
  t.start();
  const Watch w = t.run(60);
  t.at_most("gap [m]", w.gap, 1e-4);
  t.near("turns of the crank", t.coordinate(t.joint_named("motor"), "angle") / 120, 1, 0.01);
}

const Register planar({"closed_loops", "planar", direct(), walk});
const Register spatial({"closed_loops", "spatial", direct(), walk});

}  // namespace
}  // namespace cdot::hard::closed_loops
