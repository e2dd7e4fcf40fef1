// The motion of a World at one moment: momenta, kinetic energy, changes of velocity.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include <cdot/rotation.hpp>
#include <cdot/world.hpp>

namespace cdot::torture {

// The motion of one body, in doubles, in world axes.
struct BodyMotion {
  double mass = 0;
  std::array<double, 3> x{}, v{}, w{}, spin{};  // spin: its angular momentum about its own centre
  spatial::Symmetric<double> inertia{};
  spatial::Pose<double> pose{};
};

struct Motion {
  std::vector<BodyMotion> bodies;             // movable ones
  std::array<double, 3> linear{}, angular{};  // momenta; angular about the origin
  double linear_size = 0, angular_size = 0;   // sums of the bodies' absolute momenta, the scale of round-off
  double spin_size = 0, root_mass = 0;        // sum of the bodies' own angular momenta; root of the sum of masses
  double kinetic = 0;
};

template <class T>
BodyMotion motion_of(const planar::Pose<T>& q, const planar::Velocity<T>& v, const planar::InverseMass<T>& m) {
  BodyMotion body;
  body.mass = 1 / double(m.m);
  body.inertia.zz = m.I > 0 ? 1 / double(m.I) : 0;
  const double half = double(q.angle) / 2;
  body.pose = spatial::oriented<double>(q.x, q.y, 0, std::cos(half), 0, 0, std::sin(half));
  body.x = {q.x, q.y, 0}, body.v = {v.x, v.y, 0}, body.w = {0, 0, v.w};
  return body;
}
template <class T>
BodyMotion motion_of(const spatial::Pose<T>& q, const spatial::Velocity<T>& v, const spatial::InverseMass<T>& m) {
  BodyMotion body;
  body.mass = 1 / double(m.m);
  body.inertia = spatial::inverse(spatial::Symmetric<double>{m.Ixx, m.Iyy, m.Izz, m.Ixy, m.Ixz, m.Iyz});
  body.pose = spatial::oriented<double>(q.x, q.y, q.z, q.e0, q.e1, q.e2, q.e3);
  body.x = {q.x, q.y, q.z}, body.v = {v.x, v.y, v.z}, body.w = {v.wx, v.wy, v.wz};
  return body;
}

inline std::array<double, 3> times(const spatial::Symmetric<double>& I, const std::array<double, 3>& w) {
  const spatial::Vector<double> L = I * spatial::Vector<double>{w[0], w[1], w[2]};
  return {L.x, L.y, L.z};
}
inline double dot(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline double norm(const std::array<double, 3>& a) { return std::sqrt(dot(a, a)); }

template <class S>
Motion motion_of(const BasicWorld<S>& world) {
  Motion motion;
  for (int i = 0; i < world.body_count(); ++i) {
    if (world.is_static(i)) continue;
    BodyMotion body = motion_of(world.pose(i), world.velocity(i), world.inverse_mass(i));
    body.spin = times(body.inertia, body.w);
    const auto &x = body.x, &v = body.v;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t a = (k + 1) % 3, b = (k + 2) % 3;
      motion.linear[k] += body.mass * v[k];
      motion.angular[k] += body.mass * (x[a] * v[b] - x[b] * v[a]) + body.spin[k];
    }
    motion.linear_size += body.mass * norm(v);
    motion.angular_size += body.mass * norm(x) * norm(v) + norm(body.spin);
    motion.spin_size += norm(body.spin);
    motion.root_mass = std::sqrt(motion.root_mass * motion.root_mass + body.mass);
    motion.kinetic += 0.5 * body.mass * dot(v, v) + 0.5 * dot(body.w, body.spin);
    motion.bodies.push_back(body);
  }
  return motion;
}

// True if a body is so far away that a length at its place is less than the round-off of its pose: no analysis there
// finds the arms of its joints.
inline bool loses_arms(const Motion& motion, double length, double epsilon) {
  for (const BodyMotion& body : motion.bodies)
    if (norm(body.x) * epsilon > length) return true;
  return false;
}

// The terms of <a, M b> for two changes of velocity, by body.
struct VelocityChange {
  std::vector<std::array<double, 6>> bodies;
};
inline VelocityChange change(const Motion& from, const Motion& to) {
  VelocityChange d;
  for (std::size_t i = 0; i < to.bodies.size(); ++i) {
    std::array<double, 6> c{};
    for (std::size_t k = 0; k < 3; ++k) {
      c[k] = to.bodies[i].v[k] - from.bodies[i].v[k];
      c[3 + k] = to.bodies[i].w[k] - from.bodies[i].w[k];
    }
    d.bodies.push_back(c);
  }
  return d;
}
// The rotation between two poses with whole turns, as many as at the mean spin in h.
inline spatial::Vector<double> turn_between(const BodyMotion& a, const BodyMotion& b, double h) {
  constexpr double full = 6.283185307179586;
  const auto turn = spatial::turn_between(a.pose, b.pose);
  const double size = spatial::norm(turn);
  if (size == 0) return turn;
  const double at_mean = h / 2 * ((a.w[0] + b.w[0]) * turn.x + (a.w[1] + b.w[1]) * turn.y + (a.w[2] + b.w[2]) * turn.z);
  return (1 + full * std::round((at_mean / size - size) / full) / size) * turn;
}
// The first part of that change: up to the mean velocity of the way in between, of duration h.
inline VelocityChange change_to_mean(const Motion& from, const Motion& to, double h) {
  VelocityChange d;
  for (std::size_t i = 0; i < to.bodies.size(); ++i) {
    const BodyMotion &a = from.bodies[i], &b = to.bodies[i];
    const auto turn = turn_between(a, b, h);
    d.bodies.push_back({(b.x[0] - a.x[0]) / h - a.v[0], (b.x[1] - a.x[1]) / h - a.v[1], (b.x[2] - a.x[2]) / h - a.v[2],
                        turn.x / h - a.w[0], turn.y / h - a.w[1], turn.z / h - a.w[2]});
  }
  return d;
}
// The change of w over h by the turning of inertia tensors: h I^-1 (I w x w).
inline VelocityChange turning(const Motion& from, double h) {
  VelocityChange d;
  for (const BodyMotion& body : from.bodies) {
    const spatial::Vector<double> w{body.w[0], body.w[1], body.w[2]};
    const spatial::Vector<double> dw = h * (spatial::inverse(body.inertia) * spatial::cross(body.inertia * w, w));
    d.bodies.push_back({0, 0, 0, dw.x, dw.y, dw.z});
  }
  return d;
}
// |b - a|^2 in the metric of the masses of `at`; an empty a is 0.
inline double square(const Motion& at, const VelocityChange& b, const VelocityChange& a = {}) {
  double sum = 0;
  for (std::size_t i = 0; i < at.bodies.size(); ++i) {
    std::array<double, 3> v{}, w{};
    for (std::size_t k = 0; k < 3; ++k) {
      v[k] = b.bodies[i][k] - (a.bodies.empty() ? 0 : a.bodies[i][k]);
      w[k] = b.bodies[i][3 + k] - (a.bodies.empty() ? 0 : a.bodies[i][3 + k]);
    }
    sum += at.bodies[i].mass * dot(v, v) + dot(w, times(at.bodies[i].inertia, w));
  }
  return sum;
}

}  // namespace cdot::torture
