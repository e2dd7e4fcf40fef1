// The part of a compiled header that is the same in all scenes in space: vectors, tensors and rotations, without
// branches on data, for numbers and for packs of them. The mathematics is that of runtime/space/gyroscope.cpp and of
// cdot/rotation.hpp.
#pragma once

namespace cdot::compile {

inline constexpr const char* space = R"(#ifndef CDOT_SCENE_SPACE
#define CDOT_SCENE_SPACE
namespace cdot::scenes {

template <class T>
struct Vector {
  T x, y, z;
  friend Vector operator+(const Vector& a, const Vector& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vector operator-(const Vector& a, const Vector& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vector operator*(const T& s, const Vector& a) { return {s * a.x, s * a.y, s * a.z}; }
};
template <class T>
inline T dot(const Vector<T>& a, const Vector<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
inline Vector<T> cross(const Vector<T>& a, const Vector<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class Mask, class T>
inline Vector<T> choose(const Mask& now, const Vector<T>& a, const Vector<T>& b) {
  return {select(now, a.x, b.x), select(now, a.y, b.y), select(now, a.z, b.z)};
}

template <class T>
struct Tensor {  // symmetric
  T xx, yy, zz, xy, xz, yz;
  friend Vector<T> operator*(const Tensor& S, const Vector<T>& a) {
    return {S.xx * a.x + S.xy * a.y + S.xz * a.z, S.xy * a.x + S.yy * a.y + S.yz * a.z,
            S.xz * a.x + S.yz * a.y + S.zz * a.z};
  }
};
template <class Mask, class T>
inline Tensor<T> choose(const Mask& now, const Tensor<T>& A, const Tensor<T>& B) {
  return {select(now, A.xx, B.xx), select(now, A.yy, B.yy), select(now, A.zz, B.zz),
          select(now, A.xy, B.xy), select(now, A.xz, B.xz), select(now, A.yz, B.yz)};
}

// Of moments of inertia about the body's axes, and of a whole tensor.
template <class T>
inline Vector<T> times(const Vector<T>& moments, const Vector<T>& a) {
  return {moments.x * a.x, moments.y * a.y, moments.z * a.z};
}
template <class T>
inline Vector<T> times(const Tensor<T>& S, const Vector<T>& a) {
  return S * a;
}

template <class T>
inline T root(const T& x) {
  using std::sqrt;
  return sqrt(x);
}

// cos(a / 2), and sin(a / 2) / a, from a^2: by series to round-off up to half a radian, else by the functions.
template <class T>
inline T wide_half_turn(const T& square, T& c) {
  const T y = T(0.25) * square;
  const auto is_small = square < T(0.25);
  c = T(1) -
      y * T(0.5) *
          (T(1) -
           y * T(1.0 / 12) *
               (T(1) - y * T(1.0 / 30) *
                           (T(1) - y * T(1.0 / 56) * (T(1) - y * T(1.0 / 90) * (T(1) - y * T(1.0 / 132))))));
  const T s =
      T(0.5) *
      (T(1) - y * T(1.0 / 6) *
                  (T(1) - y * T(1.0 / 20) *
                              (T(1) - y * T(1.0 / 42) *
                                          (T(1) - y * T(1.0 / 72) * (T(1) - y * T(1.0 / 110) * (T(1) - y * T(1.0 / 156)))))));
  if (!any(!is_small)) return s;
  const T angle = root(select(is_small, T(1), square));
  T sine, cosine;
  sin_cos(T(0.5) * angle, sine, cosine);
  c = select(is_small, c, cosine);
  return select(is_small, s, sine / angle);
}
// The same, with short series up to 0.03 rad, as of most steps, and up to 2e-4 rad, as of most corrections.
template <class T>
inline T half_turn(const T& square, T& c) {
  const T y = T(0.25) * square, c_1 = T(1) - T(0.5) * y, s_1 = T(0.5) - T(1.0 / 12) * y;
  const auto is_slight = square < T(4e-8), is_slow = square < T(1e-3);
  c = c_1;
  if (!any(!is_slight)) return s_1;
  const T c_4 = T(1) - T(0.5) * y * (T(1) - T(1.0 / 12) * y * (T(1) - T(1.0 / 30) * y * (T(1) - T(1.0 / 56) * y)));
  const T s_4 = T(0.5) * (T(1) - T(1.0 / 6) * y * (T(1) - T(1.0 / 20) * y * (T(1) - T(1.0 / 42) * y)));
  c = select(is_slight, c_1, c_4);
  if (!any(!is_slow)) return select(is_slight, s_1, s_4);
  T wide_c;
  const T wide_s = wide_half_turn(square, wide_c);
  c = select(is_slow, c, wide_c);
  return select(is_slight, s_1, select(is_slow, s_4, wide_s));
}
// The same of a rotation vector: c, and sin(a / 2) / a times the vector.
template <class T>
inline Vector<T> half_turn(const Vector<T>& turn, T& c) {
  const T s = half_turn(dot(turn, turn), c);
  return s * turn;
}

// A S A^T
template <class T, class Pose, class Moments>
inline Tensor<T> turned(const Pose& q, const Moments& S) {
  const Vector<T> x = {q.xx, q.xy, q.xz}, y = {q.yx, q.yy, q.yz}, z = {q.zx, q.zy, q.zz};
  const Vector<T> Sx = times(S, x), Sy = times(S, y), Sz = times(S, z);
  return {dot(x, Sx), dot(y, Sy), dot(z, Sz), dot(x, Sy), dot(x, Sz), dot(y, Sz)};
}
// The same of moments that are `least` about one axis of the body, and by x and y more about the next ones.
template <int axis, class T, class Pose>
inline Tensor<T> turned(const Pose& q, const T& least, const T& x, const T& y) {
  const Vector<T> axes[3] = {{q.xx, q.yx, q.zx}, {q.xy, q.yy, q.zy}, {q.xz, q.yz, q.zz}};
  const Vector<T>&a = axes[(axis + 1) % 3], &b = axes[(axis + 2) % 3], xa = x * a, yb = y * b;
  return {least + (xa.x * a.x + yb.x * b.x), least + (xa.y * a.y + yb.y * b.y), least + (xa.z * a.z + yb.z * b.z),
          xa.x * a.y + yb.x * b.y,           xa.x * a.z + yb.x * b.z,           xa.y * a.z + yb.y * b.z};
}
template <class Pose, class T>
inline Vector<T> to_world(const Pose& q, const Vector<T>& a) {
  return {q.xx * a.x + q.xy * a.y + q.xz * a.z, q.yx * a.x + q.yy * a.y + q.yz * a.z,
          q.zx * a.x + q.zy * a.y + q.zz * a.z};
}
template <class Pose, class T>
inline Vector<T> to_body(const Pose& q, const Vector<T>& a) {
  return {q.xx * a.x + q.yx * a.y + q.zx * a.z, q.xy * a.x + q.yy * a.y + q.zy * a.z,
          q.xz * a.x + q.yz * a.y + q.zz * a.z};
}

// e of q turned by (c, v), not yet of length 1.
template <class Pose, class T>
inline void turn_by(Pose& to, const Pose& q, const T& c, const Vector<T>& v) {
  const T e0 = c * q.e0 - v.x * q.e1 - v.y * q.e2 - v.z * q.e3, e1 = c * q.e1 + v.x * q.e0 + v.y * q.e3 - v.z * q.e2;
  const T e2 = c * q.e2 + v.y * q.e0 + v.z * q.e1 - v.x * q.e3, e3 = c * q.e3 + v.z * q.e0 + v.x * q.e2 - v.y * q.e1;
  to.e0 = e0, to.e1 = e1, to.e2 = e2, to.e3 = e3;
}

// The same, by a rotation in its own axes.
template <class Pose, class T>
inline void turn_within(Pose& to, const Pose& q, const T& c, const Vector<T>& v) {
  const T e0 = c * q.e0 - v.x * q.e1 - v.y * q.e2 - v.z * q.e3, e1 = c * q.e1 + v.x * q.e0 - v.y * q.e3 + v.z * q.e2;
  const T e2 = c * q.e2 + v.y * q.e0 - v.z * q.e1 + v.x * q.e3, e3 = c * q.e3 + v.z * q.e0 - v.x * q.e2 + v.y * q.e1;
  to.e0 = e0, to.e1 = e1, to.e2 = e2, to.e3 = e3;
}

// 1 / sqrt(x). Near 1 a step of Newton from 1 is exact to round-off: 1 - d / 2 of x = 1 + d, 3 d^2 / 8 apart.
template <class T>
inline T inverse_root(const T& x) {
  constexpr double near = sizeof(typename NumberOf<T>::type) == 4 ? 1e-4 : 1e-8;
  const T d = x - T(1), by_newton = T(1) - T(0.5) * d;
  const auto is_near = d * d < T(near * near);
  if (!any(!is_near)) return by_newton;
  return select(is_near, by_newton, T(1) / root(x));
}

// Brings e to length 1, and sets its rotation matrix.
template <class Pose>
inline void orient(Pose& q) {
  using T = decltype(q.e0 + q.e0);
  const T scale = inverse_root(q.e0 * q.e0 + q.e1 * q.e1 + q.e2 * q.e2 + q.e3 * q.e3), two = T(2);
  q.e0 = scale * q.e0, q.e1 = scale * q.e1, q.e2 = scale * q.e2, q.e3 = scale * q.e3;
  q.xx = T(1) - two * (q.e2 * q.e2 + q.e3 * q.e3), q.xy = two * (q.e1 * q.e2 - q.e0 * q.e3);
  q.xz = two * (q.e1 * q.e3 + q.e0 * q.e2), q.yx = two * (q.e1 * q.e2 + q.e0 * q.e3);
  q.yy = T(1) - two * (q.e1 * q.e1 + q.e3 * q.e3), q.yz = two * (q.e2 * q.e3 - q.e0 * q.e1);
  q.zx = two * (q.e1 * q.e3 - q.e0 * q.e2), q.zy = two * (q.e2 * q.e3 + q.e0 * q.e1);
  q.zz = T(1) - two * (q.e1 * q.e1 + q.e2 * q.e2);
}

// Four poses side by side; one may be named twice. 0 to 2 are the places of the centre of mass in a Pose, 3 to 6 those
// of e, 7 to 15 of the rotation matrix.
template <class Wide, class Pose, int n>
inline void orient_four(Pose (&q)[n], int i, int j, int k, int l) {
  typename Wide::Pose to;
  gather(Places<3, 4, 5, 6>(), to, q[i], q[j], q[k], q[l]);
  orient(to);
  scatter(Places<3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15>(), to, q[i], q[j], q[k], q[l]);
}
template <class Wide, class Pose, class Displacement, int n>
inline void shift_four(Pose (&q)[n], const Displacement (&d)[n], int i, int j, int k, int l) {
  typename Wide::Pose to;
  typename Wide::Velocity by;
  gather(Places<0, 1, 2, 3, 4, 5, 6>(), to, q[i], q[j], q[k], q[l]);
  gather(Places<0, 1, 2, 3, 4, 5>(), by, d[i], d[j], d[k], d[l]);
  Wide::move(to, to, by);
  orient(to);
  scatter(Places<0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15>(), to, q[i], q[j], q[k], q[l]);
}

// The rotation of a free body during h that is symmetric about its axis e, in its own axes: it precesses about L at the
// rate L / I and turns about e by the rest. I: the moment across e.
template <class T>
inline Vector<T> free_turn(const Vector<T>& e, const T& I, const Vector<T>& W, const Vector<T>& L, const T& h, T& c) {
  const Vector<T> round = (h / I) * L, rest = (h * dot(W, e) - dot(round, e)) * e;
  T a0, b0;
  const Vector<T> a = half_turn(round, a0), b = half_turn(rest, b0);
  c = a0 * b0 - dot(a, b);
  return b0 * a + a0 * b + cross(a, b);
}

// Rows of a matrix and a tensor.
template <class T>
inline void add(Vector<T>& x, Vector<T>& y, Vector<T>& z, const Vector<T>& moments) {
  x.x = x.x + moments.x, y.y = y.y + moments.y, z.z = z.z + moments.z;
}
template <class T>
inline void add(Vector<T>& x, Vector<T>& y, Vector<T>& z, const Tensor<T>& S) {
  x = x + Vector<T>{S.xx, S.xy, S.xz}, y = y + Vector<T>{S.xy, S.yy, S.yz}, z = z + Vector<T>{S.xz, S.yz, S.zz};
}

// The solution d of (I - b x T) d = I r, T = E - versine theta x + (theta x)^2 (1 - sinc) / a^2.
template <class Moments, class T>
inline Vector<T> newton_step(const Moments& I, const Vector<T>& b, const Vector<T>& theta, const T& sinc,
                             const T& versine, const Vector<T>& r) {
  const T square = dot(theta, theta), along = dot(b, theta);
  const auto slight = square < T(0.25);
  T last = T(0.16666666666666666667) - square * T(0.00833333333333333333);
  if (any(!slight)) last = select(slight, last, (T(1) - sinc) / select(slight, T(1), square));
  const Vector<T> v = b - (last * along) * theta, u = versine * b - last * cross(b, theta);
  const T diagonal = versine * along;
  Vector<T> first = u.x * theta - Vector<T>{diagonal, v.z, -v.y};
  Vector<T> second = u.y * theta - Vector<T>{-v.z, diagonal, v.x};
  Vector<T> third = u.z * theta - Vector<T>{v.y, -v.x, diagonal};
  add(first, second, third, I);
  const Vector<T> right = times(I, r), across = cross(second, third);
  return (T(1) / dot(first, across)) *
         Vector<T>{dot(right, across), dot(right, cross(third, first)), dot(right, cross(first, second))};
}

template <class T>
inline T trace(const Vector<T>& moments) {
  return moments.x + moments.y + moments.z;
}
template <class T>
inline T trace(const Tensor<T>& S) {
  return S.xx + S.yy + S.zz;
}

// The mean spin of any free body during h, in its own axes: theta = h (W + W') / 2 with I W' = exp(-theta) I W, by
// Newton (Simo and Wong 1991). Sizes are compared by their squares. A lane that is done waits for the others unchanged.
template <class Moments, class T>
inline Vector<T> mean_spin(const Moments& I, const Moments& inverse, const Vector<T>& W, const T& h) {
  constexpr double epsilon = sizeof(typename NumberOf<T>::type) == 4 ? 1.1920929e-07 : 2.220446049250313e-16;
  const Vector<T> L = times(I, W), rate = times(inverse, cross(L, W));
  const Vector<T> bend = times(inverse, cross(times(I, rate), W) + cross(L, rate));
  const T spin = dot(W, W), fine = T(epsilon * epsilon) * spin;
  const T bent = T(0.125) * h * h * trace(inverse), curvature = bent * bent * dot(L, L);
  Vector<T> after = choose(h * h * spin < T(0.25), W + h * (rate + (T(0.5) * h) * bend), W), best = W;
  T smallest = T(1e30);
  auto busy = T(0) < T(1);
  for (int round = 0; round < 12 && any(busy); ++round) {
    const Vector<T> mean = T(0.5) * (W + after), theta = h * mean;
    T c;
    const T s = half_turn(dot(theta, theta), c);
    const T sinc = T(2) * s * c, versine = T(2) * s * s;
    const Vector<T> side = cross(theta, L), turned = L - sinc * side + versine * cross(theta, side);
    const Vector<T> residual = after - times(inverse, turned);
    const T size = dot(residual, residual);
    const Vector<T> step = newton_step(I, (T(0.5) * h) * turned, theta, sinc, versine, residual);
    const T length = dot(step, step);
    const auto is_last = curvature * length * length <= fine;
    // One round is enough for most steps.
    if (round == 0 && !any(!(size > fine && size < T(0.25) * spin && is_last))) return T(0.5) * (W + (after - step));
    const auto better = busy && size < smallest, converges = size < T(0.25) * smallest;
    best = choose(better, mean, best), smallest = select(better, size, smallest);
    busy = busy && converges && size > fine;
    after = choose(busy, after - step, after);
    const auto last = busy && is_last;
    best = choose(last, T(0.5) * (W + after), best);
    busy = busy && !last;
  }
  return choose(smallest < T(0.25) * spin, best, W);
}

}  // namespace cdot::scenes
#endif

)";

}  // namespace cdot::compile
