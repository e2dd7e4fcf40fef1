// Exact copies of a joint: 18 of 20 rows, or 45 of 50, are redundant.
#include <algorithm>
#include <cmath>

#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::same_joint_ten_times {
namespace {

void swing(Trial& ten, const char* scene) {
  Trial one(std::string("same_joint_ten_times/") + scene, ten.way);
  one.scene.joints.resize(1);
  one.start();
  ten.start();
  double apart = 0;
  for (int k = 0; k < 600; ++k) {
    one.step(h);
    ten.step(h);
    const BodyState a = one.body("rod"), b = ten.body("rod");
    apart = std::max({apart, std::hypot(a.x - b.x, a.y - b.y, a.z - b.z), std::abs(a.angle - b.angle)});
  }
  ten.at_most("apart from one joint [m, rad]", apart, 1e-9, 1e-3);
}

const Register planar({"same_joint_ten_times", "planar", all_ways(), [](Trial& t) { swing(t, "planar"); }});
const Register spatial({"same_joint_ten_times", "spatial", all_ways(), [](Trial& t) { swing(t, "spatial"); }});

}  // namespace
}  // namespace cdot::hard::same_joint_ten_times
