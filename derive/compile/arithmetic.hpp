// Parts of compiled headers that are the same in all of them: arithmetic on numbers and on packs of them.
#pragma once

#include <string_view>

namespace cdot::compile {

inline constexpr const char* arithmetic = R"(#ifndef CDOT_SCENE_ARITHMETIC
#define CDOT_SCENE_ARITHMETIC
// Compilers call the solves of a step, whose numbers then go through memory. In 8 lanes that takes 4 to 17 % of it. On a
// microcontroller bytes of code count more.
#if defined(__OPTIMIZE__) && !defined(__OPTIMIZE_SIZE__) && (defined(__SSE2__) || defined(__aarch64__))
#define CDOT_SCENE_INLINE [[gnu::always_inline]] inline
#else
#define CDOT_SCENE_INLINE inline
#endif
#if defined(__GNUC__)
#define CDOT_SCENE_RARE [[gnu::noinline, gnu::cold]]
#else
#define CDOT_SCENE_RARE
#endif
namespace cdot::scenes {

// The number in T: T itself, or that of a pack such as cdot::Pack<double, 8>.
template <class T>
struct NumberOf {
  using type = T;
};
template <template <class, int> class Pack, class Number, int width>
struct NumberOf<Pack<Number, width>> {
  using type = Number;
};

// a where the condition is true, else b. A pack brings its own.
inline float select(bool condition, float a, float b) { return condition ? a : b; }
inline double select(bool condition, double a, double b) { return condition ? a : b; }
inline float abs(float x) { return x < 0 ? -x : x; }
inline double abs(double x) { return x < 0 ? -x : x; }

// |x|; a pack's own abs() may go lane by lane.
template <class T>
inline T magnitude(const T& x) {
  return select(x < T(0), -x, x);
}

// The larger and the smaller number. A pack may bring its own.
template <class T>
inline T larger(const T& a, const T& b) {
  return select(a > b, a, b);
}
template <class T>
inline T lower(const T& a, const T& b) {
  return select(a < b, a, b);
}

// True if the condition holds in any lane.
inline bool any(bool condition) { return condition; }
template <class Mask>
inline bool any(const Mask& condition) {
  unsigned long long words[(sizeof condition.lanes + 7) / 8] = {}, some = 0;
  __builtin_memcpy(words, &condition.lanes, sizeof condition.lanes);
  for (const unsigned long long word : words) some |= word;
  return some != 0;
}

// Angles to sine and cosine, without branches: the same bits in a lane as alone, of a double within 2 units in the last
// place up to 1e5 rad, of a float within 1e-7 up to 1e4 rad. Reduction by multiples of pi/2 in three parts (Cody and
// Waite), then the polynomials of fdlibm, in pairs of terms that do not wait for each other (Estrin).
template <class T>
inline void sin_cos(const T& angle, T& s, T& c) {
  constexpr bool single = sizeof(typename NumberOf<T>::type) == 4;
  constexpr double to_integer = single ? 12582912.0 : 6755399441055744.0;  // 1.5 times a power of 2
  const T n = angle * T(0.63661977236758134308) + T(to_integer) - T(to_integer);
  const T x = angle - n * T(single ? 1.5703125 : 1.57079632673412561417) -
              n * T(single ? 4.837512969970703125e-4 : 6.07710050630396597660e-11) -
              n * T(single ? 7.5497899548918819e-8 : 2.02226624879595063154e-21);
  const T m = n - T(4) * (n * T(0.25) + T(to_integer) - T(to_integer));  // the quarter, -2 to 2
  const T z = x * x, zz = z * z;
  const T S = (T(8.33333333332248946124e-03) + z * T(-1.98412698298579493134e-04)) +
              zz * ((T(2.75573137070700676789e-06) + z * T(-2.50507602534068634195e-08)) +
                    zz * T(1.58969099521155010221e-10));
  const T C = (T(4.16666666666666019037e-02) + z * T(-1.38888888888741095749e-03)) +
              zz * ((T(2.48015872894767294178e-05) + z * T(-2.75573143513906633035e-07)) +
                    zz * (T(2.08757232129817482790e-09) + z * T(-1.13596475577881948265e-11)));
  const T sine = x + x * z * (T(-1.66666666666666324348e-01) + z * S);
  const T half = T(0.5) * z, rest = T(1) - half;
  const T cosine = rest + ((T(1) - rest - half) + zz * C);
  const auto odd = (m > T(0.5) && m < T(1.5)) || (m < T(-0.5) && m > T(-1.5));
  const T s_0 = select(odd, cosine, sine), c_0 = select(odd, sine, cosine);
  s = select(m < T(-0.5) || m > T(1.5), -s_0, s_0);
  c = select(m > T(0.5) || m < T(-1.5), -c_0, c_0);
}

// s and c of an angle from s_0 and c_0 of one less by d: their sum formulas, with series up to a quarter of a radian,
// where most are `slight` with two terms up to the move of a correction.
template <bool slight, class T>
inline void sin_cos_beside(const T& s_0, const T& c_0, const T& d, const T& angle, T& s, T& c) {
  const T z = d * d;
  constexpr double least = sizeof(typename NumberOf<T>::type) == 4 ? 1e-6 : 1e-10;  // d^3 / 6 is round-off
  const auto is_near = z < T(0.0625), is_slight = z < T(least);
  const T half = T(0.5) * z, s_2 = s_0 + (c_0 * d - s_0 * half), c_2 = c_0 - (s_0 * d + c_0 * half);
  if (slight && !any(!is_slight)) {
    s = s_2, c = c_2;
    return;
  }
  const T zz = z * z;
  const T sine = d - d * (z * ((T(1.0 / 6) - z * T(1.0 / 120)) +
                               zz * ((T(1.0 / 5040) - z * T(1.0 / 362880)) + zz * T(1.0 / 39916800))));
  const T versine = z * ((T(0.5) - z * T(1.0 / 24)) +
                         zz * ((T(1.0 / 720) - z * T(1.0 / 40320)) +
                               zz * (T(1.0 / 3628800) - z * T(1.0 / 479001600))));
  s = s_0 + (c_0 * sine - s_0 * versine), c = c_0 - (s_0 * sine + c_0 * versine);
  if (slight) s = select(is_slight, s_2, s), c = select(is_slight, c_2, c);
  if (!any(!is_near)) return;
  T far_s, far_c;
  sin_cos(angle, far_s, far_c);
  s = select(is_near, s, far_s), c = select(is_near, c, far_c);
}
template <int... places>
struct Places {};
// Four numbers side by side, where processors take them at once. Their operations are those of one.
template <class T>
struct WideOf {
  using type = T;
  static constexpr bool exists = false;
};
#if defined(__SSE2__) || defined(__aarch64__)
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpsabi"
#endif
struct Four {
  struct Mask {
    typedef long long Lanes __attribute__((vector_size(32)));
    Lanes lanes;
    friend Mask operator&&(const Mask& a, const Mask& b) { return {a.lanes & b.lanes}; }
    friend Mask operator||(const Mask& a, const Mask& b) { return {a.lanes | b.lanes}; }
    friend Mask operator!(const Mask& a) { return {~a.lanes}; }
  };
  typedef double Lanes __attribute__((vector_size(32)));
  Lanes lanes;

