// Poses, velocities and forces of both spaces as vectors of space. In the plane z of places and x, y of turns are 0.
#pragma once

#include <cdot/planar.hpp>
#include <cdot/rotation.hpp>
#include <cdot/spatial.hpp>

namespace cdot {

// Linear and angular part of a velocity, or of an impulse or force.
template <class T>
struct Twist {
  spatial::Vector<T> linear, angular;
};

template <class R, class T>
spatial::Vector<R> position(const planar::Pose<T>& q) {
  return {R(q.x), R(q.y), R(0)};
}
template <class R, class T>
spatial::Vector<R> position(const spatial::Pose<T>& q) {
  return {R(q.x), R(q.y), R(q.z)};
}

template <class R, class T>
Twist<R> twist(const planar::Velocity<T>& v) {
  return {{R(v.x), R(v.y), R(0)}, {R(0), R(0), R(v.w)}};
}
template <class R, class T>
Twist<R> twist(const spatial::Velocity<T>& v) {
  return {{R(v.x), R(v.y), R(v.z)}, {R(v.wx), R(v.wy), R(v.wz)}};
}

template <class S, class R>
typename S::Velocity velocity(const Twist<R>& t) {
  using T = typename S::Scalar;
  if constexpr (S::dimension == Dimension::planar) return {T(t.linear.x), T(t.linear.y), T(t.angular.z)};
  else return {T(t.linear.x), T(t.linear.y), T(t.linear.z), T(t.angular.x), T(t.angular.y), T(t.angular.z)};
}

}  // namespace cdot
