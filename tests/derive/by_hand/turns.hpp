// Coordinates of the catalogue that are angles in space, by hand: J = [ 0 | -w' | 0 | w' ] with the axis w of the turn,
//   K = w' (I_a^-1 + I_b^-1) w, the tensors added first.
// A turn has position(q, p, C), jacobian(q, p, C, J), and the sign of J.
#pragma once

#include "tests/derive/by_hand/vectors.hpp"

namespace by_hand {

template <class T>
struct Turn {
  V3<T> w;
};

template <class T>
void effective_mass(const Turn<T>& J, const cdot::spatial::InverseMass<T> (&m)[2], T& K) {
  const auto &a = m[0], &b = m[1];
  const cdot::spatial::InverseMass<T> both = {a.m,           a.Ixx + b.Ixx, a.Iyy + b.Iyy, a.Izz + b.Izz,
                                              a.Ixy + b.Ixy, a.Ixz + b.Ixz, a.Iyz + b.Iyz};
  K = turning(both, J.w);
}

// The i-th axis of the frame fa of a, of fb of b, in the world.
template <int i, class T, class P>
V3<T> axis_of_a(const cdot::spatial::Pose<T> (&q)[2], const P& p) {
  if constexpr (i == 0) return turned(q[0], V3<T>{p.fa_x_x, p.fa_x_y, p.fa_x_z});
  else if constexpr (i == 1) return turned(q[0], V3<T>{p.fa_y_x, p.fa_y_y, p.fa_y_z});
  else return turned(q[0], V3<T>{p.fa_z_x, p.fa_z_y, p.fa_z_z});
}
template <int i, class T, class P>
V3<T> axis_of_b(const cdot::spatial::Pose<T> (&q)[2], const P& p) {
  if constexpr (i == 0) return turned(q[1], V3<T>{p.fb_x_x, p.fb_x_y, p.fb_x_z});
  else if constexpr (i == 1) return turned(q[1], V3<T>{p.fb_y_x, p.fb_y_y, p.fb_y_z});
  else return turned(q[1], V3<T>{p.fb_z_x, p.fb_z_y, p.fb_z_z});
}

// atan2(± u · k, v · k), u and v being axes of one body and k of the other. u · k grows at (u × k) · w as the body of u
// turns against that of k, so with r^2 = (u · k)^2 + (v · k)^2 the axis is
//   ((v · k)/r^2 u - (u · k)/r^2 v) × k.
template <int iu, int iv, int ik, bool on_b, int sine>
struct bend {
  static constexpr int sign = (on_b ? 1 : -1) * sine;
  template <class T>
  static T angle(T s, T c) {
    using std::atan2;
    if constexpr (sine < 0) return atan2(-s, c);
    else return atan2(s, c);
  }
  template <class T>
  struct Axes {
    V3<T> u, v, k;
  };
  template <class T, class P>
  static Axes<T> axes(const cdot::spatial::Pose<T> (&q)[2], const P& p) {
    if constexpr (on_b) return {axis_of_b<iu>(q, p), axis_of_b<iv>(q, p), axis_of_a<ik>(q, p)};
    else return {axis_of_a<iu>(q, p), axis_of_a<iv>(q, p), axis_of_b<ik>(q, p)};
  }
  template <class T, class P>
  static void position(const cdot::spatial::Pose<T> (&q)[2], const P& p, T& C) {
    const Axes<T> of = axes(q, p);
    C = angle(dot(of.u, of.k), dot(of.v, of.k));
  }
  template <class T, class P>
  static void jacobian(const cdot::spatial::Pose<T> (&q)[2], const P& p, T& C, Turn<T>& J) {
    const Axes<T> of = axes(q, p);
    const T s = dot(of.u, of.k), c = dot(of.v, of.k), inv = inverse(s * s + c * c);
    C = angle(s, c);
    J.w = cross((c * inv) * of.u - (s * inv) * of.v, of.k);
  }
};

// The latitude of k = fb.z against fa: atan2(x · k, sqrt((y · k)^2 + (z · k)^2)), with z = x × y. The three squares add
// up to 1, so the rate is that of an arc sine, (x · k)_dot/sqrt(...).
struct latitude {
  static constexpr int sign = -1;
  template <class T, class P>
  static void position(const cdot::spatial::Pose<T> (&q)[2], const P& p, T& C) {
    Turn<T> J;
    of(q, p, C, J, false);
  }
  template <class T, class P>
  static void jacobian(const cdot::spatial::Pose<T> (&q)[2], const P& p, T& C, Turn<T>& J) {
    of(q, p, C, J, true);
  }

