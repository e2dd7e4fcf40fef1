#include "derive/compile/collocation/radau.hpp"

#include <algorithm>
#include <fmt/args.h>
#include <fmt/format.h>
#include <vector>

#include "derive/compile/methods/modes.hpp"
#include "derive/compile/methods/runge_kutta.hpp"
#include "derive/compile/methods/strides.hpp"
#include "derive/compile/scene/groups.hpp"
#include "runtime/step/runge_kutta_tables.hpp"

namespace cdot::compile {
namespace {

// (shift - df/dy) (dq, dv) = (r, r') for a real or a complex shift, by
//   (shift - J_v - J_q / shift) dv = r' + J_q B^+ r / shift,   dq = (r + B dv) / shift,   dq/dt = B v.
// Elimination needs no other order of the rows: with the masses, J_q is minus a stiffness.
constexpr const char* newton = R"(
  static constexpr int freedom = {0}, unknowns = bodies * freedom;  // components of velocities
  // Components go mechanism by mechanism: the body of each place, and where its mechanism begins and ends.
  static constexpr int body_of[bodies] = {{{2}}}, begins[bodies] = {{{3}}}, ends[bodies] = {{{4}}};
  static constexpr int widest = {5};  // of them, in components
  // The place of component k among the numbers of a Slope, and the components of its mechanism.
  static constexpr int place_of(int k) {{ return (body_of[k / freedom] + 1) * Slope::of_body - freedom + k % freedom; }}
  static constexpr int begin_of(int k) {{ return freedom * begins[k / freedom]; }}
  static constexpr int end_of(int k) {{ return freedom * ends[k / freedom]; }}

  struct Complex {{
    T re, im;
    friend Complex operator+(const Complex& a, const Complex& b) {{ return {{a.re + b.re, a.im + b.im}}; }}
    friend Complex operator-(const Complex& a, const Complex& b) {{ return {{a.re - b.re, a.im - b.im}}; }}
    friend Complex operator*(const Complex& a, const Complex& b) {{
      return {{a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re}};
    }}
    friend Complex operator*(const T& a, const Complex& b) {{ return {{a * b.re, a * b.im}}; }}
  }};
  static T reciprocal(const T& x) {{ return T(1) / x; }}
  static Complex reciprocal(const Complex& z) {{
    const T by = T(1) / (z.re * z.re + z.im * z.im);
    return {{by * z.re, -(by * z.im)}};
  }}
  static void set_zero(T& x) {{ x = T(0); }}
  static void set_zero(Complex& z) {{ z.re = T(0), z.im = T(0); }}

  // Accelerations by displacements and by velocities, at the start of a step.
  struct Differences {{
    T by_pose[unknowns][unknowns], by_velocity[unknowns][unknowns];
  }};
  // shift - J_v - J_q / shift = L U; the diagonal has the inverse pivots.
  template <class Number>
  struct Newton {{
    Number shift, LU[unknowns][unknowns];
  }};

