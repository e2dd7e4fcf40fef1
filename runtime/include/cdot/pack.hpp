// A pack of 4, 8 or 16 numbers over the vector extensions of GCC and Clang: a kernel then runs that many joints at
// once. Every operation is the scalar one in each lane, so the bits agree with scalar code.
#pragma once

#include <cmath>
#include <cstring>
#include <type_traits>

#include <cdot/kernel.hpp>

// GCC warns about the calling convention of vectors wider than the registers. All functions here are inlined, so the
// convention does not apply.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wpsabi"
#endif

namespace cdot {

// One specialisation per width: GCC 12 drops the attribute if the size depends on a template parameter.
template <class T, int width>
struct VectorOf;
template <>
struct VectorOf<float, 4> {
  typedef float Lanes __attribute__((vector_size(16)));
  typedef int Bits __attribute__((vector_size(16)));
};
template <>
struct VectorOf<float, 8> {
  typedef float Lanes __attribute__((vector_size(32)));
  typedef int Bits __attribute__((vector_size(32)));
};
template <>
struct VectorOf<float, 16> {
  typedef float Lanes __attribute__((vector_size(64)));
  typedef int Bits __attribute__((vector_size(64)));
};
template <>
struct VectorOf<double, 4> {
  typedef double Lanes __attribute__((vector_size(32)));
  typedef long long Bits __attribute__((vector_size(32)));
};
template <>
struct VectorOf<double, 8> {
  typedef double Lanes __attribute__((vector_size(64)));
  typedef long long Bits __attribute__((vector_size(64)));
};
template <>
struct VectorOf<double, 16> {
  typedef double Lanes __attribute__((vector_size(128)));
  typedef long long Bits __attribute__((vector_size(128)));
};

// The result of a comparison: per lane all bits set or none.
template <class T, int width>
struct Mask {
  using Vector = typename VectorOf<T, width>::Bits;
  Vector lanes;

  friend Mask operator&&(const Mask& a, const Mask& b) { return {a.lanes & b.lanes}; }
  friend Mask operator||(const Mask& a, const Mask& b) { return {a.lanes | b.lanes}; }
  friend Mask operator!(const Mask& a) { return {~a.lanes}; }
  bool operator[](int lane) const { return lanes[lane] != 0; }
};

template <class T, int width>
struct Pack {
  using Vector = typename VectorOf<T, width>::Lanes;
  Vector lanes;

  Pack() = default;
  Pack(const Vector& v) : lanes(v) {}
  // x in every lane. A template, because kernels write T(1) and T(0.5) also for packs of floats.
  template <class Number>
  requires(std::is_arithmetic_v<Number>) Pack(Number x) : lanes(Vector{} + static_cast<T>(x)) {}

  T operator[](int lane) const { return lanes[lane]; }
  void set(int lane, T x) { lanes[lane] = x; }

  static Pack load(const T* from) {
    Pack p;
    std::memcpy(&p.lanes, from, sizeof(Vector));
    return p;
  }
  void store(T* to) const { std::memcpy(to, &lanes, sizeof(Vector)); }

  friend Pack operator+(const Pack& a, const Pack& b) { return Pack(a.lanes + b.lanes); }
  friend Pack operator-(const Pack& a, const Pack& b) { return Pack(a.lanes - b.lanes); }
  friend Pack operator*(const Pack& a, const Pack& b) { return Pack(a.lanes * b.lanes); }
  friend Pack operator/(const Pack& a, const Pack& b) { return Pack(a.lanes / b.lanes); }
  friend Pack operator-(const Pack& a) { return Pack(-a.lanes); }
  friend Pack operator+(const Pack& a) { return a; }
  Pack& operator+=(const Pack& b) { return *this = *this + b; }
  Pack& operator-=(const Pack& b) { return *this = *this - b; }
  Pack& operator*=(const Pack& b) { return *this = *this * b; }
  Pack& operator/=(const Pack& b) { return *this = *this / b; }

  using Comparison = Mask<T, width>;
  friend Comparison operator<(const Pack& a, const Pack& b) { return {a.lanes < b.lanes}; }
  friend Comparison operator<=(const Pack& a, const Pack& b) { return {a.lanes <= b.lanes}; }
  friend Comparison operator>(const Pack& a, const Pack& b) { return {a.lanes > b.lanes}; }
  friend Comparison operator>=(const Pack& a, const Pack& b) { return {a.lanes >= b.lanes}; }
  friend Comparison operator==(const Pack& a, const Pack& b) { return {a.lanes == b.lanes}; }
  friend Comparison operator!=(const Pack& a, const Pack& b) { return {a.lanes != b.lanes}; }

  // An Inf or NaN of the operand not chosen has no effect. Compilers know a > b ? a : b as the larger one.
  friend Pack select(const Comparison& condition, const Pack& a, const Pack& b) {
    return Pack(condition.lanes ? a.lanes : b.lanes);
  }
};

template <class T, int width>
struct ScalarOf<Pack<T, width>> {
  using type = T;
};

// Calls the scalar function f in each lane: equal bits at every width.
template <class T, int width, class F>
Pack<T, width> each_lane(const Pack<T, width>& a, F f) {
  Pack<T, width> result;
  for (int i = 0; i < width; ++i) result.set(i, f(a[i]));
  return result;
}

template <class T, int width>
Pack<T, width> abs(const Pack<T, width>& a) {
  return each_lane(a, [](T x) { return std::fabs(x); });
}

// The functions of one argument in <cmath> that a kernel may call.
#define CDOT_LANE_BY_LANE(function)                            \
  template <class T, int width>                                \
  Pack<T, width> function(const Pack<T, width>& a) {           \
    return each_lane(a, [](T x) { return std::function(x); }); \
  }
CDOT_LANE_BY_LANE(sqrt)
CDOT_LANE_BY_LANE(cbrt)
CDOT_LANE_BY_LANE(sin)
CDOT_LANE_BY_LANE(cos)
CDOT_LANE_BY_LANE(tan)
CDOT_LANE_BY_LANE(asin)
CDOT_LANE_BY_LANE(acos)
CDOT_LANE_BY_LANE(atan)
CDOT_LANE_BY_LANE(sinh)
CDOT_LANE_BY_LANE(cosh)
CDOT_LANE_BY_LANE(tanh)
CDOT_LANE_BY_LANE(asinh)
CDOT_LANE_BY_LANE(acosh)
CDOT_LANE_BY_LANE(atanh)
CDOT_LANE_BY_LANE(exp)
CDOT_LANE_BY_LANE(log)
CDOT_LANE_BY_LANE(erf)
#undef CDOT_LANE_BY_LANE

template <class T, int width>
Pack<T, width> atan2(const Pack<T, width>& y, const Pack<T, width>& x) {
  Pack<T, width> result;
  for (int i = 0; i < width; ++i) result.set(i, std::atan2(y[i], x[i]));
  return result;
}

}  // namespace cdot
