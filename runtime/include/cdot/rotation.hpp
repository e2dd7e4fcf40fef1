// Vectors, symmetric tensors and rotations in space, for inertia tensors that turn with their bodies and for the exact
// rotation by a vector.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include <cdot/kernel.hpp>

namespace cdot::spatial {

template <class T>
struct Vector {
  T x, y, z;

  friend Vector operator+(const Vector& a, const Vector& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vector operator-(const Vector& a, const Vector& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vector operator*(T s, const Vector& a) { return {s * a.x, s * a.y, s * a.z}; }
};

template <class T>
T dot(const Vector<T>& a, const Vector<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
Vector<T> cross(const Vector<T>& a, const Vector<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
T norm(const Vector<T>& a) {
  return std::sqrt(dot(a, a));
}

template <class T>
struct Symmetric {
  T xx, yy, zz, xy, xz, yz;

  friend Vector<T> operator*(const Symmetric& S, const Vector<T>& a) {
    return {S.xx * a.x + S.xy * a.y + S.xz * a.z, S.xy * a.x + S.yy * a.y + S.yz * a.z,
            S.xz * a.x + S.yz * a.y + S.zz * a.z};
  }
  friend Symmetric operator+(const Symmetric& A, const Symmetric& B) {
    return {A.xx + B.xx, A.yy + B.yy, A.zz + B.zz, A.xy + B.xy, A.xz + B.xz, A.yz + B.yz};
  }
  friend Symmetric operator*(T s, const Symmetric& A) {
    return {s * A.xx, s * A.yy, s * A.zz, s * A.xy, s * A.xz, s * A.yz};
  }
};

// A power of two near 1 / size of the tensor; 1 for the zero tensor. Scaling by it is exact and keeps products of three
// moments of inertia within the range of floats.
template <class T>
T unit_of(const Symmetric<T>& S) {
  const T largest = std::max({std::abs(S.xx), std::abs(S.yy), std::abs(S.zz)});
  return largest > T(0) ? std::scalbn(T(1), -std::ilogb(largest)) : T(1);
}

// Without this the tensor's inverse would hide the kernels' inverse of a number from headers that follow.
using cdot::inverse;

// S^-1 by cofactors; 0 for the zero tensor.
template <class T>
Symmetric<T> inverse(const Symmetric<T>& tensor) {
  const T unit = unit_of(tensor);
  const Symmetric<T> S = unit * tensor;
  const T cxx = S.yy * S.zz - S.yz * S.yz, cxy = S.xz * S.yz - S.xy * S.zz, cxz = S.xy * S.yz - S.xz * S.yy;
  const T scale = unit * cdot::inverse(S.xx * cxx + S.xy * cxy + S.xz * cxz);
  return {scale * cxx, scale * (S.xx * S.zz - S.xz * S.xz), scale * (S.xx * S.yy - S.xy * S.xy), scale * cxy,
          scale * cxz, scale * (S.xy * S.xz - S.xx * S.yz)};
}

// S with its negative eigenvalues set to 0. Each Jacobi rotation zeroes one off-diagonal entry, until all are 0.
template <class T>
Symmetric<T> positive_part(const Symmetric<T>& S) {
  T A[3][3] = {{S.xx, S.xy, S.xz}, {S.xy, S.yy, S.yz}, {S.xz, S.yz, S.zz}};
  T V[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};  // its columns become the eigenvectors
  for (int sweep = 0; sweep < 8; ++sweep) {
    for (int i = 0; i < 2; ++i) {
      for (int j = i + 1; j < 3; ++j) {
        if (A[i][j] == T(0)) continue;
        const T half = (A[j][j] - A[i][i]) / (T(2) * A[i][j]);
        const T t =
            (half < T(0) ? T(-1) : T(1)) / (std::fabs(half) + std::sqrt(half * half + T(1)));  // tan of the angle
        const T c = T(1) / std::sqrt(t * t + T(1)), s = t * c;
        for (int k = 0; k < 3; ++k) {
          const T a = A[k][i], b = A[k][j], u = V[k][i], v = V[k][j];
          A[k][i] = c * a - s * b, A[k][j] = s * a + c * b;
          V[k][i] = c * u - s * v, V[k][j] = s * u + c * v;
        }
        for (int k = 0; k < 3; ++k) {
          const T a = A[i][k], b = A[j][k];
          A[i][k] = c * a - s * b, A[j][k] = s * a + c * b;
        }
      }
    }
  }
  Symmetric<T> sum{};
  for (int k = 0; k < 3; ++k) {
    const T x = V[0][k], y = V[1][k], z = V[2][k];
    const T value = A[k][k] > T(0) ? A[k][k] : T(0);
    sum = sum + value * Symmetric<T>{x * x, y * y, z * z, x * y, x * z, y * z};
  }
  return sum;
}

// A v and A^T v
template <class T>
Vector<T> to_world(const Pose<T>& q, const Vector<T>& v) {
  return {q.xx * v.x + q.xy * v.y + q.xz * v.z, q.yx * v.x + q.yy * v.y + q.yz * v.z,
          q.zx * v.x + q.zy * v.y + q.zz * v.z};
}
template <class T>
Vector<T> to_body(const Pose<T>& q, const Vector<T>& v) {
  return {q.xx * v.x + q.yx * v.y + q.zx * v.z, q.xy * v.x + q.yy * v.y + q.zy * v.z,
          q.xz * v.x + q.yz * v.y + q.zz * v.z};
}

// A S A^T
template <class T>
Symmetric<T> turned(const Pose<T>& q, const Symmetric<T>& S) {
  const Vector<T> x = {q.xx, q.xy, q.xz}, y = {q.yx, q.yy, q.yz}, z = {q.zx, q.zy, q.zz};
  const Vector<T> Sx = S * x, Sy = S * y, Sz = S * z;
  return {dot(x, Sx), dot(y, Sy), dot(z, Sz), dot(x, Sy), dot(x, Sz), dot(y, Sz)};
}

// A pose from Euler parameters of any length but 0: normalises them and computes A(e).
template <class T>
Pose<T> oriented(T x, T y, T z, T e0, T e1, T e2, T e3) {
  const T scale = T(1) / std::sqrt(e0 * e0 + e1 * e1 + e2 * e2 + e3 * e3);
  e0 *= scale, e1 *= scale, e2 *= scale, e3 *= scale;
  const T two = T(2);
  return {x,
          y,
          z,
          e0,
          e1,
          e2,
          e3,
          T(1) - two * (e2 * e2 + e3 * e3),
          two * (e1 * e2 - e0 * e3),
          two * (e1 * e3 + e0 * e2),
          two * (e1 * e2 + e0 * e3),
          T(1) - two * (e1 * e1 + e3 * e3),
          two * (e2 * e3 - e0 * e1),
          two * (e1 * e3 - e0 * e2),
          two * (e2 * e3 + e0 * e1),
          T(1) - two * (e1 * e1 + e2 * e2)};
}

// sin(a/2) / a = sinc(a/2) / 2, accurate near 0.
template <class T>
T half_sinc(T a) {
  return a * a < std::numeric_limits<T>::epsilon() ? T(0.5) - a * a / T(48) : std::sin(a / 2) / a;
}

// exp(turn) q: the exact rotation by |turn| about turn, applied after the pose's own. Normalising the product keeps
// round-off from accumulating.
template <class T>
Pose<T> turned_by(const Pose<T>& q, const Vector<T>& turn) {
  const T angle = norm(turn);
  if (angle == T(0)) return q;
  const T c = std::cos(angle / 2), s = half_sinc(angle);
  const T x = s * turn.x, y = s * turn.y, z = s * turn.z;
  return oriented(q.x, q.y, q.z, c * q.e0 - x * q.e1 - y * q.e2 - z * q.e3, c * q.e1 + x * q.e0 + y * q.e3 - z * q.e2,
                  c * q.e2 + y * q.e0 + z * q.e1 - x * q.e3, c * q.e3 + z * q.e0 + x * q.e2 - y * q.e1);
}

// The rotation vector that takes `from` to `to` by the shorter way: |turn| <= pi.
template <class T>
Vector<T> turn_between(const Pose<T>& from, const Pose<T>& to) {
  T c = to.e0 * from.e0 + to.e1 * from.e1 + to.e2 * from.e2 + to.e3 * from.e3;
  Vector<T> v = {to.e1 * from.e0 - to.e0 * from.e1 - to.e2 * from.e3 + to.e3 * from.e2,
                 to.e2 * from.e0 - to.e0 * from.e2 - to.e3 * from.e1 + to.e1 * from.e3,
                 to.e3 * from.e0 - to.e0 * from.e3 - to.e1 * from.e2 + to.e2 * from.e1};
  if (c < T(0)) c = -c, v = T(-1) * v;
  const T s = norm(v);
  return (s == T(0) ? T(2) : T(2) * std::atan2(s, c) / s) * v;
}

}  // namespace cdot::spatial
