// Small vectors as a person writes kernels with: each function costs what its formula shows.
#pragma once

#include <cdot/kernel.hpp>

namespace by_hand {

template <class T>
struct V2 {
  T x, y;
};
template <class T>
struct V3 {
  T x, y, z;
};

template <class T>
V2<T> operator+(V2<T> u, V2<T> v) {
  return {u.x + v.x, u.y + v.y};
}
template <class T>
V2<T> operator-(V2<T> u, V2<T> v) {
  return {u.x - v.x, u.y - v.y};
}
template <class T>
V3<T> operator+(V3<T> u, V3<T> v) {
  return {u.x + v.x, u.y + v.y, u.z + v.z};
}
template <class T>
V3<T> operator-(V3<T> u, V3<T> v) {
  return {u.x - v.x, u.y - v.y, u.z - v.z};
}
template <class T>
V3<T> operator*(T s, V3<T> u) {
  return {s * u.x, s * u.y, s * u.z};
}

template <class T>
T dot(V2<T> u, V2<T> v) {
  return u.x * v.x + u.y * v.y;
}
template <class T>
T dot(V3<T> u, V3<T> v) {
  return u.x * v.x + u.y * v.y + u.z * v.z;
}
template <class T>
T cross(V2<T> u, V2<T> v) {
  return u.x * v.y - u.y * v.x;
}
template <class T>
V3<T> cross(V3<T> u, V3<T> v) {
  return {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
}

// The matrix with the first column c, s in the plane; with three given columns in space; its transpose.
template <class T>
V2<T> turned(T c, T s, V2<T> u) {
  return {c * u.x - s * u.y, s * u.x + c * u.y};
}
template <class T>
V2<T> turned_back(T c, T s, V2<T> u) {
  return {c * u.x + s * u.y, c * u.y - s * u.x};
}
template <class T>
V3<T> turned(const cdot::spatial::Pose<T>& q, V3<T> u) {
  return {q.xx * u.x + q.xy * u.y + q.xz * u.z, q.yx * u.x + q.yy * u.y + q.yz * u.z,
          q.zx * u.x + q.zy * u.y + q.zz * u.z};
}
template <class T>
V3<T> turned_back(const cdot::spatial::Pose<T>& q, V3<T> u) {
  return {q.xx * u.x + q.yx * u.y + q.zx * u.z, q.xy * u.x + q.yy * u.y + q.zy * u.z,
          q.xz * u.x + q.yz * u.y + q.zz * u.z};
}

// w' I w of a symmetric tensor.
template <class T>
T turning(const cdot::spatial::InverseMass<T>& m, V3<T> w) {
  return w.x * (m.Ixx * w.x + T(2) * (m.Ixy * w.y + m.Ixz * w.z)) + w.y * (m.Iyy * w.y + T(2) * m.Iyz * w.z) +
         m.Izz * w.z * w.z;
}

}  // namespace by_hand
