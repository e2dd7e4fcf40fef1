// The part of a compiled header that is the same in all of them: arithmetic on numbers and on packs of them.
#pragma once

namespace cdot::compile {

inline constexpr const char* arithmetic = R"(#ifndef CDOT_SCENE_ARITHMETIC
#define CDOT_SCENE_ARITHMETIC
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

// True if the condition holds in any lane.
inline bool any(bool condition) { return condition; }
template <class Mask>
inline bool any(const Mask& condition) {
  for (unsigned i = 0; i < sizeof condition.lanes / sizeof condition.lanes[0]; ++i)
    if (condition.lanes[i]) return true;
  return false;
}

// Angles to sine and cosine, without branches: the same bits in a lane as alone, within 2 units in the last place up to
// 1e5 rad. Reduction by multiples of pi/2 in three parts (Cody and Waite), then the polynomials of fdlibm.
template <class T>
inline void sin_cos(const T& angle, T& s, T& c) {
  constexpr bool single = sizeof(typename NumberOf<T>::type) == 4;
  constexpr double to_integer = single ? 12582912.0 : 6755399441055744.0;  // 1.5 times a power of 2
  const T n = angle * T(0.63661977236758134308) + T(to_integer) - T(to_integer);
  const T x = angle - n * T(single ? 1.5703125 : 1.57079632673412561417) -
              n * T(single ? 4.837512969970703125e-4 : 6.07710050630396597660e-11) -
              n * T(single ? 7.5497899548918819e-8 : 2.02226624879595063154e-21);
  const T m = n - T(4) * (n * T(0.25) + T(to_integer) - T(to_integer));  // the quarter, -2 to 2
  const T z = x * x;
  const T S = T(8.33333333332248946124e-03) +
              z * (T(-1.98412698298579493134e-04) +
                   z * (T(2.75573137070700676789e-06) +
                        z * (T(-2.50507602534068634195e-08) + z * T(1.58969099521155010221e-10))));
  const T C = T(4.16666666666666019037e-02) +
              z * (T(-1.38888888888741095749e-03) +
                   z * (T(2.48015872894767294178e-05) +
                        z * (T(-2.75573143513906633035e-07) +
                             z * (T(2.08757232129817482790e-09) + z * T(-1.13596475577881948265e-11)))));
  const T sine = x + x * z * (T(-1.66666666666666324348e-01) + z * S);
  const T half = T(0.5) * z, rest = T(1) - half;
  const T cosine = rest + ((T(1) - rest - half) + z * z * C);
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
  const T sine =
      d - d * z *
              (T(1.0 / 6) -
               z * (T(1.0 / 120) - z * (T(1.0 / 5040) - z * (T(1.0 / 362880) - z * T(1.0 / 39916800)))));
  const T versine =
      z * (T(0.5) -
           z * (T(1.0 / 24) -
                z * (T(1.0 / 720) - z * (T(1.0 / 40320) - z * (T(1.0 / 3628800) - z * T(1.0 / 479001600))))));
  s = s_0 + (c_0 * sine - s_0 * versine), c = c_0 - (s_0 * sine + c_0 * versine);
  if (slight) s = select(is_slight, s_2, s), c = select(is_slight, c_2, c);
  if (!any(!is_near)) return;
  T far_s, far_c;
  sin_cos(angle, far_s, far_c);
  s = select(is_near, s, far_s), c = select(is_near, c, far_c);
}
// A pose moved by a displacement, number by number: wide copies would wait for numbers just stored.
template <class Pose, class Displacement>
inline void shift(Pose& q, const Displacement& d) {
  using T = decltype(q.angle + q.angle);
  const T s_0 = q.s, c_0 = q.c, angle = q.angle + d.w, turn = angle - q.angle;
  q.x = q.x + d.x, q.y = q.y + d.y, q.angle = angle;
  sin_cos_beside<true>(s_0, c_0, turn, angle, q.s, q.c);
}

}  // namespace cdot::scenes
#endif

)";

}  // namespace cdot::compile
