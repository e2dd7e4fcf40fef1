// The plane as the runtime sees it: poses, velocities, masses and their arithmetic. The solvers use only this struct's
// members, so another dimension is another struct with the same members.
#pragma once

#include <cmath>

#include <cdot/joints.hpp>
#include <cdot/kernel.hpp>
#include <cdot/precision.hpp>
#include <cdot/settings.hpp>

namespace cdot {

namespace planar {
// A pose in arguments and results, in doubles for every precision of the World.
struct Place {
  double x, y, angle;
};
// A force [N] and a torque about the centre of mass [N m].
struct Wrench {
  double force_x = 0, force_y = 0, torque = 0;
};
}  // namespace planar

template <class T>
struct Planar {
  using Scalar = T;
  using Exact = Planar<ExactNumber<T>>;
  using InDoubles = Planar<double>;
  using BodyDefinition = cdot::BodyDefinition;
  using Place = planar::Place;
  using Wrench = planar::Wrench;
  static constexpr Dimension dimension = Dimension::planar;
  static constexpr bool has_gyroscopes = false;  // the inertia is one number and does not turn with the body
  struct Gyroscope {};
  using Pose = planar::Pose<T>;
  using Velocity = planar::Velocity<T>;  // also a displacement, an acceleration, or an impulse by components
  using InverseMass = planar::InverseMass<T>;
  static constexpr int freedom = 3;  // numbers in a Velocity

  static Pose pose(T x, T y, T angle) { return {x, y, std::cos(angle), std::sin(angle), angle}; }

  static Pose placed(const Place& p) { return pose(T(p.x), T(p.y), T(p.angle)); }
  static Place place_of(const Pose& q) { return {double(q.x), double(q.y), double(q.angle)}; }
  static Place place_of(const BodyDefinition& d) { return {d.x, d.y, d.angle}; }
  static Velocity velocity_of(const BodyDefinition& d) { return {T(d.vx), T(d.vy), T(d.w)}; }
  static Wrench wrench_of(const BodyDefinition& d) { return {d.force_x, d.force_y, d.torque}; }
  static InverseMass inverse_mass_of(const BodyDefinition& d) {
    const bool turns = !d.is_static && !d.fixed_rotation && d.inertia > 0;
    const ExactNumber<T> one = 1;
    return {d.is_static ? T(0) : T(one / d.mass), turns ? T(one / d.inertia) : T(0)};
  }
  static Velocity components(const Wrench& f) { return {T(f.force_x), T(f.force_y), T(f.torque)}; }
  static Velocity rounded(const planar::Velocity<ExactNumber<T>>& v) { return {T(v.x), T(v.y), T(v.w)}; }
  static void add(Wrench& sum, const Velocity& impulse, double time) {
    sum.force_x += double(impulse.x / time);
    sum.force_y += double(impulse.y / time);
    sum.torque += double(impulse.w / time);
  }

  // c and s are recomputed from the angle: a product of rotations would drift off the unit circle.
  static Pose moved(const Pose& q, const Velocity& d) { return pose(q.x + d.x, q.y + d.y, q.angle + d.w); }

  // Poses {x, y, angle} and their rates as plain numbers, for integrators that combine them.
  static constexpr int pose_numbers = 3;
  static constexpr int lengths = 2;  // leading numbers of a pose and of a Velocity that are lengths
  static void write(const Pose& q, T* to) { to[0] = q.x, to[1] = q.y, to[2] = q.angle; }
  static Pose read(const T* from) { return pose(from[0], from[1], from[2]); }
  static void write(const Velocity& v, T* to) { to[0] = v.x, to[1] = v.y, to[2] = v.w; }
  static Velocity read_velocity(const T* from) { return {from[0], from[1], from[2]}; }
  static void write_rate(const Pose&, const Velocity& v, T* to) { to[0] = v.x, to[1] = v.y, to[2] = v.w; }

  // v + scale * d
  static Velocity sum(const Velocity& v, const Velocity& d, T scale) {
    return {v.x + scale * d.x, v.y + scale * d.y, v.w + scale * d.w};
  }

  static Velocity difference(const Pose& q, const Pose& start) {
    return {q.x - start.x, q.y - start.y, q.angle - start.angle};
  }

  // M^-1 f
  static Velocity weighted(const InverseMass& m, const Velocity& f) { return {m.m * f.x, m.m * f.y, m.I * f.w}; }

  // M from M^-1
  static InverseMass inverted(const InverseMass& m) { return {inverse(m.m), inverse(m.I)}; }
  // M a: the force for an acceleration a
  static Velocity force(const InverseMass& m, const Velocity& a) { return weighted(inverted(m), a); }

  static Velocity damped(const Velocity& v, T linear, T angular) { return {v.x * linear, v.y * linear, v.w * angular}; }

  static double dot(const Velocity& f, const Velocity& v) {
    return double(f.x) * double(v.x) + double(f.y) * double(v.y) + double(f.w) * double(v.w);
  }

  static bool slower(const Velocity& v, T speed) {
    return v.x * v.x + v.y * v.y < speed * speed && std::fabs(v.w) < speed;
  }

  // The part of a row block's d(J^T lambda)/dq that concerns one body's own rotation. The other parts stay out, which
  // conserves linear momentum.
  using Stiffness = T;
  template <int width>
  static void subtract(Stiffness& stiffness, const T (&H)[width][width], int body) {
    stiffness -= H[3 * body + 2][3 * body + 2];
  }
  // I + h stiffness, if the stiffness is positive (tension).
  static InverseMass stiffened(const InverseMass& m, Stiffness stiffness, T h) {
    const T added = select(stiffness > T(0), h * stiffness, T(0));
    return {m.m, m.I / (T(1) + added * m.I)};
  }

  static Velocity gravity(const Settings& s) { return {T(s.gravity_x), T(s.gravity_y), T(0)}; }

  static InverseMass unit_mass() { return {T(1), T(1)}; }

  static bool immovable(const InverseMass& m) { return m.m == 0 && m.I == 0; }
};

}  // namespace cdot