  template <class Number>
  static void factor(const Differences& J, Newton<Number>& of) {{
    const Number by = reciprocal(of.shift);
    for (int r = 0; r < unknowns; ++r) {{
      for (int c = begin_of(r); c < end_of(r); ++c) {{
        Number sum;
        set_zero(sum);
        if (r == c) sum = of.shift;
        of.LU[r][c] = sum - (J.by_pose[r][c] * by + J.by_velocity[r][c] * (of.shift * by));
      }}
    }}
    for (int k = 0; k < unknowns; ++k) {{
      of.LU[k][k] = reciprocal(of.LU[k][k]);
      for (int r = k + 1; r < end_of(k); ++r) {{
        of.LU[r][k] = of.LU[r][k] * of.LU[k][k];
        for (int c = k + 1; c < end_of(k); ++c) of.LU[r][c] = of.LU[r][c] - of.LU[r][k] * of.LU[k][c];
      }}
    }}
  }}

{1}
  template <class Number>
  static void solve_shifted(const Pose (&q)[bodies], const Differences& J, const Newton<Number>& of,
                            Number (&side)[Slope::size]) {{
    const Number by = reciprocal(of.shift);
    Number turned[unknowns], x[unknowns];
    for (int p = 0; p < bodies; ++p)
      turn_back(q[body_of[p]], side + Slope::of_body * body_of[p], turned + freedom * p);
    for (int r = 0; r < unknowns; ++r) {{
      Number sum;
      set_zero(sum);
      for (int c = begin_of(r); c < end_of(r); ++c) sum = sum + J.by_pose[r][c] * turned[c];
      x[r] = side[place_of(r)] + by * sum;
      for (int c = begin_of(r); c < r; ++c) x[r] = x[r] - of.LU[r][c] * x[c];
    }}
    for (int r = unknowns - 1; r >= 0; --r) {{
      for (int c = r + 1; c < end_of(r); ++c) x[r] = x[r] - of.LU[r][c] * x[c];
      x[r] = x[r] * of.LU[r][r];
      side[place_of(r)] = x[r];
    }}
    for (int p = 0; p < bodies; ++p)
      turn_on(q[body_of[p]], by, x + freedom * p, side + Slope::of_body * body_of[p]);
  }}
)";

constexpr const char* planar_turns = R"(  // B^+ r, and (r + B v) / shift
  template <class Number>
  static void turn_back(const Pose&, const Number* r, Number* v) {
    for (int c = 0; c < freedom; ++c) v[c] = r[c];
  }
  template <class Number>
  static void turn_on(const Pose&, const Number& by, const Number* v, Number* r) {
    for (int c = 0; c < freedom; ++c) r[c] = by * (r[c] + v[c]);
  }
  static Rate numbers_of(const Pose& q) { return {q.x, q.y, q.angle}; }
)";

// de/dt = (0, w) e / 2, so w = 2 de/dt e^-1.
constexpr const char* spatial_turns = R"(  // B^+ r, and (r + B v) / shift
  template <class Number>
  static void turn_back(const Pose& q, const Number* r, Number* v) {
    const Number *const e = r + 3;
    for (int c = 0; c < 3; ++c) v[c] = r[c];
    v[3] = T(2) * ((q.e0 * e[1] - q.e1 * e[0]) + (q.e2 * e[3] - q.e3 * e[2]));
    v[4] = T(2) * ((q.e0 * e[2] - q.e2 * e[0]) + (q.e3 * e[1] - q.e1 * e[3]));
    v[5] = T(2) * ((q.e0 * e[3] - q.e3 * e[0]) + (q.e1 * e[2] - q.e2 * e[1]));
  }
  template <class Number>
  static void turn_on(const Pose& q, const Number& by, const Number* v, Number* r) {
    Number zero;
    set_zero(zero);
    const Number x = T(0.5) * v[3], y = T(0.5) * v[4], z = T(0.5) * v[5];
    const Number e[] = {zero - (q.e1 * x + q.e2 * y + q.e3 * z), q.e0 * x + (q.e3 * y - q.e2 * z),
                        q.e0 * y + (q.e1 * z - q.e3 * x), q.e0 * z + (q.e2 * x - q.e1 * y)};
    for (int c = 0; c < 3; ++c) r[c] = by * (r[c] + v[c]);
    for (int c = 0; c < 4; ++c) r[3 + c] = by * (r[3 + c] + e[c]);
  }
  static Rate numbers_of(const Pose& q) { return {q.x, q.y, q.z, q.e0, q.e1, q.e2, q.e3}; }
)";

