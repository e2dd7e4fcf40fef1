// Vectors and quaternions as plain arrays, for all adapters.
#pragma once

#include <algorithm>
#include <cmath>

#include "tests/bench/peers/peer.hpp"

namespace cdot::peers {

inline Vec3 operator+(const Vec3& a, const Vec3& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Vec3 operator-(const Vec3& a, const Vec3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Vec3 operator*(double s, const Vec3& a) { return {s * a[0], s * a[1], s * a[2]}; }
inline double dot(const Vec3& a, const Vec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline double norm(const Vec3& a) { return std::sqrt(dot(a, a)); }

inline Quaternion conjugate(const Quaternion& q) { return {q[0], -q[1], -q[2], -q[3]}; }
inline Quaternion operator*(const Quaternion& p, const Quaternion& q) {
  return {p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3], p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
          p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1], p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0]};
}
// The vector u rotated by the unit quaternion q.
inline Vec3 turned(const Quaternion& q, const Vec3& u) {
  const Vec3 e{q[1], q[2], q[3]}, t = 2.0 * cross(e, u);
  return u + q[0] * t + cross(e, t);
}

// A point or a direction of the world in a body's frame; unchanged for the world.
inline Vec3 local_point(const Problem& problem, int body, const Vec3& p) {
  if (body == world) return p;
  const State& s = problem.bodies[std::size_t(body)].start;
  return turned(conjugate(s.q), p - s.x);
}
inline Vec3 local_direction(const Problem& problem, int body, const Vec3& u) {
  if (body == world) return u;
  return turned(conjugate(problem.bodies[std::size_t(body)].start.q), u);
}

// The rotations of a joint in order. A single free rotation may come first, because the middle angle is singular at a
// right angle.
inline std::vector<Turn> turns_of(const Joint& joint, bool free_first) {
  std::vector<Turn> turns = joint.turns;
  if (free_first && joint.kind == JointKind::six_dof)
    std::rotate(turns.begin(), std::find_if(turns.begin(), turns.end(), [](const Turn& t) { return !t.held; }),
                turns.end());
  return turns;
}

// The force and the torque that damp a body's motion.
struct Push {
  Vec3 force{}, torque{};
};
inline Push damping(const Body& body, const State& s) {
  Vec3 spin = turned(conjugate(s.q), s.w);
  for (std::size_t k = 0; k < 3; ++k) spin[k] *= body.inertia[k];
  return {(-body.damping * body.mass) * s.v, -body.damping * turned(s.q, spin)};
}

// The angle of a planar pose.
inline double angle(const Quaternion& q) { return 2 * std::atan2(q[3], q[0]); }
inline Quaternion about_z(double angle) { return {std::cos(angle / 2), 0, 0, std::sin(angle / 2)}; }

// The angle of the shortest rotation between two orientations, accurate for tiny angles.
inline double angle_between(const Quaternion& p, const Quaternion& q) {
  const Quaternion d = conjugate(p) * q;
  return 2 * std::atan2(std::sqrt(d[1] * d[1] + d[2] * d[2] + d[3] * d[3]), std::fabs(d[0]));
}

}  // namespace cdot::peers
