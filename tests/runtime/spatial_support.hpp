// Helpers for tests of Worlds in space.
#pragma once

#include <array>
#include <cmath>

#include <cdot/rotation.hpp>

#include "tests/runtime/support.hpp"

namespace cdot::test {

struct SpatialMomentum {
  spatial::Vector<double> linear{}, angular{};  // about the origin
};

template <class T>
SpatialMomentum momentum(const SpatialWorld<T>& world) {
  SpatialMomentum sum;
  for (int i = 0; i < world.body_count(); ++i) {
    const auto m = world.inverse_mass(i);
    if (m.m == 0) continue;
    const auto q = world.pose(i);
    const auto v = world.velocity(i);
    const spatial::Symmetric<double> inverse_inertia = {m.Ixx, m.Iyy, m.Izz, m.Ixy, m.Ixz, m.Iyz};
    const spatial::Vector<double> x = {q.x, q.y, q.z};
    const spatial::Vector<double> p = (1.0 / double(m.m)) * spatial::Vector<double>{v.x, v.y, v.z};
    sum.linear = sum.linear + p;
    sum.angular =
        sum.angular + cross(x, p) + spatial::inverse(inverse_inertia) * spatial::Vector<double>{v.wx, v.wy, v.wz};
  }
  return sum;
}

// The errors of |e| = 1 and of A as a rotation matrix.
template <class T>
double off_unit(const spatial::Pose<T>& q) {
  const double length =
      std::sqrt(double(q.e0) * q.e0 + double(q.e1) * q.e1 + double(q.e2) * q.e2 + double(q.e3) * q.e3);
  const spatial::Vector<double> x = {q.xx, q.yx, q.zx}, y = {q.xy, q.yy, q.zy}, z = {q.xz, q.yz, q.zz};
  const double off =
      std::max({std::abs(dot(x, y)), std::abs(norm(cross(x, y) - z)), std::abs(norm(x) - 1), std::abs(length - 1)});
  return off < 4 * std::numeric_limits<T>::epsilon() ? 0 : off;
}

inline SpatialBodyDefinition brick(double x, double y, double z, double mass = 1) {
  SpatialBodyDefinition d;
  d.x = x, d.y = y, d.z = z;
  d.mass = mass;
  d.inertia = {0.1 * mass, 0.2 * mass, 0.25 * mass, 0.01 * mass, 0, 0.02 * mass};
  return d;
}

template <class T>
int join(SpatialWorld<T>& world, const char* type, int a, int b, std::vector<NamedValue> values,
         std::optional<Softness> soft = {}) {
  return world.add_joint({type, {a, b}, std::move(values), soft});
}

// Four bricks in free space: ball joints, a hinge with a motor and a limit, a soft joint, a spring.
template <class T>
void add_free_mechanism(SpatialWorld<T>& world) {
  std::vector<int> bricks;
  for (int i = 0; i < 4; ++i) bricks.push_back(world.add_body(brick(i, 0.1 * i, 0, 1 + 0.5 * i)));
  join(world, "spherical", bricks[0], bricks[1], {{"pa", {0.5, 0.1, 0.2}}});
  const int hinge = join(world, "hinge", bricks[1], bricks[2], {{"pa", {0.5, 0, 0}}, {"fa", {0.3, 0.2, 1}}});
  join(world, "spherical", bricks[2], bricks[3], {{"pa", {0.5, 0, 0.3}}});
  add_motor(world, hinge, "angle", {.speed = 2, .max_force = 0.5});
  add_limit(world, hinge, "angle", {.lower = -3, .upper = 3});
  join(world, "distance", bricks[0], bricks[2], {{"pa", {0, 0, 0}}, {"pb", {0, 0, 0}}},
       Softness{.by_frequency = true, .frequency = 3, .damping_ratio = 0.2});
  SpringDefinition spring;
  spring.body_a = bricks[0], spring.body_b = bricks[3];
  spring.ay = 0.2, spring.stiffness = 5, spring.rest_length = 2, spring.damping = 0.3;
  world.add_spring(spring);
  world.apply_impulse(bricks[0], {1, 2, -0.5, 0.5, 0.1, 0.2});
  world.apply_impulse(bricks[3], {-3, 1, 0.5, -0.2, 0.4, 0.1});
}

// A ring of four hinges between two uprights that turns as a parallelogram, the last axis tilted by `tilt`: rigid if
// the tilt is taken literally. Returns the left, the top and the right bar.
inline std::array<int, 3> add_tilted_ring(SpatialWorld<double>& world, double tilt) {
  const auto bar = [&](double x, double z, double angle) {
    return world.add_body({.x = x,
                           .z = z,
                           .e0 = std::cos(angle / 2),
                           .e2 = -std::sin(angle / 2),
                           .mass = 1,
                           .inertia = {.xx = 0.01, .yy = 0.08, .zz = 0.08}});
  };
  const int left = bar(0, 0.5, pi / 2), top = bar(0.5, 1, 0), right = bar(1, 0.5, pi / 2);
  const auto hinge = [&](int a, int b, std::vector<double> pa, std::vector<double> pb, double off) {
    world.add_joint({"revolute", {a, b}, {{"pa", pa}, {"pb", pb}, {"fa", {std::sin(off), -std::cos(off), 0}}}, {}});
  };
  hinge(world.ground(), left, {0, 0, 0}, {-0.5, 0, 0}, 0);
  hinge(world.ground(), right, {1, 0, 0}, {-0.5, 0, 0}, 0);
  hinge(top, left, {-0.5, 0, 0}, {0.5, 0, 0}, 0);
  hinge(top, right, {0.5, 0, 0}, {0.5, 0, 0}, tilt);
  return {left, top, right};
}

}  // namespace cdot::test