// {0}: after the velocities; {1}: the accelerations there; {2}: declares forces; {3}: turns; {4}: size; {5}: lengths.
constexpr const char* differentiates = R"(
  // In `by`: a difference of half the digits in one component of each mechanism, beside speeds.
  static void set_difference(Slope& by, int column, const Slope& speeds) {{
    for (T& number : by.of) number = T(0);
    for (int p = 0; p < bodies; ++p) {{
      const int k = freedom * p + column % freedom;
      const T size = larger(T(column % freedom < {5} ? {4} : 1), magnitude(speeds.of[place_of(k)]));
      if (k == begin_of(k) + column) by.of[place_of(k)] = T(single ? 3e-4 : 1.5e-8) * size;
    }}
  }}
  // Its column, in each mechanism.
  static void take_difference(T (&to)[unknowns][unknowns], int column, const Slope& by, const Slope& base,
                              const Slope& moved) {{
    for (int r = 0; r < unknowns; ++r) {{
      const int c = begin_of(r) + column;
      if (c < end_of(r)) to[r][c] = (moved.of[place_of(r)] - base.of[place_of(r)]) / by.of[place_of(c)];
    }}
  }}

  static void differentiate(State& s, Differences& to) {{
    Slope by, moved, speeds, base;
    Evaluated at;
    Velocity v[bodies];
{2}    at.time = s.time;
    for (int i = 0; i < bodies; ++i) speeds.set(i, rate_of(s.q[i], s.v[i]), s.v[i]);
    for (int i = 0; i < bodies; ++i) base.set(i, rate_of(s.q[i], s.v[i]), s.a[i]);
    for (int column = 0; column < widest; ++column) {{
      set_difference(by, column, speeds);
      for (int i = 0; i < bodies; ++i) v[i] = s.v[i] + by.acceleration(i);
      {1}
      for (int i = 0; i < bodies; ++i) moved.set(i, rate_of(s.q[i], s.v[i]), s.a[i]);
      take_difference(to.by_velocity, column, by, base, moved);
    }}
    for (T& number : speeds.of) number = T(0);
    for (int column = 0; column < widest; ++column) {{
      set_difference(by, column, speeds);
      for (int i = 0; i < bodies; ++i) at.q[i] = s.q[i];
      for (int i = 0; i < bodies; ++i) move(at.q[i], s.q[i], by.acceleration(i));
{3}      slope($sat, s.v, {0}moved);
      take_difference(to.by_pose, column, by, base, moved);
    }}
  }}
)";

// {0} to {8}: A^-1 by rows, {9} to {17}: T^-1, {18} to {26}: T.
constexpr const char* rounds = R"(
  // A^-1 z / h: the slopes at the stages.
  static void slopes_of(const Slope (&z)[3], const T& h, int number, T (&k)[3]) {{
    const T a = z[0].of[number] / h, b = z[1].of[number] / h, c = z[2].of[number] / h;
    k[0] = T({0}) * a + T({1}) * b + T({2}) * c;
    k[1] = T({3}) * a + T({4}) * b + T({5}) * c;
    k[2] = T({6}) * a + T({7}) * b + T({8}) * c;
  }}

  // The change of z by a round of Newton, from the slopes f at the stages.
  static void improve(const State& s, const Differences& J, const Newton<T>& real, const Newton<Complex>& complex,
                      const T& h, const Slope (&f)[3], const Slope (&z)[3], Slope (&change)[3]) {{
    T side[Slope::size];
    Complex sides[Slope::size];
    for (int k = 0; k < Slope::size; ++k) {{
      T lack[3];
      slopes_of(z, h, k, lack);
      for (int j = 0; j < 3; ++j) lack[j] = f[j].of[k] - lack[j];
      side[k] = T({9}) * lack[0] + T({10}) * lack[1] + T({11}) * lack[2];
      sides[k].re = T({12}) * lack[0] + T({13}) * lack[1] + T({14}) * lack[2];
      sides[k].im = T({15}) * lack[0] + T({16}) * lack[1] + T({17}) * lack[2];
    }}
    solve_shifted(s.q, J, real, side);
    solve_shifted(s.q, J, complex, sides);
    for (int k = 0; k < Slope::size; ++k) {{
      change[0].of[k] = T({18}) * side[k] + T({19}) * sides[k].re + T({20}) * sides[k].im;
      change[1].of[k] = T({21}) * side[k] + T({22}) * sides[k].re + T({23}) * sides[k].im;
      change[2].of[k] = T({24}) * side[k] + T({25}) * sides[k].re + T({26}) * sides[k].im;
    }}
  }}
)";

