// A pack of 4, 8 or 16 numbers over the vector extensions of GCC and Clang: a kernel then runs that many joints at
// once. Every operation is the scalar one in each lane, so the bits agree with scalar code.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstring>
#include <type_traits>

#include <cdot/kernel.hpp>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

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
  using Numbers = typename VectorOf<T, width>::Lanes;
  using Vector = typename VectorOf<T, width>::Bits;
  Vector lanes;

  static Mask less(const Numbers& a, const Numbers& b) { return {a < b}; }
  static Mask at_most(const Numbers& a, const Numbers& b) { return {a <= b}; }
  static Mask equal(const Numbers& a, const Numbers& b) { return {a == b}; }
  Numbers choose(const Numbers& a, const Numbers& b) const { return lanes ? a : b; }

  friend Mask operator&&(const Mask& a, const Mask& b) { return {a.lanes & b.lanes}; }
  friend Mask operator||(const Mask& a, const Mask& b) { return {a.lanes | b.lanes}; }
  friend Mask operator!(const Mask& a) { return {~a.lanes}; }
  bool operator[](int lane) const { return lanes[lane] != 0; }
};

// With AVX-512 one bit per lane, in the registers for masks. From vectors GCC 12 goes there and back for each
// comparison and each choice: eight slider cranks took a quarter longer.
#if defined(__AVX512F__) && defined(__AVX512VL__)
#define CDOT_MASK_IN_REGISTER(T, width, Register, Native, operation, suffix)                       \
  template <>                                                                                      \
  struct Mask<T, width> {                                                                          \
    using Numbers = typename VectorOf<T, width>::Lanes;                                            \
    Register lanes;                                                                                \
                                                                                                   \
    static Mask less(const Numbers& a, const Numbers& b) { return of<_CMP_LT_OS>(a, b); }          \
    static Mask at_most(const Numbers& a, const Numbers& b) { return of<_CMP_LE_OS>(a, b); }       \
    static Mask equal(const Numbers& a, const Numbers& b) { return of<_CMP_EQ_OQ>(a, b); }         \
    Numbers choose(const Numbers& a, const Numbers& b) const {                                     \
      return (Numbers)operation##_mask_blend_##suffix(lanes, (Native)b, (Native)a);                \
    }                                                                                              \
                                                                                                   \
    friend Mask operator&&(const Mask& a, const Mask& b) { return {Register(a.lanes & b.lanes)}; } \
    friend Mask operator||(const Mask& a, const Mask& b) { return {Register(a.lanes | b.lanes)}; } \
    friend Mask operator!(const Mask& a) { return {Register(~a.lanes & ((1u << width) - 1))}; }    \
    bool operator[](int lane) const { return (lanes >> lane & 1) != 0; }                           \
                                                                                                   \
   private:                                                                                        \
    template <int comparison>                                                                      \
    static Mask of(const Numbers& a, const Numbers& b) {                                           \
      return {operation##_cmp_##suffix##_mask((Native)a, (Native)b, comparison)};                  \
    }                                                                                              \
  };
CDOT_MASK_IN_REGISTER(float, 4, __mmask8, __m128, _mm, ps)
CDOT_MASK_IN_REGISTER(float, 8, __mmask8, __m256, _mm256, ps)
CDOT_MASK_IN_REGISTER(float, 16, __mmask16, __m512, _mm512, ps)
CDOT_MASK_IN_REGISTER(double, 4, __mmask8, __m256d, _mm256, pd)
CDOT_MASK_IN_REGISTER(double, 8, __mmask8, __m512d, _mm512, pd)
#undef CDOT_MASK_IN_REGISTER
#endif

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
  friend Comparison operator<(const Pack& a, const Pack& b) { return Comparison::less(a.lanes, b.lanes); }
  friend Comparison operator<=(const Pack& a, const Pack& b) { return Comparison::at_most(a.lanes, b.lanes); }
  friend Comparison operator>(const Pack& a, const Pack& b) { return b < a; }
  friend Comparison operator>=(const Pack& a, const Pack& b) { return b <= a; }
  friend Comparison operator==(const Pack& a, const Pack& b) { return Comparison::equal(a.lanes, b.lanes); }
  friend Comparison operator!=(const Pack& a, const Pack& b) { return !(a == b); }

  // An Inf or NaN of the operand not chosen has no effect.
  friend Pack select(const Comparison& condition, const Pack& a, const Pack& b) {
    return Pack(condition.choose(a.lanes, b.lanes));
  }
  // One operation of the processor each.
  friend Pack larger(const Pack& a, const Pack& b) { return Pack(a.lanes > b.lanes ? a.lanes : b.lanes); }
  friend Pack lower(const Pack& a, const Pack& b) { return Pack(a.lanes < b.lanes ? a.lanes : b.lanes); }
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
  using Bits = typename VectorOf<T, width>::Bits;
  constexpr auto all_but_the_sign = static_cast<long long>(sizeof(T) == 4 ? 0x7fffffff : 0x7fffffffffffffff);
  return Pack<T, width>((typename VectorOf<T, width>::Lanes)((Bits)a.lanes & (Bits{} + all_but_the_sign)));
}

#if defined(__SSE2__)
// The widest register that this program may use for so many bytes, and its roots: rounded as those of one number. (GCC
// 12 warns about its own _mm512_sqrt_pd().)
template <class T, std::size_t bytes>
struct RegisterOf : RegisterOf<T, bytes / 2> {};
#define CDOT_REGISTER(T, bytes, Register, roots_of_x) \
  template <>                                         \
  struct RegisterOf<T, bytes> {                       \
    using type = Register;                            \
  };                                                  \
  inline Register roots(Register x) { return roots_of_x; }
CDOT_REGISTER(float, 16, __m128, _mm_sqrt_ps(x))
CDOT_REGISTER(double, 16, __m128d, _mm_sqrt_pd(x))
#if defined(__AVX__)
CDOT_REGISTER(float, 32, __m256, _mm256_sqrt_ps(x))
CDOT_REGISTER(double, 32, __m256d, _mm256_sqrt_pd(x))
#endif
#if defined(__AVX512F__)
CDOT_REGISTER(float, 64, __m512, _mm512_maskz_sqrt_ps(__mmask16(-1), x))
CDOT_REGISTER(double, 64, __m512d, _mm512_maskz_sqrt_pd(__mmask8(-1), x))
#endif
#undef CDOT_REGISTER

template <class T, int width>
Pack<T, width> sqrt(Pack<T, width> a) {
  typename RegisterOf<T, sizeof a.lanes>::type x;
  char* const all = reinterpret_cast<char*>(&a.lanes);
  for (std::size_t at = 0; at < sizeof a.lanes; at += sizeof x) {
    std::memcpy(&x, all + at, sizeof x);
    x = roots(x);
    std::memcpy(all + at, &x, sizeof x);
  }
  return a;
}
#endif

// The functions of one argument in <cmath> that a kernel may call.
#define CDOT_LANE_BY_LANE(function)                            \
  template <class T, int width>                                \
  Pack<T, width> function(const Pack<T, width>& a) {           \
    return each_lane(a, [](T x) { return std::function(x); }); \
  }
#if !defined(__SSE2__)
CDOT_LANE_BY_LANE(sqrt)
#endif
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
