// 20 rows of rank 5: the door swings, and its load is carried, as with one hinge.
#include <array>
#include <cmath>

#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::redundant_hinges {
namespace {

// The sum of all hinges' forces on the door.
std::array<double, 3> reaction(const Trial& t) {
  return t.ask([](const auto& world) {
    std::array<double, 3> sum{};
    for (int joint = 0; joint < world.joint_count(); ++joint) {
      const auto wrench = world.reaction(joint, 0);
      if constexpr (requires { wrench.force_z; })
        sum = {sum[0] + wrench.force_x, sum[1] + wrench.force_y, sum[2] + wrench.force_z};
    }
    return sum;
  });
}

void swing(Trial& four) {
  Trial one("redundant_hinges/spatial", four.way);
  one.scene.joints.resize(1);
  one.start();
  four.start();
  double apart = 0, force = 0;
  for (int k = 0; k < 600; ++k) {
    one.step(h);
    four.step(h);
    apart = std::max(apart, std::abs(std::remainder(one.coordinate(0, "angle") - four.coordinate(0, "angle"), 2 * pi)));
    const auto a = reaction(one), b = reaction(four);
    force = std::max(force, std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]) / std::hypot(a[0], a[1], a[2]));
  }
  four.at_most("apart from one hinge [rad]", apart, 1e-6, 1e-3);
  four.at_most("their force, relative", force, 1e-6, 1e-3);
  four.at_most("gap [m]", four.gap(), 1e-6, 1e-5);
}

const Register spatial({"redundant_hinges", "spatial", direct() + without(iterative(), {Integrator::implicit}), swing});

}  // namespace
}  // namespace cdot::hard::redundant_hinges
