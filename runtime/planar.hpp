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

  // M a: what a force would have to be
  static Velocity force(const InverseMass& m, const Velocity& a) {
    return {inverse(m.m) * a.x, inverse(m.m) * a.y, inverse(m.I) * a.w};
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

  // A spring with damping from a point of body a to a point of body b, given in their frames.
  struct PointSpring {
    int body_a, body_b;
    T ax, ay, bx, by;
    T stiffness, rest_length, damping;
  };
  // Length, and the direction from a to b together with the arms: what its force and its energy
  // need.
  struct Stretch {
    T length, x, y;  // direction of length 1; zero where the points coincide
    T arm_a, arm_b;  // r x direction: the levers of a pull along it
  };
  static Stretch stretch(const PointSpring& spring, const Pose& a, const Pose& b) {
    const T ra_x = a.c * spring.ax - a.s * spring.ay, ra_y = a.s * spring.ax + a.c * spring.ay;
    const T rb_x = b.c * spring.bx - b.s * spring.by, rb_y = b.s * spring.bx + b.c * spring.by;
    const T dx = (b.x - a.x) + (rb_x - ra_x), dy = (b.y - a.y) + (rb_y - ra_y);
    const T length = std::sqrt(dx * dx + dy * dy), scale = inverse(length);
    const T x = dx * scale, y = dy * scale;
    return {length, x, y, ra_x * y - ra_y * x, rb_x * y - rb_y * x};
  }
  // The pull on a; b gets the opposite. tension = stiffness (length - rest) + damping d(length)/dt
  static T tension(const PointSpring& spring, const Stretch& s, const Velocity& a,
                   const Velocity& b) {
    const T rate = s.x * (b.x - a.x) + s.y * (b.y - a.y) + s.arm_b * b.w - s.arm_a * a.w;
    return spring.stiffness * (s.length - spring.rest_length) + spring.damping * rate;
  }
  static Velocity pull_on_a(const Stretch& s, T f) { return {f * s.x, f * s.y, f * s.arm_a}; }
  static Velocity pull_on_b(const Stretch& s, T f) { return {-f * s.x, -f * s.y, -f * s.arm_b}; }

  static Velocity from(const T (&numbers)[freedom]) { return {numbers[0], numbers[1], numbers[2]}; }

  // I + h stiffness. Only what stiffens (tension), and only the turning: linear momentum stays what
  // it is.
  static InverseMass stiffened(const InverseMass& m, const Velocity& stiffness, T h) {
    const T added = select(stiffness.w > T(0), h * stiffness.w, T(0));
    return {m.m, m.I / (T(1) + added * m.I)};
  }

  static Velocity gravity(T x, T y) { return {x, y, T(0)}; }

  static InverseMass unit_mass() { return {T(1), T(1)}; }

  static bool immovable(const InverseMass& m) { return m.m == 0 && m.I == 0; }
};

}  // namespace cdot
