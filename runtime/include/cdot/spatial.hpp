// Space as the runtime sees it, with the same members as cdot/planar.hpp.
#pragma once

#include <algorithm>
#include <cmath>

#include <cdot/gyroscope.hpp>
#include <cdot/joints.hpp>
#include <cdot/kernel.hpp>
#include <cdot/precision.hpp>
#include <cdot/rotation.hpp>
#include <cdot/settings.hpp>

namespace cdot {

namespace spatial {
struct Place {
  double x, y, z;
  double e0 = 1, e1 = 0, e2 = 0, e3 = 0;  // a quaternion of any length but 0
};
// A force [N] and a torque about the centre of mass [N m], in world axes.
struct Wrench {
  double force_x = 0, force_y = 0, force_z = 0, torque_x = 0, torque_y = 0, torque_z = 0;
};
}  // namespace spatial

template <class T>
struct Spatial {
  using Scalar = T;
  using Exact = Spatial<ExactNumber<T>>;
  using InDoubles = Spatial<double>;
  using Pose = spatial::Pose<T>;
  using Velocity = spatial::Velocity<T>;  // also a displacement, an acceleration, or an impulse
  using InverseMass = spatial::InverseMass<T>;
  using BodyDefinition = SpatialBodyDefinition;
  using Place = spatial::Place;
  using Wrench = spatial::Wrench;
  using Vector = spatial::Vector<T>;
  using Symmetric = spatial::Symmetric<T>;
  static constexpr Dimension dimension = Dimension::spatial;
  static constexpr int freedom = 6;  // numbers in a Velocity
  static constexpr bool has_gyroscopes = true;
  using Gyroscope = spatial::Gyroscope<T>;

  static Pose placed(const Place& p) {
    return spatial::oriented(T(p.x), T(p.y), T(p.z), T(p.e0), T(p.e1), T(p.e2), T(p.e3));
  }
  static Place place_of(const Pose& q) {
    return {double(q.x), double(q.y), double(q.z), double(q.e0), double(q.e1), double(q.e2), double(q.e3)};
  }
  static Place place_of(const BodyDefinition& d) { return {d.x, d.y, d.z, d.e0, d.e1, d.e2, d.e3}; }
  static Velocity velocity_of(const BodyDefinition& d) {
    return {T(d.vx), T(d.vy), T(d.vz), T(d.wx), T(d.wy), T(d.wz)};
  }
  static Wrench wrench_of(const BodyDefinition& d) {
    return {d.force_x, d.force_y, d.force_z, d.torque_x, d.torque_y, d.torque_z};
  }
  static spatial::Symmetric<ExactNumber<T>> inertia_of(const BodyDefinition& d) {
    const Inertia& I = d.inertia;
    return {I.xx, I.yy, I.zz, I.xy, I.xz, I.yz};
  }
  static bool turns(const BodyDefinition& d) { return !d.is_static && !d.fixed_rotation && d.inertia.xx > 0; }
  static bool isotropic(const Inertia& I) {
    return I.xx == I.yy && I.yy == I.zz && I.xy == 0 && I.xz == 0 && I.yz == 0;
  }
  static InverseMass inverse_mass_of(const BodyDefinition& d) {
    const ExactNumber<T> one = 1;
    const T m = d.is_static ? T(0) : T(one / d.mass);
    if (!turns(d)) return inverse_mass(m, {});
    if (isotropic(d.inertia)) {
      const T I = T(one / d.inertia.xx);
      return inverse_mass(m, {I, I, I, T(0), T(0), T(0)});
    }
    const Gyroscope gyroscope = gyroscope_of(d);
    return inverse_mass(m, spatial::turned(placed(place_of(d)), gyroscope.inverse));
  }
  static InverseMass inverse_mass(T m, const Symmetric& I) { return {m, I.xx, I.yy, I.zz, I.xy, I.xz, I.yz}; }
  static Symmetric inverse_inertia(const InverseMass& m) { return {m.Ixx, m.Iyy, m.Izz, m.Ixy, m.Ixz, m.Iyz}; }

  // --- bodies whose inertia tensor turns with them ---

