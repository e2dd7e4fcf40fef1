// The pendulum of 1 m, released at 90 degrees: its motion in closed form, as a reference of 2 s.
#pragma once

#include <cmath>
#include <numbers>

#include "runtime/tool/accuracy/reference.hpp"
#include "tests/runtime/tool/support.hpp"

namespace cdot::test {

// From rest at 90 degrees: sin(angle / 2) = k sn(K + w t, k) with k = sin 45 degrees; sn(u) = sin(phi) with F(phi) = u.
inline BodyState bob_at(double t) {
  const double k = std::sin(std::numbers::pi / 4), u = std::comp_ellint_1(k) + std::sqrt(9.81) * t;
  double phi = u * std::numbers::pi / 2 / std::comp_ellint_1(k);
  for (int round = 0; round < 50; ++round)
    phi -= (std::ellint_1(k, phi) - u) * std::sqrt(1 - k * k * std::sin(phi) * std::sin(phi));
  const double angle = 2 * std::asin(k * std::sin(phi));
  BodyState bob{};
  bob.x = std::sin(angle);
  bob.y = -std::cos(angle);
  return bob;
}

inline Scene pendulum_scene() {
  Scene scene = scene_named("simple_pendulum");
  scene.duration = 2;
  return scene;
}

inline ReferenceRun closed_form() {
  ReferenceRun reference;
  reference.times = equal_times(2, sample_count);
  for (const double time : reference.times) {
    Frame& frame = reference.frames.emplace_back();
    frame.time = time;
    frame.bodies.push_back(bob_at(time));
    frame.energy = 0;  // released where the potential is 0
  }
  return reference;
}

}  // namespace cdot::test
