// Bodies in space for tests of effects.
#pragma once

#include "tests/runtime/effects/generated_effects.hpp"
#include "tests/runtime/spatial_support.hpp"

namespace cdot::test::in_space {

using spatial::Vector;

inline constexpr double g = 9.81;

inline Settings free_fall(Integrator integrator, double gravity = 0) {
  Settings s = effects::with(integrator);
  s.gravity_z = -gravity;
  return s;
}

struct Start {
  Vector<double> x{}, v{}, w{};
  double mass = 2, inertia = 0.5;
};
inline int ball(SpatialWorld<double>& world, const Start& at) {
  SpatialBodyDefinition d;
  d.x = at.x.x, d.y = at.x.y, d.z = at.x.z, d.vx = at.v.x, d.vy = at.v.y, d.vz = at.v.z;
  d.wx = at.w.x, d.wy = at.w.y, d.wz = at.w.z;
  d.mass = at.mass, d.inertia = {at.inertia, at.inertia, at.inertia};
  return world.add_body(d);
}

inline Vector<double> place_of(const SpatialWorld<double>& world, int body) {
  const auto q = world.pose(body);
  return {q.x, q.y, q.z};
}

// steps = 1/h of them over the duration.
inline void run(SpatialWorld<double>& world, double duration, double h) {
  const long steps = std::lround(1 / h);
  for (long n = 0; n < steps; ++n) EXPECT_TRUE(world.step(duration / static_cast<double>(steps)));
}

}  // namespace cdot::test::in_space
