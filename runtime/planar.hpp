// Everything that the runtime knows about the plane: what a pose is, how it moves, what a velocity
// weighs. The solvers see only this struct's members, so another dimension is another struct like
// it.
#pragma once

#include <cmath>

#include "runtime/kernel.hpp"

namespace cdot {

template <class T>
struct Planar {
  using Scalar = T;
  using Pose = planar::Pose<T>;
  using Velocity =
      planar::Velocity<T>;  // also a displacement, an acceleration, or an impulse by components
  using InverseMass = planar::InverseMass<T>;
  static constexpr int freedom = 3;  // numbers in a Velocity

  static Pose pose(T x, T y, T angle) { return {x, y, std::cos(angle), std::sin(angle), angle}; }

  // c and s are recomputed from the angle: composing rotations would let them leave the unit
  // circle.
  static Pose moved(const Pose& q, const Velocity& d) {
    return pose(q.x + d.x, q.y + d.y, q.angle + d.w);
  }

  // v + scale * d
  static Velocity sum(const Velocity& v, const Velocity& d, T scale) {
    return {v.x + scale * d.x, v.y + scale * d.y, v.w + scale * d.w};
  }

  static Velocity difference(const Pose& q, const Pose& start) {
    return {q.x - start.x, q.y - start.y, q.angle - start.angle};
  }

  // M^-1 f
  static Velocity weighted(const InverseMass& m, const Velocity& f) {
    return {m.m * f.x, m.m * f.y, m.I * f.w};
  }

  static Velocity damped(const Velocity& v, T linear, T angular) {
    return {v.x * linear, v.y * linear, v.w * angular};
  }

  static double dot(const Velocity& f, const Velocity& v) {
    return double(f.x) * double(v.x) + double(f.y) * double(v.y) + double(f.w) * double(v.w);
  }

  static bool slower(const Velocity& v, T speed) {
    return v.x * v.x + v.y * v.y < speed * speed && std::fabs(v.w) < speed;
  }

  static InverseMass unit_mass() { return {T(1), T(1)}; }

  static bool immovable(const InverseMass& m) { return m.m == 0 && m.I == 0; }
};

}  // namespace cdot
