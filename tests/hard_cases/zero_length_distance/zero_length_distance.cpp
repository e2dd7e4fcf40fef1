// The direction of a distance joint is 0/0 where its points coincide.

#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::zero_length_distance {
namespace {

void coincident_start(Trial& t) {
  t.start();
  const Watch w = t.run(5);
  t.at_most("gap [m]", w.gap, 1e-4);
}

// A length of 0 has no direction on C = 0: refused, with a replacement.
void length_zero(Trial& t) {
  for (SceneJoint& joint : t.scene.joints)
    for (NamedValue& value : joint.definition.parameters)
      if (value.name == "l") value.numbers = {0};
  t.at_most("accepted", t.refused("Hold the points together") ? 0 : 1, 0);
}

const Register planar({"zero_length_distance", "planar", all_ways(), coincident_start});
const Register spatial({"zero_length_distance", "spatial", all_ways(), coincident_start});
const Register planar_zero({"zero_length_distance", "planar", all_ways(), length_zero, "length 0"});
const Register spatial_zero({"zero_length_distance", "spatial", all_ways(), length_zero, "length 0"});

}  // namespace
}  // namespace cdot::hard::zero_length_distance
