// Angle rows between bodies with zero inverse inertia: K has zeros on its diagonal.
#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::bodies_that_cannot_turn {
namespace {

void hold(Trial& t) {
  t.start();
  const Watch w = t.run(5);
  t.at_most("gap [m]", w.gap, 1e-6);
  t.near("wall's force, relative", t.force(0) / (2 * g), 1, 1e-6, 1e-4);
}
// Without the wall they fall together.
void fall(Trial& t) {
  t.scene.joints.erase(t.scene.joints.begin());
  t.start();
  const Watch w = t.run(2);
  t.at_most("gap [m]", w.gap, 1e-6, 1e-4);
}

const Register planar({"bodies_that_cannot_turn", "planar", direct() + without(iterative(), {Integrator::rattle}),
                       hold});
const Register spatial({"bodies_that_cannot_turn", "spatial", direct() + without(iterative(), {Integrator::rattle}),
                        hold});
const Register planar_fall({"bodies_that_cannot_turn", "planar", all_ways(), fall, "falling"});
const Register spatial_fall({"bodies_that_cannot_turn", "spatial", all_ways(), fall, "falling"});

}  // namespace
}  // namespace cdot::hard::bodies_that_cannot_turn