// {0}: declares forces; {1}: turns; {2}: after the velocities; {3} to {5}: c; {6}: size; {7}: lengths, {8}: numbers of
// a pose.
constexpr const char* finds = R"(
  // The largest change, in units of the mechanism's size, [rad], and their rates; `start`: the numbers there.
  static T largest_change(const Slope (&change)[3], const Slope& start) {{
    constexpr double goal = single ? 1e-6 : 1e-14;
    T worst = T(0);
    for (int k = 0; k < Slope::size; ++k) {{
      const int number = k % Slope::of_body, of_velocity = number - {8};
      const T size = magnitude(start.of[k]), own = T((of_velocity < 0 ? number : of_velocity) < {7} ? {6} : 1);
      const T unit = larger(of_velocity < 0 ? own : own + size, T(4 * epsilon / goal) * size);
      for (const Slope& of_stage : change) {{
        const T share = magnitude(of_stage.of[k]) / unit;
        worst = select(share <= worst, worst, share);
      }}
    }}
    return worst;
  }}

  // z_i = h sum_j a_ij f(y + z_j), by Newton with df/dy at the start of the step. A lane that is done waits for the
  // others unchanged. True where the rounds do not settle. Leaves in `at` the poses of the last stage.
  static Mask find_increments(State& s, const T& h, Slope (&z)[3], Evaluated& at) {{
    constexpr double c[3] = {{{3}, {4}, {5}}}, goal = single ? 1e-6 : 1e-14;
    Slope start, f[3], change[3];
    Velocity v[bodies];
{0}    for (int i = 0; i < bodies; ++i) start.set(i, numbers_of(s.q[i]), s.v[i]);
    for (int stage = 0; stage < 3; ++stage) {{
      const T t = T(c[stage]) * h;
      for (int i = 0; i < bodies; ++i) v[i] = s.v[i] + T(0.5) * t * s.a[i];
      for (int i = 0; i < bodies; ++i) z[stage].set(i, t * rate_of(s.q[i], v[i]), t * s.a[i]);
    }}
    Differences J;
    Newton<T> real;
    Newton<Complex> complex;
    differentiate(s, J);
    real.shift = T({9}) / h, complex.shift = {{T({10}) / h, T({11}) / h}};
    factor(J, real);
    factor(J, complex);
    T before = T(1);
    Mask busy = T(0) < T(1), fails = T(1) < T(0);
    for (int round = 0; round < 25 && any(busy); ++round) {{
      for (int stage = 0; stage < 3; ++stage) {{
        at.time = s.time + T(c[stage]) * h;
        for (int i = 0; i < bodies; ++i) move(at.q[i], s.q[i], z[stage].rate(i));
        for (int i = 0; i < bodies; ++i) v[i] = s.v[i] + z[stage].acceleration(i);
{1}        slope($sat, v, {2}f[stage]);
      }}
      improve(s, J, real, complex, h, f, z, change);
      const T worst = largest_change(change, start), rate = worst / before;
      const Mask first = worst <= T(0.1 * goal), later = worst * rate <= (T(1) - rate) * T(goal),
                 stalls = rate > T(0.5) && worst <= T(1e4 * goal);
      const Mask wrong = !(worst < T(1e30)), stands = rate >= T(0.99);
      for (int k = 0; k < 3 * Slope::size; ++k) {{
        T& number = z[k / Slope::size].of[k % Slope::size];
        number = select(busy, number + change[k / Slope::size].of[k % Slope::size], number);
      }}
      const Mask settles = round == 0 ? first : later || stalls;
      fails = fails || (busy && !settles && (round > 2 ? wrong || stands : wrong));
      busy = busy && !settles && !fails;
      before = worst;
    }}
    return fails || busy;
  }}
)";

// {0}: the end.
constexpr const char* collocates = R"(
  // A step, or where its equations do not settle none: 1e30.
  static T collocate(State& s, const T& h) {{
    Slope z[3];
    Evaluated at;
    const Mask fails = find_increments(s, h, z, at);
    for (int i = 0; i < bodies; ++i) move(s.q[i], s.q[i], z[2].rate(i));
    for (int i = 0; i < bodies; ++i) s.v[i] = s.v[i] + z[2].acceleration(i);
    return select(fails, T(1e30), end(s, h, at));
  }}

  static T end(State& s, const T& h, Evaluated& at) {{
    (void)at;
{0}  }}

  // Radau IIA of order 5, on accelerations; its parts are halves, quarters or less where a longer one does not settle.
  // A lane whose sixteenth does not settle stays there, and returns 1e30. One that is done waits for the others. It
  // estimates no error: the World also halves steps by theirs, or where a projection undoes the motion, and finishes by
  // the midpoint rule what does not settle.
  static T {1} {{
    T left = h, part = h, residual = T(0);
    for (Mask goes_on = T(0) < T(1); any(goes_on);) {{
      State next = s;
      const T error = collocate(next, select(goes_on, part, h));
      const Mask fails = !(error < T(1e30)), taken = goes_on && !fails, stays = fails && part < T(0.1) * h;
      replace(s, next, taken);
      residual = select(taken && residual < error, error, select(goes_on && stays, T(1e30), residual));
      left = select(taken, left - part, left);
      part = select(fails, T(0.5) * part, left);
      goes_on = goes_on && !stays && left > T(0);
    }}
    return residual;
  }}
)";