  static bool is_gyroscope(const BodyDefinition& d) { return turns(d) && !isotropic(d.inertia); }
  static Gyroscope gyroscope_of(const BodyDefinition& d) {
    const auto I = inertia_of(d), inverse = spatial::inverse(I);
    const auto cast = [](const spatial::Symmetric<ExactNumber<T>>& S) {
      return Symmetric{T(S.xx), T(S.yy), T(S.zz), T(S.xy), T(S.xz), T(S.yz)};
    };
    Gyroscope g{cast(I), cast(inverse), {}, {}, {}, {}, {}};
    InverseMass m{};
    set_inertia(g, placed(place_of(d)), m, velocity_of(d));
    return g;
  }
  // The tensors at a pose that was set; keeps w.
  static void set_inertia(Gyroscope& g, const Pose& q, InverseMass& m, const Velocity& v) {
    g.world = spatial::turned(q, g.inertia);
    m = inverse_mass(m.m, spatial::turned(q, g.inverse));
    g.spin = angular(v);
    g.momentum = g.world * g.spin;
  }
  static void set_mass(const Gyroscope& g, InverseMass& mass) { mass = inverse_mass(mass.m, g.world); }
  // The tensors at a pose that the body moved to; keeps L = I w.
  static void turn(Gyroscope& g, const Pose& q, InverseMass& m, Velocity& v) {
    g.momentum = g.momentum + g.world * (angular(v) - g.spin);
    g.world = spatial::turned(q, g.inertia);
    m = inverse_mass(m.m, spatial::turned(q, g.inverse));
    g.spin = inverse_inertia(m) * g.momentum;
    set_angular(v, g.spin);
  }
  static void set_torque(Gyroscope& g, const Velocity& f) { g.torque = angular(f); }
  // rate += -I^-1 (w x I w), with the w of the last update of the tensors
  static void add_gyroscopic_rate(const Gyroscope& g, const InverseMass& m, Velocity& rate) {
    const Vector torque = spatial::cross(g.momentum, g.spin);
    set_angular(rate, angular(rate) + inverse_inertia(m) * torque);
  }
  // I^-1 torque: the part of the acceleration that changes with the tensor.
  static void turn_acceleration(const Gyroscope& g, const InverseMass& m, Velocity& acceleration) {
    set_angular(acceleration, inverse_inertia(m) * g.torque);
  }
  // Replaces w by the mean spin of the step, until restore_spin().
  static void lend_mean_spin(Gyroscope& g, const Pose& q, Velocity& v, T h) {
    g.lent = angular(v);
    set_angular(v, spatial::mean_spin(g, q, g.lent, h));
  }
  static void restore_spin(const Gyroscope& g, Velocity& v) { set_angular(v, g.lent); }

  // --- vectors of all six numbers ---

  static Velocity components(const Wrench& f) {
    return {T(f.force_x), T(f.force_y), T(f.force_z), T(f.torque_x), T(f.torque_y), T(f.torque_z)};
  }
  static Velocity rounded(const spatial::Velocity<ExactNumber<T>>& v) {
    return {T(v.x), T(v.y), T(v.z), T(v.wx), T(v.wy), T(v.wz)};
  }
  static void add(Wrench& sum, const Velocity& impulse, double time) {
    sum.force_x += double(impulse.x / time);
    sum.force_y += double(impulse.y / time);
    sum.force_z += double(impulse.z / time);
    sum.torque_x += double(impulse.wx / time);
    sum.torque_y += double(impulse.wy / time);
    sum.torque_z += double(impulse.wz / time);
  }

  static Pose moved(const Pose& q, const Velocity& d) {
    Pose to = spatial::turned_by(q, angular(d));
    to.x = q.x + d.x, to.y = q.y + d.y, to.z = q.z + d.z;
    return to;
  }

  // Poses {x, y, z, e0, e1, e2, e3} and their rates as plain numbers, for integrators that combine them. Stages lie off
  // the unit sphere; there e stands for e / |e|. On the sphere the vector field is unchanged, so a method keeps its
  // order.
  static constexpr int pose_numbers = 7;
  static constexpr int lengths = 3;  // leading numbers of a pose and of a Velocity that are lengths
  static void write(const Pose& q, T* to) {
    to[0] = q.x, to[1] = q.y, to[2] = q.z;
    to[3] = q.e0, to[4] = q.e1, to[5] = q.e2, to[6] = q.e3;
  }
  static Pose read(const T* from) {
    return spatial::oriented(from[0], from[1], from[2], from[3], from[4], from[5], from[6]);
  }
  static void write(const Velocity& v, T* to) {
    to[0] = v.x, to[1] = v.y, to[2] = v.z, to[3] = v.wx, to[4] = v.wy, to[5] = v.wz;
  }
  static Velocity read_velocity(const T* from) { return {from[0], from[1], from[2], from[3], from[4], from[5]}; }
  // de/dt = (0, w) e / 2, w in world axes
  static void write_rate(const Pose& q, const Velocity& v, T* to) {
    const T x = T(0.5) * v.wx, y = T(0.5) * v.wy, z = T(0.5) * v.wz;
    to[0] = v.x, to[1] = v.y, to[2] = v.z;
    to[3] = -x * q.e1 - y * q.e2 - z * q.e3;
    to[4] = x * q.e0 + y * q.e3 - z * q.e2;
    to[5] = y * q.e0 + z * q.e1 - x * q.e3;
    to[6] = z * q.e0 + x * q.e2 - y * q.e1;
  }

