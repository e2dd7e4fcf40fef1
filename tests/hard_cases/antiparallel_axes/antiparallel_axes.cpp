// Axes that point against each other are parallel, but angles measured about them are not defined.
#include <cmath>

#include "tests/hard_cases/trial.hpp"

namespace cdot::hard {
namespace {

void swing(Trial& t) {
  t.start();
  const Watch w = t.run(5);
  const BodyState b = t.body("door");
  t.at_most("gap [m, rad]", w.gap, 1e-6, 1e-4);
  t.near("spin [rad/s]", b.wz, 2, 1e-9, 1e-3);
  t.at_most("leans by [rad]", 2 * std::hypot(b.e1, b.e2), 1e-9, 1e-4);
}

const Register spatial({"antiparallel_axes", "spatial", without(all_ways(), {Integrator::implicit}), swing});

}  // namespace
}  // namespace cdot::hard
