// Members of a compiled struct that do not depend on the scene.
#pragma once

namespace cdot::compile {

inline constexpr const char* slope_type = R"(  struct Slope {
    Velocity v, a;
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

// J a without dC/dt, which `rates` adds for driven joints.
inline constexpr const char* accelerate_by_rates = R"(
  // M a = f + J^T lambda with J a = gamma.
  static void accelerate(const Pose (&q)[bodies], const Velocity (&v)[bodies], const T& time, const Jacobian& J,
                         T (&lambda)[rows], Velocity (&a)[bodies]) {
    T g[rows], Ja[rows];
    fall(q, time, v, a);
    gamma(q, v, time, g);
    rates(J, a, Ja);
    for (int i = 0; i < rows; ++i) g[i] = g[i] - Ja[i];
    Velocity d[bodies];
    solve(J, g, lambda, d);
    for (int i = 0; i < bodies; ++i) a[i] = a[i] + d[i];
  }
)";

inline constexpr const char* accelerate_driven = R"(
  // M a = f + J^T lambda with J a = gamma.
  static void accelerate(const Pose (&q)[bodies], const Velocity (&v)[bodies], const T& time, const Jacobian& J,
                         T (&lambda)[rows], Velocity (&a)[bodies]) {
    T g[rows], Ja[rows], C_t[rows];
    fall(q, time, v, a);
    gamma(q, v, time, g);
    rates(J, a, Ja);
    Velocity none[bodies];
    for (int i = 0; i < bodies; ++i) none[i] = {T(0), T(0), T(0)};
    rates(J, none, C_t);  // dC/dt is no part of J a
    for (int i = 0; i < rows; ++i) g[i] = g[i] - (Ja[i] - C_t[i]);
    Velocity d[bodies];
    solve(J, g, lambda, d);
    for (int i = 0; i < bodies; ++i) a[i] = a[i] + d[i];
  }
)";

inline constexpr const char* slope = R"(
  // The rates of change at a stage of a Runge-Kutta method.
  static void slope(Evaluated& at, const Velocity (&v)[bodies], Jacobian& J, T (&forces)[rows], Slope (&k)[bodies]) {
    turn(at.q);
    evaluate(at.q, at.time, J);
    Velocity a[bodies];
    accelerate(at.q, v, at.time, J, forces, a);
    for (int i = 0; i < bodies; ++i) k[i] = {v[i], a[i]};
  }
)";

// Without joints.
inline constexpr const char* free_slope = R"(
  // The rates of change at a stage of a Runge-Kutta method.
  static void slope(Evaluated& at, const Velocity (&v)[bodies], Slope (&k)[bodies]) {
    turn(at.q);
    Velocity a[bodies];
    fall(at.q, at.time, v, a);
    for (int i = 0; i < bodies; ++i) k[i] = {v[i], a[i]};
  }
)";

// As the World does it: runtime/solve/direct.cpp.
inline constexpr const char* corrections = R"(
  static T largest(const T (&of_rows)[rows]) {{
    T most = T(0);
    for (const T& of_row : of_rows) most = select(magnitude(of_row) > most, magnitude(of_row), most);
    return most;
  }}

  // Newton on C, with J as it is evaluated: anew where a round leaves more than the share `slow` of the error. Adds up
  // the moves. Returns the error before. A lane that is done waits for the others unchanged.
  static T close(State& s, Evaluated& at, const T& slow, Velocity (&moves)[bodies]) {{
    for (int i = 0; i < bodies; ++i) moves[i] = {{T(0), T(0), T(0)}};
    const T left = s.residual;
    T before = T(1e30), error = T(0);
    auto goes_on = T(0) < T(1), renewed = T(1) < T(0);
    for (int round = 0;; ++round) {{
      T C[rows], unused[rows];
      errors(s.q, s.time, C);
      const T worst = largest(C);
      s.residual = worst;
      goes_on = goes_on && worst > T(single ? 1e7 * {0} : {0});
      if (round == 0) {{
        error = worst;
        goes_on = goes_on && !(magnitude(worst - left) <= T(single ? -1 : 1e-9) * worst);  // contradicting joints
      }}
      const auto is_slow = goes_on && worst > slow * before;
      goes_on = goes_on && !(is_slow && renewed && worst > T(0.5) * before);
      if (!any(goes_on) || round == 20) return error;
      const auto renews = goes_on && is_slow;
      if (any(renews)) {{
        at.time = select(renews, s.time, at.time);
        for (int i = 0; i < bodies; ++i) {{
          Pose& q = at.q[i];
          q = {{select(renews, s.q[i].x, q.x), select(renews, s.q[i].y, q.y), select(renews, s.q[i].angle, q.angle),
               select(renews, s.q[i].c, q.c), select(renews, s.q[i].s, q.s)}};
        }}
        evaluate(at.q, at.time, s.J);
        renewed = renewed || renews;
      }}
      before = worst;
      for (T& of_row : C) of_row = -of_row;
      Velocity d[bodies];
      solve(s.J, C, unused, d);
      for (int i = 0; i < bodies; ++i) {{
        d[i] = {{select(goes_on, d[i].x, T(0)), select(goes_on, d[i].y, T(0)), select(goes_on, d[i].w, T(0))}};
        moves[i] = moves[i] + d[i];
        s.q[i] = moved(s.q[i], d[i]);
      }}
      turn(s.q);
    }}
  }}

  // Velocities onto J v = -dC/dt.
  static void project(State& s) {{
    T b[rows], unused[rows];
    rates(s.J, s.v, b);
    for (T& of_row : b) of_row = -of_row;
    Velocity d[bodies];
    solve(s.J, b, unused, d);
    for (int i = 0; i < bodies; ++i) s.v[i] = s.v[i] + d[i];
  }}
)";

}  // namespace cdot::compile