  Four() = default;
  Four(const Lanes& x) : lanes(x) {}
  explicit Four(double x) : lanes(Lanes{} + x) {}
  Four(double a, double b, double c, double d) : lanes{a, b, c, d} {}
  void store(double& a, double& b, double& c, double& d) const { a = lanes[0], b = lanes[1], c = lanes[2], d = lanes[3]; }

  friend Four operator+(const Four& a, const Four& b) { return a.lanes + b.lanes; }
  friend Four operator-(const Four& a, const Four& b) { return a.lanes - b.lanes; }
  friend Four operator*(const Four& a, const Four& b) { return a.lanes * b.lanes; }
  friend Four operator-(const Four& a) { return -a.lanes; }
  friend Four operator/(const Four& a, const Four& b) { return a.lanes / b.lanes; }
  friend Mask operator<(const Four& a, const Four& b) { return {a.lanes < b.lanes}; }
  friend Mask operator<=(const Four& a, const Four& b) { return {a.lanes <= b.lanes}; }
  friend Mask operator>(const Four& a, const Four& b) { return {a.lanes > b.lanes}; }
  friend Mask operator>=(const Four& a, const Four& b) { return {a.lanes >= b.lanes}; }
  friend Four select(const Mask& condition, const Four& a, const Four& b) {
    return condition.lanes ? a.lanes : b.lanes;
  }
  friend Four root(const Four& a) {
    return {__builtin_sqrt(a.lanes[0]), __builtin_sqrt(a.lanes[1]), __builtin_sqrt(a.lanes[2]),
            __builtin_sqrt(a.lanes[3])};
  }
};
template <>
struct NumberOf<Four> {
  using type = double;
};
// Numbers of four structs at these places, as those of one wide struct, and back.
template <class Wide, class Narrow, int... places>
inline void gather(Places<places...>, Wide& to, const Narrow& a, const Narrow& b, const Narrow& c, const Narrow& d) {
  Four* const all = reinterpret_cast<Four*>(&to);
  const double *const i = reinterpret_cast<const double*>(&a), *const j = reinterpret_cast<const double*>(&b);
  const double *const k = reinterpret_cast<const double*>(&c), *const l = reinterpret_cast<const double*>(&d);
  ((all[places] = Four{i[places], j[places], k[places], l[places]}), ...);
}
template <class Wide, class Narrow, int... places>
inline void scatter(Places<places...>, const Wide& from, Narrow& a, Narrow& b, Narrow& c, Narrow& d) {
  const Four* const all = reinterpret_cast<const Four*>(&from);
  double *const i = reinterpret_cast<double*>(&a), *const j = reinterpret_cast<double*>(&b);
  double *const k = reinterpret_cast<double*>(&c), *const l = reinterpret_cast<double*>(&d);
  (all[places].store(i[places], j[places], k[places], l[places]), ...);
}
template <>
struct WideOf<double> {
  using type = Four;
  static constexpr bool exists = true;
};
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic pop
#endif
#endif

// Sines and cosines of four poses; one may be named twice.
template <class Pose, int n>
inline void sin_cos_of(Pose (&q)[n], int i, int j, int k, int l) {
  using Wide = typename WideOf<decltype(Pose::angle)>::type;
  Wide s, c;
  sin_cos(Wide{q[i].angle, q[j].angle, q[k].angle, q[l].angle}, s, c);
  s.store(q[i].s, q[j].s, q[k].s, q[l].s), c.store(q[i].c, q[j].c, q[k].c, q[l].c);
}
// Those of the angles, which are beside those of other poses.
template <bool slight, class Pose, int n, class Wide>
inline void sin_cos_near(Pose (&q)[n], const Pose (&from)[n], const Wide& angle, int i, int j, int k, int l) {
  const Pose &e = from[i], &f = from[j], &g = from[k], &h = from[l];
  const Wide s_0{e.s, f.s, g.s, h.s}, c_0{e.c, f.c, g.c, h.c}, before{e.angle, f.angle, g.angle, h.angle};
  Wide s, c;
  sin_cos_beside<slight>(s_0, c_0, angle - before, angle, s, c);
  s.store(q[i].s, q[j].s, q[k].s, q[l].s), c.store(q[i].c, q[j].c, q[k].c, q[l].c);
}

// The same of one pose before it turns by d.
template <class Pose, class Displacement>
inline void sin_cos_after(Pose& q, const Displacement& d) {
  using T = decltype(q.angle + q.angle);
  const T s_0 = q.s, c_0 = q.c, angle = q.angle + d.w;
  sin_cos_beside<true>(s_0, c_0, angle - q.angle, angle, q.s, q.c);
}

}  // namespace cdot::scenes
#endif

)";

