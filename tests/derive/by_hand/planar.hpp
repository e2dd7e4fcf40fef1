// Points on curves of the plane, by hand. With d = pa - x_b, z the place of pa in the axes of b and n the gradient of
// C:
//   J = ± [ n' | ra × n | -n' | -(d × n) ],   K = (1/m_a + 1/m_b) n · n + (ra × n)^2/I_a + (d × n)^2/I_b.
// A curve has position(z, p, C) and gradient(b, z, p, C, n).
#pragma once

#include "tests/derive/by_hand/vectors.hpp"

namespace by_hand {

template <class T>
struct PlanarRow {
  V2<T> n;
  T wa, wb;
};

// The place of pa in the axes of b; `pb` at its origin, if the spec has one.
template <class T, class P>
V2<T> place(const cdot::planar::Pose<T>& b, V2<T> d, const P& p) {
  const V2<T> z = turned_back(b.c, b.s, d);
  if constexpr (requires { p.pb_x; }) return z - V2<T>{p.pb_x, p.pb_y};
  else return z;
}

template <class Curve, class T, class P>
void position(const cdot::planar::Pose<T> (&q)[2], const P& p, T& C) {
  const V2<T> ra = turned(q[0].c, q[0].s, V2<T>{p.pa_x, p.pa_y});
  const V2<T> d = V2<T>{q[0].x, q[0].y} - V2<T>{q[1].x, q[1].y} + ra;
  Curve::position(place(q[1], d, p), p, C);
}

template <class Curve, class T, class P>
void jacobian(const cdot::planar::Pose<T> (&q)[2], const P& p, T& C, PlanarRow<T>& J) {
  const V2<T> ra = turned(q[0].c, q[0].s, V2<T>{p.pa_x, p.pa_y});
  const V2<T> d = V2<T>{q[0].x, q[0].y} - V2<T>{q[1].x, q[1].y} + ra;
  Curve::gradient(q[1], place(q[1], d, p), p, C, J.n);
  J.wa = cross(ra, J.n);
  J.wb = cross(d, J.n);
}

template <class T>
void effective_mass(const PlanarRow<T>& J, const cdot::planar::InverseMass<T> (&m)[2], T& K) {
  K = (m[0].m + m[1].m) * dot(J.n, J.n) + m[0].I * J.wa * J.wa + m[1].I * J.wb * J.wb;
}

struct ellipse {
  static constexpr int sign = 1;
  template <class T, class P>
  static void position(V2<T> z, const P& p, T& C) {
    const V2<T> s = turned_back(p.f_x, p.f_y, z);
    const T X = s.x * inverse(p.p), Y = s.y * inverse(p.q);
    C = X * X + Y * Y - T(1);
  }
  template <class T, class P>
  static void gradient(const cdot::planar::Pose<T>& b, V2<T> z, const P& p, T& C, V2<T>& n) {
    const V2<T> s = turned_back(p.f_x, p.f_y, z);
    const V2<T> half = {s.x * inverse(p.p * p.p), s.y * inverse(p.q * p.q)};
    C = dot(half, s) - T(1);
    n = turned(b.c, b.s, turned(p.f_x, p.f_y, half + half));
  }
};

// n = perp(f) - slope f, and J keeps -n.
struct parabola {
  static constexpr int sign = -1;
  template <class T, class P>
  static void position(V2<T> z, const P& p, T& C) {
    const V2<T> s = turned_back(p.f_x, p.f_y, z);
    C = s.y - T(0.5) * inverse(p.radius) * s.x * s.x;
  }
  template <class T, class P>
  static void gradient(const cdot::planar::Pose<T>& b, V2<T> z, const P& p, T& C, V2<T>& n) {
    const V2<T> s = turned_back(p.f_x, p.f_y, z);
    const T slope = s.x * inverse(p.radius);
    C = s.y - T(0.5) * slope * s.x;
    const V2<T> f = turned(b.c, b.s, V2<T>{p.f_x, p.f_y});
    n = {slope * f.x + f.y, slope * f.y - f.x};
  }
};

// y = k x^3 + m x; n = (-slope, 1) in the axes of b, and J keeps -n.
struct cubic {
  static constexpr int sign = -1;
  template <class T, class P>
  static void position(V2<T> s, const P& p, T& C) {
    C = s.y - (p.k * s.x * s.x + p.m) * s.x;
  }
  template <class T, class P>
  static void gradient(const cdot::planar::Pose<T>& b, V2<T> s, const P& p, T& C, V2<T>& n) {
    const T kxx = p.k * s.x * s.x;
    C = s.y - (kxx + p.m) * s.x;
    const T slope = T(3) * kxx + p.m;
    n = {slope * b.c + b.s, slope * b.s - b.c};
  }
};

struct superellipse {
  static constexpr int sign = 1;
  template <class T, class P>
  static void position(V2<T> z, const P& p, T& C) {
    const V2<T> s = turned_back(p.f_x, p.f_y, z);
    const T X = s.x * inverse(p.p), Y = s.y * inverse(p.q);
    const T XX = X * X, YY = Y * Y;
    C = XX * XX + YY * YY - T(1);
  }
  template <class T, class P>
  static void gradient(const cdot::planar::Pose<T>& b, V2<T> z, const P& p, T& C, V2<T>& n) {
    const V2<T> s = turned_back(p.f_x, p.f_y, z);
    const T ip = inverse(p.p), iq = inverse(p.q);
    const T X = s.x * ip, Y = s.y * iq;
    const V2<T> quarter = {X * X * X * ip, Y * Y * Y * iq};
    C = dot(quarter, s) - T(1);
    n = turned(b.c, b.s, turned(p.f_x, p.f_y, V2<T>{T(4) * quarter.x, T(4) * quarter.y}));
  }
};

// y = height sin(k x) from the centre of mass; n = (-slope, 1) in the axes of b, and J keeps -n.
struct wave {
  static constexpr int sign = -1;
  template <class T, class P>
  static void position(V2<T> s, const P& p, T& C) {
    using std::sin;
    C = s.y - p.height * sin(p.k * s.x);
  }
  template <class T, class P>
  static void gradient(const cdot::planar::Pose<T>& b, V2<T> s, const P& p, T& C, V2<T>& n) {
    using std::cos;
    using std::sin;
    const T kx = p.k * s.x;
    C = s.y - p.height * sin(kx);
    const T slope = p.height * p.k * cos(kx);
    n = {slope * b.c + b.s, slope * b.s - b.c};
  }
};

}  // namespace by_hand
