// Twenty effects act as two of tenfold strength, though ten of their rows depend on each other.
#include <algorithm>
#include <cmath>

#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::many_effects {
namespace {

void turn(Trial& t) {
  CoordinateEffects many{.coordinate = "angle"};
  for (int k = 0; k < 10; ++k) {
    many.specs.push_back({"brake", {{"torque", {0.07}}}});
    many.specs.push_back({"dc_motor", {{"stall", {1}}, {"idle", {4}}}});
  }
  t.scene.joints[1].effects.push_back(many);
  t.start();
  double apart = 0;
  t.run(5, 0, [&] { apart = std::max(apart, std::abs(t.coordinate(0, "angle") - t.coordinate(1, "angle"))); });
  t.at_most("apart [rad]", apart, 1e-6, 1e-3);
  const auto rate = [&](int joint) {
    return t.ask([&](const auto& world) { return double(world.coordinate_rate(joint, "angle")); });
  };
  // 10 (1 - w/4) + 1 - 0.7 = 0
  t.near("their speed [rad/s]", rate(1), 4.12, 1e-3);
}

const Register planar({"many_effects", "planar", all_ways(), turn});
const Register spatial({"many_effects", "spatial", all_ways(), turn});

}  // namespace
}  // namespace cdot::hard::many_effects