 private:
  template <class T, class P>
  static void of(const cdot::spatial::Pose<T> (&q)[2], const P& p, T& C, Turn<T>& J, bool with_axis) {
    using std::atan2, std::sqrt;
    const V3<T> x = axis_of_a<0>(q, p), y = axis_of_a<1>(q, p), z = cross(x, y), k = axis_of_b<2>(q, p);
    const T s = dot(y, k), t = dot(z, k), r = sqrt(s * s + t * t);
    C = atan2(dot(x, k), r);
    if (with_axis) J.w = inverse(r) * cross(x, k);
  }
};

// The twist of g = fb against f = fa about their i-th axes: atan2(f_2 · g_1 - f_1 · g_2, f_1 · g_1 + f_2 · g_2), with
// the axes 1 and 2 that follow. It turns about the line halfway between both: w = (f_i + g_i)/(1 + f_i · g_i).
template <int i>
struct twist {
  static constexpr int sign = 1, j = (i + 1) % 3, k = (i + 2) % 3;
  template <class T, class P>
  static void position(const cdot::spatial::Pose<T> (&q)[2], const P& p, T& C) {
    C = angle(axis_of_a<j>(q, p), axis_of_a<k>(q, p), axis_of_b<j>(q, p), axis_of_b<k>(q, p));
  }
  template <class T, class P>
  static void jacobian(const cdot::spatial::Pose<T> (&q)[2], const P& p, T& C, Turn<T>& J) {
    const V3<T> f1 = axis_of_a<j>(q, p), f2 = axis_of_a<k>(q, p), g1 = axis_of_b<j>(q, p), g2 = axis_of_b<k>(q, p);
    C = angle(f1, f2, g1, g2);
    const V3<T> f = cross(f1, f2), g = cross(g1, g2);
    J.w = inverse(T(1) + dot(f, g)) * (f + g);
  }

 private:
  template <class T>
  static T angle(V3<T> f1, V3<T> f2, V3<T> g1, V3<T> g2) {
    using std::atan2;
    return atan2(dot(f2, g1) - dot(f1, g2), dot(f1, g1) + dot(f2, g2));
  }
};

// The angle between the x axes: atan2(|f × g|, f · g) about the direction of f × g; of the zero vector that is x.
struct swing {
  static constexpr int sign = 1;
  template <class T, class P>
  static void position(const cdot::spatial::Pose<T> (&q)[2], const P& p, T& C) {
    using std::atan2, std::sqrt;
    const V3<T> f = axis_of_a<0>(q, p), g = axis_of_b<0>(q, p), n = cross(f, g);
    C = atan2(sqrt(dot(n, n)), dot(f, g));
  }
  template <class T, class P>
  static void jacobian(const cdot::spatial::Pose<T> (&q)[2], const P& p, T& C, Turn<T>& J) {
    using cdot::select;
    using std::atan2, std::sqrt;
    const V3<T> f = axis_of_a<0>(q, p), g = axis_of_b<0>(q, p), n = cross(f, g);
    const T length = sqrt(dot(n, n)), inv = inverse(length);
    C = atan2(length, dot(f, g));
    // A compiler merges equal comparisons; here each select counts its own, as in the generated kernel.
    const auto or_zero = [&](T part, T zero) { return select(length > cdot::smallest<T>(), part * inv, zero); };
    J.w = {or_zero(n.x, T(1)), or_zero(n.y, T(0)), or_zero(n.z, T(0))};
  }
};

}  // namespace by_hand
