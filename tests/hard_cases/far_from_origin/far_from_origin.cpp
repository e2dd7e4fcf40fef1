// 1000 km away: positions lose digits, joints do not.
#include <algorithm>
#include <cmath>

#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::far_from_origin {
namespace {

void swing(Trial& there, const char* scene) {
  Trial here(std::string("far_from_origin/") + scene, there.way);
  for (SceneBody& body : here.scene.bodies)
    for (double* x : {&body.definition.x, &body.definition.y, &body.spatial.x, &body.spatial.z})
      if (*x != 0) *x -= 1e6;
  for (SceneJoint& joint : here.scene.joints)
    for (NamedValue& value : joint.definition.parameters)
      for (double& number : value.numbers)
        if (std::abs(number) > 1e5) number -= 1e6;
  here.start();
  there.start();
  double apart = 0, gap = 0;
  for (int k = 0; k < 600; ++k) {
    here.step(h);
    there.step(h);
    const BodyState a = here.body("rod"), b = there.body("rod");
    const double up = here.scene.dimension == Dimension::planar ? b.y - 1e6 - a.y : b.z - 1e6 - a.z;
    apart = std::max(apart, std::hypot(b.x - 1e6 - a.x, up));
    gap = std::max(gap, there.gap());
  }
  there.at_most("apart from the origin's [m]", apart, 1e-9, 0.2);
  there.at_most("gap [m]", gap, 1e-9, 1e-5);
}

const Register planar({"far_from_origin", "planar", all_ways(), [](Trial& t) { swing(t, "planar"); }});
const Register spatial({"far_from_origin", "spatial", all_ways(), [](Trial& t) { swing(t, "spatial"); }});

}  // namespace
}  // namespace cdot::hard::far_from_origin
