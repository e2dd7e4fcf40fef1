// Antiparallel axes are parallel, but angles about them are undefined.
#include <cmath>

#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::antiparallel_axes {
namespace {

void swing(Trial& t) {
  t.start();
  const Watch w = t.run(5);
  const BodyState b = t.body("door");
  t.at_most("gap [m, rad]", w.gap, 1e-6, 1e-4);
  t.near("spin [rad/s]", b.wz, 2, 1e-9, 1e-3);
  t.at_most("leans by [rad]", 2 * std::hypot(b.e1, b.e2), 1e-9, 1e-4);
}

// An angle between antiparallel axes has no value for a motor: refused, with a fix.
void motor(Trial& t) {
  SceneJoint& hinge = t.scene.joints.front();
  hinge.definition.type = "hinge";
  hinge.effects.push_back({"angle", {}, Motor{1, 10}, {}, {}});
  t.at_most("accepted", t.refused("Turn one of the joint's frames round") ? 0 : 1, 0);
}

const Register spatial({"antiparallel_axes", "spatial", without(all_ways(), {Integrator::implicit}), swing});
const Register spatial_motor({"antiparallel_axes", "spatial", all_ways(), motor, "a motor"});

}  // namespace
}  // namespace cdot::hard::antiparallel_axes
