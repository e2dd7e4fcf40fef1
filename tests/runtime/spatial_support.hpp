// What tests of Worlds in space share.
#pragma once

#include "runtime/rotation.hpp"
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
    sum.angular = sum.angular + cross(x, p) +
                  spatial::inverse(inverse_inertia) * spatial::Vector<double>{v.wx, v.wy, v.wz};
  }
  return sum;
}

// How far the quaternion is from a unit one, and A from a rotation.
template <class T>
double off_unit(const spatial::Pose<T>& q) {
  const double length = std::sqrt(double(q.e0) * q.e0 + double(q.e1) * q.e1 + double(q.e2) * q.e2 +
                                  double(q.e3) * q.e3);
  const spatial::Vector<double> x = {q.xx, q.yx, q.zx}, y = {q.xy, q.yy, q.zy},
                                z = {q.xz, q.yz, q.zz};
  const double off = std::max({std::abs(dot(x, y)), std::abs(norm(cross(x, y) - z)),
                               std::abs(norm(x) - 1), std::abs(length - 1)});
  return off < 4 * std::numeric_limits<T>::epsilon() ? 0 : off;
}

template <class T>
void run(SpatialWorld<T>& world, double duration, double h) {
  const long steps = std::lround(duration / h);
  for (long i = 0; i < steps; ++i) world.step(h);
}

}  // namespace cdot::test