// For headers that call them.
inline constexpr const char* functions = R"(#ifndef CDOT_SCENE_FUNCTIONS
#define CDOT_SCENE_FUNCTIONS
namespace cdot::scenes {

// Exponentials and logarithms without branches: the same bits in a lane as alone, within 1 unit in the last place. They
// are objects: no other function of their name takes part.
template <int bytes>
struct WordOf {
  using type = unsigned long long;
};
template <>
struct WordOf<4> {
  using type = unsigned;
};
template <class T>
struct Bits {
  using Number = typename NumberOf<T>::type;
  using Word = typename WordOf<sizeof(Number)>::type;
  static constexpr bool single = sizeof(Number) == 4;
  static constexpr int digits = single ? 23 : 52, bias = single ? 127 : 1023;
  static constexpr double whole = single ? 8388608.0 : 4503599627370496.0;  // 2^digits: whole + n has the bits of n last
  static constexpr Word of_whole = Word(bias + digits) << digits, of_one = Word(bias) << digits;
  // The bits of each number changed by f.
  template <class F>
  static T change(const T& x, F f) {
    Word words[sizeof(T) / sizeof(Number)];
    __builtin_memcpy(words, &x, sizeof x);
    for (Word& word : words) word = f(word);
    T y;
    __builtin_memcpy(&y, words, sizeof y);
    return y;
  }
  static T rounded(const T& x) { return x + T(1.5 * whole) - T(1.5 * whole); }
  static T power_of_two(const T& n) {
    return change(n + T(1.5 * whole + bias), [](Word word) { return word << digits; });
  }
};

// e^x = 2^n e^r with x = n ln 2 + r; of e^r the series up to r^13, added in pairs, whose sums do not wait for each other.
struct Exponential {
  template <class T>
  T operator()(const T& x) const {
    using B = Bits<T>;
    const T n = B::rounded(x * T(1.44269504088896338700)), half = B::rounded(n * T(0.5));
    const T high = x - n * T(B::single ? 0.693359375 : 6.93147180369123816490e-01);
    const T low = n * T(B::single ? -2.12194440e-4 : 1.90821492927058770002e-10);
    const T r = high - low, z = r * r, w = z * z;
    const T by_2 = T(1.0 / 2) + r * T(1.0 / 6) + z * (T(1.0 / 24) + r * T(1.0 / 120));
    const T by_6 = T(1.0 / 720) + r * T(1.0 / 5040) + z * (T(1.0 / 40320) + r * T(1.0 / 362880));
    const T by_10 = T(1.0 / 3628800) + r * T(1.0 / 39916800) + z * (T(1.0 / 479001600) + r * T(1.0 / 6227020800));
    const T y = T(1) + (high + (z * (by_2 + w * by_6 + w * w * by_10) - low));
    const T power = y * B::power_of_two(half) * B::power_of_two(n - half);
    const T most = T(B::single ? 120 : 800);  // beyond the largest and the smallest number
    return select(x > most, T(__builtin_inf()), select(x < -most, T(0), power));
  }
};

// log x = e ln 2 + log m with x = 2^e m, m near 1; with f = m - 1 and s = f / (2 + f), log m = f - s (f - R), where R
// is a polynomial of s^2 (fdlibm).
struct Logarithm {
  template <class T>
  T operator()(const T& x) const {
    using B = Bits<T>;
    using Word = typename B::Word;
    const auto tiny = x < T(B::single ? 1.17549435e-38 : 2.2250738585072014e-308);
    T y = x, e = T(-B::bias);
    if (any(tiny)) y = select(tiny, x * T(4 * B::whole), x), e = select(tiny, e - T(B::digits + 2), e);
    constexpr Word least = B::single ? 0x3f3504f3 : 0x3fe6a09e667f3bcd, shift = B::of_one - least;  // m from sqrt(1/2) on
    e = e + (B::change(y, [](Word word) { return (word + shift) >> B::digits | B::of_whole; }) - T(B::whole));
    const T m = B::change(y, [](Word word) { return ((word + shift) & ((Word(1) << B::digits) - 1)) + least; });
    const T f = m - T(1), s = f / (T(2) + f), z = s * s, w = z * z;
    const T R = z * (T(6.666666666666735130e-01) + w * T(2.857142874366239149e-01) +
                     w * w * (T(1.818357216161805012e-01) + w * T(1.479819860511658591e-01))) +
                w * (T(3.999999999940941908e-01) + w * (T(2.222219843214978396e-01) + w * T(1.531383769920937332e-01)));
    const T half = T(0.5) * f * f;
    const T high = T(B::single ? 0.693359375 : 6.93147180369123816490e-01);
    const T low = T(B::single ? -2.12194440e-4 : 1.90821492927058770002e-10);
    const T value = e * high - ((half - (s * (half + R) + e * low)) - f);
    const T endless = T(__builtin_inf());
    return select(x > T(0), select(x < endless, value, x), select(x < T(0), T(__builtin_nan("")), x - endless));
  }
};

}  // namespace cdot::scenes
#endif

)";

// The type of the object that stands for a function of <cmath>; null: none does.
inline const char* own_function(std::string_view name) {
  return name == "exp" ? "Exponential" : name == "log" ? "Logarithm" : nullptr;
}

}  // namespace cdot::compile