// Moving bodies, mechanism by mechanism.
struct Places {
  std::vector<int> body, begins, ends;
  std::size_t widest = 0;
};

Places places_of(const Mechanism& mechanism) {
  std::vector<int> groups = groups_of(mechanism);
  std::erase(groups, -1);
  Places places;
  const int count = groups.empty() ? 0 : 1 + std::ranges::max(groups);
  for (int group = 0; group < count; ++group) {
    const auto size = static_cast<std::size_t>(std::ranges::count(groups, group));
    const int begin = static_cast<int>(places.body.size());
    for (std::size_t b = 0; b < groups.size(); ++b)
      if (groups[b] == group) places.body.push_back(static_cast<int>(b));
    places.begins.resize(places.body.size(), begin);
    places.ends.resize(places.body.size(), begin + static_cast<int>(size));
    places.widest = std::max(places.widest, size);
  }
  return places;
}

std::string list(const std::vector<int>& numbers) { return fmt::format("{}", fmt::join(numbers, ", ")); }

const double* begin_of(const double (&matrix)[3][3]) { return &matrix[0][0]; }

std::string rounds_text() {
  fmt::dynamic_format_arg_store<fmt::format_context> numbers;
  for (const double* matrix :
       {begin_of(radau_inverse<double>), begin_of(radau_transformation.inverse), begin_of(radau_transformation.T)})
    for (int k = 0; k < 9; ++k) numbers.push_back(matrix[k]);
  return fmt::vformat(rounds, numbers);
}

}  // namespace

std::string radau(const Mechanism& mechanism, const Contents& has) {
  const bool spatial = has.spatial;
  const std::string forces = has.rows ? "    T forces[rows];\n" : "";
  const std::string accelerates = has.modes  ? fmt::format("pull($ss.q, s.time, v, {});", arguments_of_pull(has))
                                  : has.rows ? "accelerate($ss.q, s.time, v, s.J, s.lambda, s.a);"
                                             : "fall($ss.q, s.time, v, s.a);";
  const std::size_t lengths = mechanism.linear(), numbers = spatial ? 7 : 3;
  const char* const turns = spatial ? "turn(at.q);\n" : "turn(at.q, s.q);\n";
  constexpr const auto& c = radau5<double>.c;
  constexpr const RadauTransformation& by = radau_transformation;
  const Places places = places_of(mechanism);
  return fmt::format(newton, mechanism.columns(), spatial ? spatial_turns : planar_turns, list(places.body),
                     list(places.begins), list(places.ends), mechanism.columns() * places.widest) +
         fmt::format(differentiates, arguments_of_slope(has), accelerates, forces, std::string("      ") + turns,
                     mechanism.size, lengths) +
         rounds_text() +
         fmt::format(finds, forces, std::string("        ") + turns, arguments_of_slope(has), c[1], c[2], c[3],
                     mechanism.size, lengths, numbers, by.real, by.alpha, by.beta) +
         fmt::format(collocates, end_on_accelerations(has), head_on_accelerations(has)) +
         (has.strides() ? step_by_events(has) : "");
}

// Two eliminations, of which the complex one takes four times as many operations, and their substitutions.
long operations_of_collocation(std::size_t components) {
  const long m = static_cast<long>(components);
  return 5 * (2 * m * m * m / 3 + 4 * m * m);
}

}  // namespace cdot::compile
