// Two of the three Cardan angles coincide.
#include <algorithm>
#include <cmath>

#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::gimbal_lock {
namespace {

// The arm rotates about one axis at 1 rad/s: the other two components of its orientation stay 0.
void universal(Trial& t) {
  t.start();
  double locked = 0, off = 0;
  const Watch w = t.run(3, 0, [&] {
    const BodyState b = t.body("arm");
    locked = std::max(locked, 2 * std::hypot(b.e1, b.e2));
    const double angle = 2 * std::atan2(b.e3, b.e0);
    off = std::max(off, std::abs(std::remainder(angle - t.time(), 2 * pi)));
  });
  t.at_most("locked angles [rad]", locked, 1e-3);
  t.at_most("driven angle off [rad]", off, 1e-2);
  t.at_most("gap [m, rad]", w.gap, 1e-3);
}

// The locks allow rotation about y only, past 90 degrees to 172.
void six_dof(Trial& t) {
  t.start();
  double locked = 0;
  t.run(3, 0, [&] {
    const BodyState b = t.body("arm");
    locked = std::max(locked, 2 * std::hypot(b.e1, b.e3));
  });
  const BodyState b = t.body("arm");
  t.at_most("locked angles [rad]", locked, 1e-3);
  t.near("free angle [rad]", 2 * std::atan2(b.e2, b.e0), 3, 1e-2);
}

const Register a_universal({"gimbal_lock", "universal", all_ways(), universal});
const Register a_six_dof({"gimbal_lock", "six_dof", all_ways(), six_dof});

}  // namespace
}  // namespace cdot::hard::gimbal_lock
