// Points on surfaces in space, by hand. With d = pa - x_b, z the place of pa in the axes of b and n the gradient of C:
//   J = [ n' | (ra × n)' | -n' | -(d × n)' ],
//   K = (1/m_a + 1/m_b) n · n + (ra × n)' I_a^-1 (ra × n) + (d × n)' I_b^-1 (d × n).
// A surface has position(z, p, C) and gradient(b, z, p, C, n).
#pragma once

#include "tests/derive/by_hand/vectors.hpp"

namespace by_hand {

template <class T>
struct SpatialRow {
  V3<T> n, wa, wb;
};

template <class T, class P>
V3<T> place(const cdot::spatial::Pose<T>& b, V3<T> d, const P& p) {
  const V3<T> z = turned_back(b, d);
  if constexpr (requires { p.pb_x; }) return z - V3<T>{p.pb_x, p.pb_y, p.pb_z};
  else return z;
}

template <class Surface, class T, class P>
void position(const cdot::spatial::Pose<T> (&q)[2], const P& p, T& C) {
  const V3<T> ra = turned(q[0], V3<T>{p.pa_x, p.pa_y, p.pa_z});
  const V3<T> d = V3<T>{q[0].x, q[0].y, q[0].z} - V3<T>{q[1].x, q[1].y, q[1].z} + ra;
  Surface::position(place(q[1], d, p), p, C);
}

template <class Surface, class T, class P>
void jacobian(const cdot::spatial::Pose<T> (&q)[2], const P& p, T& C, SpatialRow<T>& J) {
  const V3<T> ra = turned(q[0], V3<T>{p.pa_x, p.pa_y, p.pa_z});
  const V3<T> d = V3<T>{q[0].x, q[0].y, q[0].z} - V3<T>{q[1].x, q[1].y, q[1].z} + ra;
  Surface::gradient(q[1], place(q[1], d, p), p, C, J.n);
  J.wa = cross(ra, J.n);
  J.wb = cross(d, J.n);
}

template <class T>
void effective_mass(const SpatialRow<T>& J, const cdot::spatial::InverseMass<T> (&m)[2], T& K) {
  K = (m[0].m + m[1].m) * dot(J.n, J.n) + turning(m[0], J.wa) + turning(m[1], J.wb);
}

// Coordinates along the axes of the frame f of b, from those along the axes of b, and back.
template <class T, class P>
V3<T> into_frame(const P& p, V3<T> z) {
  return {dot({p.f_x_x, p.f_x_y, p.f_x_z}, z), dot({p.f_y_x, p.f_y_y, p.f_y_z}, z),
          dot({p.f_z_x, p.f_z_y, p.f_z_z}, z)};
}
template <class T, class P>
V3<T> out_of_frame(const P& p, V3<T> s) {
  return {p.f_x_x * s.x + p.f_y_x * s.y + p.f_z_x * s.z, p.f_x_y * s.x + p.f_y_y * s.y + p.f_z_y * s.z,
          p.f_x_z * s.x + p.f_y_z * s.y + p.f_z_z * s.z};
}

struct torus {
  template <class T, class P>
  static void position(V3<T> z, const P& p, T& C) {
    using std::sqrt;
    const V3<T> s = into_frame(p, z);
    const T e = sqrt(s.x * s.x + s.y * s.y) - p.R;
    C = e * e + s.z * s.z - p.r * p.r;
  }
  template <class T, class P>
  static void gradient(const cdot::spatial::Pose<T>& b, V3<T> z, const P& p, T& C, V3<T>& n) {
    using std::sqrt;
    const V3<T> s = into_frame(p, z);
    const T rho = sqrt(s.x * s.x + s.y * s.y), e = rho - p.R;
    C = e * e + s.z * s.z - p.r * p.r;
    const T k = (e + e) * inverse(rho);
    n = turned(b, out_of_frame(p, V3<T>{k * s.x, k * s.y, s.z + s.z}));
  }
};

// The torus by its axis alone; on it, where q vanishes, its direction is the x axis, as the language has it.
struct ring {
  template <class T, class P>
  static void position(V3<T> z, const P& p, T& C) {
    using std::sqrt;
    const V3<T> e = {p.n_x, p.n_y, p.n_z};
    const T h = dot(z, e);
    const V3<T> q = z - h * e;
    const T out = sqrt(dot(q, q)) - p.R;
    C = out * out + h * h - p.r * p.r;
  }
  template <class T, class P>
  static void gradient(const cdot::spatial::Pose<T>& b, V3<T> z, const P& p, T& C, V3<T>& n) {
    using cdot::select;
    using std::sqrt;
    const V3<T> e = {p.n_x, p.n_y, p.n_z};
    const T h = dot(z, e);
    const V3<T> q = z - h * e;
    const T rho = sqrt(dot(q, q)), out = rho - p.R;
    C = out * out + h * h - p.r * p.r;
    const T inv = inverse(rho);
    // A compiler merges equal comparisons; here each select counts its own, as in the generated kernel.
    const auto or_x = [&](T part, T x) { return select(rho > cdot::smallest<T>(), part * inv, x); };
    const V3<T> u = {or_x(q.x, b.xx), or_x(q.y, b.xy), or_x(q.z, b.xz)};
    n = turned(b, (out + out) * u + (h + h) * e);
  }
};

struct ellipsoid {
  template <class T, class P>
  static void position(V3<T> z, const P& p, T& C) {
    const V3<T> s = into_frame(p, z);
    const T X = s.x * inverse(p.p), Y = s.y * inverse(p.q), Z = s.z * inverse(p.h);
    C = X * X + Y * Y + Z * Z - T(1);
  }
  template <class T, class P>
  static void gradient(const cdot::spatial::Pose<T>& b, V3<T> z, const P& p, T& C, V3<T>& n) {
    const V3<T> s = into_frame(p, z);
    const V3<T> half = {s.x * inverse(p.p * p.p), s.y * inverse(p.q * p.q), s.z * inverse(p.h * p.h)};
    C = dot(half, s) - T(1);
    n = turned(b, out_of_frame(p, half + half));
  }
};

struct paraboloid {
  template <class T, class P>
  static void position(V3<T> z, const P& p, T& C) {
    const V3<T> s = into_frame(p, z);
    C = s.z - T(0.5) * inverse(p.radius) * (s.x * s.x + s.y * s.y);
  }
  template <class T, class P>
  static void gradient(const cdot::spatial::Pose<T>& b, V3<T> z, const P& p, T& C, V3<T>& n) {
    const V3<T> s = into_frame(p, z);
    const T i = inverse(p.radius), X = s.x * i, Y = s.y * i;
    C = s.z - T(0.5) * (X * s.x + Y * s.y);
    n = turned(b, V3<T>{p.f_z_x, p.f_z_y, p.f_z_z} - X * V3<T>{p.f_x_x, p.f_x_y, p.f_x_z} -
                      Y * V3<T>{p.f_y_x, p.f_y_y, p.f_y_z});
  }
};

struct saddle {
  template <class T, class P>
  static void position(V3<T> s, const P& p, T& C) {
    C = s.z - inverse(p.radius) * s.x * s.y;
  }
  template <class T, class P>
  static void gradient(const cdot::spatial::Pose<T>& b, V3<T> s, const P& p, T& C, V3<T>& n) {
    const T i = inverse(p.radius), X = s.x * i, Y = s.y * i;
    C = s.z - s.x * Y;
    n = {b.xz - Y * b.xx - X * b.xy, b.yz - Y * b.yx - X * b.yy, b.zz - Y * b.zx - X * b.zy};
  }
};

// g = (-sin, cos, -(y sin + x cos)/h), turned into b by the axes of f.
struct helicoid {
  template <class T, class P>
  static void position(V3<T> z, const P& p, T& C) {
    using std::cos;
    using std::sin;
    const V3<T> s = into_frame(p, z);
    const T turn = s.z * inverse(p.h);
    C = s.y * cos(turn) - s.x * sin(turn);
  }
  template <class T, class P>
  static void gradient(const cdot::spatial::Pose<T>& b, V3<T> z, const P& p, T& C, V3<T>& n) {
    using std::cos;
    using std::sin;
    const V3<T> s = into_frame(p, z);
    const T i = inverse(p.h), turn = s.z * i, c = cos(turn), S = sin(turn);
    C = s.y * c - s.x * S;
    const T rate = (s.y * S + s.x * c) * i;
    n = turned(b, c * V3<T>{p.f_y_x, p.f_y_y, p.f_y_z} - S * V3<T>{p.f_x_x, p.f_x_y, p.f_x_z} -
                      rate * V3<T>{p.f_z_x, p.f_z_y, p.f_z_z});
  }
};

// With w = z - (z . e) e, C = w . w - r^2 and n = 2 w.
struct cylinder {
  template <class T, class P>
  static V3<T> off_axis(V3<T> z, const P& p) {
    const V3<T> e = {p.t_x, p.t_y, p.t_z};
    return z - dot(z, e) * e;
  }
  template <class T, class P>
  static void position(V3<T> z, const P& p, T& C) {
    const V3<T> w = off_axis(z, p);
    C = dot(w, w) - p.radius * p.radius;
  }
  template <class T, class P>
  static void gradient(const cdot::spatial::Pose<T>& b, V3<T> z, const P& p, T& C, V3<T>& n) {
    const V3<T> w = off_axis(z, p);
    C = dot(w, w) - p.radius * p.radius;
    n = turned(b, w + w);
  }
};

// With w = z - (1 + slope^2) (z . e) e, C = z . w and n = 2 w.
struct cone {
  template <class T, class P>
  static void position(V3<T> z, const P& p, T& C) {
    const V3<T> e = {p.t_x, p.t_y, p.t_z};
    const T h = dot(z, e);
    C = dot(z, z) - h * h * (T(1) + p.slope * p.slope);
  }
  template <class T, class P>
  static void gradient(const cdot::spatial::Pose<T>& b, V3<T> z, const P& p, T& C, V3<T>& n) {
    const V3<T> e = {p.t_x, p.t_y, p.t_z};
    const V3<T> w = z - (T(1) + p.slope * p.slope) * dot(z, e) * e;
    C = dot(z, w);
    n = turned(b, w + w);
  }
};

// n = (-3 k (x^2 - y^2), 6 k x y, 1) in the axes of b.
struct monkey_saddle {
  template <class T, class P>
  static void position(V3<T> s, const P& p, T& C) {
    C = s.z - p.k * s.x * (s.x * s.x - T(3) * s.y * s.y);
  }
  template <class T, class P>
  static void gradient(const cdot::spatial::Pose<T>& b, V3<T> s, const P& p, T& C, V3<T>& n) {
    const T x = p.k * s.x, y = p.k * s.y, X = x * s.x, Y = T(3) * y * s.y;
    C = s.z - s.x * (X - Y);
    const T along_x = T(3) * X - Y, along_y = T(6) * x * s.y;
    n = {b.xz - along_x * b.xx + along_y * b.xy, b.yz - along_x * b.yx + along_y * b.yy,
         b.zz - along_x * b.zx + along_y * b.zy};
  }
};

}  // namespace by_hand