  // v + scale * d
  static Velocity sum(const Velocity& v, const Velocity& d, T scale) {
    return {v.x + scale * d.x,   v.y + scale * d.y,   v.z + scale * d.z,
            v.wx + scale * d.wx, v.wy + scale * d.wy, v.wz + scale * d.wz};
  }

  static Velocity difference(const Pose& q, const Pose& start) {
    const Vector turn = spatial::turn_between(start, q);
    return {q.x - start.x, q.y - start.y, q.z - start.z, turn.x, turn.y, turn.z};
  }

  // M^-1 f
  static Velocity weighted(const InverseMass& m, const Velocity& f) {
    const Vector w = inverse_inertia(m) * angular(f);
    return {m.m * f.x, m.m * f.y, m.m * f.z, w.x, w.y, w.z};
  }

  // M from M^-1
  static InverseMass inverted(const InverseMass& m) {
    return inverse_mass(inverse(m.m), spatial::inverse(inverse_inertia(m)));
  }
  // M a: the force for an acceleration a
  static Velocity force(const InverseMass& m, const Velocity& a) { return weighted(inverted(m), a); }

  static Velocity damped(const Velocity& v, T linear, T angular) {
    return {v.x * linear, v.y * linear, v.z * linear, v.wx * angular, v.wy * angular, v.wz * angular};
  }

  static double dot(const Velocity& f, const Velocity& v) {
    return double(f.x) * double(v.x) + double(f.y) * double(v.y) + double(f.z) * double(v.z) +
           double(f.wx) * double(v.wx) + double(f.wy) * double(v.wy) + double(f.wz) * double(v.wz);
  }

  static bool slower(const Velocity& v, T speed) {
    return v.x * v.x + v.y * v.y + v.z * v.z < speed * speed && spatial::dot(angular(v), angular(v)) < speed * speed;
  }

  // The part of a row block's d(J^T lambda)/dq that concerns one body's own rotation.
  using Stiffness = Symmetric;
  template <int width>
  static void subtract(Stiffness& stiffness, const T (&H)[width][width], int body) {
    const int x = 6 * body + 3, y = x + 1, z = x + 2;
    const T half = T(-0.5);
    stiffness = stiffness + Symmetric{-H[x][x],
                                      -H[y][y],
                                      -H[z][z],
                                      half * (H[x][y] + H[y][x]),
                                      half * (H[x][z] + H[z][x]),
                                      half * (H[y][z] + H[z][y])};
  }
  // I + h positive_part(stiffness).
  static InverseMass stiffened(const InverseMass& m, const Stiffness& stiffness, T h) {
    if (m.Ixx == T(0)) return m;
    const Symmetric inertia = spatial::inverse(inverse_inertia(m));
    return inverse_mass(m.m, spatial::inverse(inertia + h * spatial::positive_part(stiffness)));
  }

  static Velocity gravity(const Settings& s) {
    return {T(s.gravity_x), T(s.gravity_y), T(s.gravity_z), T(0), T(0), T(0)};
  }

  static InverseMass unit_mass() { return {T(1), T(1), T(1), T(1), T(0), T(0), T(0)}; }

  static bool immovable(const InverseMass& m) { return m.m == 0 && m.Ixx == 0 && m.Iyy == 0 && m.Izz == 0; }

 private:
  static Vector angular(const Velocity& v) { return {v.wx, v.wy, v.wz}; }
  static void set_angular(Velocity& v, const Vector& w) { v.wx = w.x, v.wy = w.y, v.wz = w.z; }
  static Velocity impulse(const Vector& f, const Vector& torque) {
    return {f.x, f.y, f.z, torque.x, torque.y, torque.z};
  }
};

}  // namespace cdot
