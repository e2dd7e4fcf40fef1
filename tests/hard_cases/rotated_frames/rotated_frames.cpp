// Joints between bodies whose frames differ by all multiples of 45 degrees.
#include <algorithm>
#include <cmath>

#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::rotated_frames {
namespace {

void stay(Trial& t) {
  t.start();
  const Frame start = t.frame();
  t.run(5);
  const Frame end = t.frame();
  double moved = 0, turned = 0;
  for (std::size_t k = 0; k < end.bodies.size(); ++k) {
    const BodyState &a = start.bodies[k], &b = end.bodies[k];
    moved = std::max(moved, std::hypot(a.x - b.x, a.y - b.y, a.z - b.z));
    // |q - p| is half the angle of a small rotation.
    turned =
        std::max(turned, 2 * std::hypot(std::hypot(a.e0 - b.e0, a.e1 - b.e1), std::hypot(a.e2 - b.e2, a.e3 - b.e3)));
  }
  t.at_most("moved [m]", moved, 1e-9, 1e-5);
  t.at_most("turned [rad]", turned, 1e-9, 1e-5);
}

const Register spatial({"rotated_frames", "spatial", all_ways(), stay});

}  // namespace
}  // namespace cdot::hard::rotated_frames
