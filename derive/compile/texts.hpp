// Members of a compiled struct that do not depend on the scene.
#pragma once

namespace cdot::compile {

inline constexpr const char* slope_type = R"(  struct Slope {
    Rate v;
    Velocity a;
    friend Slope operator+(const Slope& k, const Slope& l) { return {k.v + l.v, k.a + l.a}; }
    friend Slope operator-(const Slope& k, const Slope& l) { return {k.v - l.v, k.a - l.a}; }
    friend Slope operator-(const Slope& k) { return {-k.v, -k.a}; }
    friend Slope operator*(const T& x, const Slope& k) { return {x * k.v, x * k.a}; }
  };
)";

inline constexpr const char* guards = R"(
  static constexpr bool single = sizeof(typename NumberOf<T>::type) == 4;
  static constexpr double epsilon = single ? 1.1920929e-07 : 2.220446049250313e-16;
  template <class>
  static T smallest() {
    return T(single ? 1.17549435e-38 : 2.2250738585072014e-308);
  }
  // 1/x, and 0 at x = 0.
  static T inverse(const T& x) { return select(magnitude(x) >= smallest<T>(), T(1) / x, T(0)); }
  static T sign(const T& x) { return select(x > T(0), T(1), select(x < T(0), T(-1), T(0))); }
  // 1/d, and 0 where d is round-off beside the diagonal entry k: the row depends on others.
  static T pivot(const T& d, const T& k) { return select(d > T(64 * epsilon) * k, T(1) / d, T(0)); }
)";

inline constexpr const char* slope = R"(
  // The rates of change at a stage of a Runge-Kutta method.
  static void slope($dEvaluated& at, const Velocity (&v)[bodies], Jacobian& J, T (&forces)[rows], Slope (&k)[bodies]) {
    turn(at.q);
$w    evaluate($pat.q, at.time, J);
    Velocity a[bodies];
    accelerate($pat.q, at.time, v, J, forces, a);
    for (int i = 0; i < bodies; ++i) k[i] = {rate_of(at.q[i], v[i]), a[i]};
  }
)";

// Without joints.
inline constexpr const char* free_slope = R"(
  // The rates of change at a stage of a Runge-Kutta method.
  static void slope($dEvaluated& at, const Velocity (&v)[bodies], Slope (&k)[bodies]) {
    turn(at.q);
$w    Velocity a[bodies];
    fall($pat.q, at.time, v, a);
    for (int i = 0; i < bodies; ++i) k[i] = {rate_of(at.q[i], v[i]), a[i]};
  }
)";

}  // namespace cdot::compile
