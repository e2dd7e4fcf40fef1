#include "derive/compile/methods/rattle.hpp"

#include <fmt/format.h>

namespace cdot::compile {
namespace {

// As the World does it: runtime/step/rattle.cpp.
constexpr const char* rattle_begins = R"(
  // RATTLE: half a kick with forces along J of the start such that C = 0 after the drift, the drift, and half a kick
  // along J of the end such that J v = -dC/dt there.
  static T step(State& s, T h = T(default_step)) {
    const T half = T(0.5) * h;
    Velocity before[bodies], a[bodies];
    for (int i = 0; i < bodies; ++i) before[i] = s.v[i];
    fall($ss.q, s.time, s.v, a);
)";

constexpr const char* rattle_closes =
    R"(    for (int i = 0; i < bodies; ++i) s.v[i] = s.v[i] + half * (a[i] + s.pull[i]);
    Evaluated at;
    at.time = s.time, s.time = s.time + h;
    for (int i = 0; i < bodies; ++i) at.q[i] = s.q[i];
    const T left = s.residual;
    T least = T(1e30), vain = T(0);
    auto goes_on = T(0) < T(1);
    for (int round = 0; round < 100; ++round) {{
      for (int i = 0; i < bodies; ++i) s.q[i] = at.q[i];
  {0}      T C[rows], unused[rows];
      errors($ss.q, s.time, C);
      const T worst = largest(C);
      s.residual = select(goes_on, worst, s.residual);
      if (round == 0) goes_on = goes_on && !(magnitude(worst - left) <= T(single ? -1 : 1e-9) * worst);
      const auto shrinks = worst < T(0.7) * least;
      vain = select(shrinks, T(0), vain + T(1)), least = select(shrinks, worst, least);
      const auto is_fine = worst <= T(single ? 1e6 * {1} : 0.01 * {1});
      const auto is_small = worst <= T(single ? 1e7 * {1} : {1});
      goes_on = goes_on && !is_fine && (shrinks || (!is_small && vain <= T(4)));
      if (!any(goes_on)) break;
      for (T& of_row : C) of_row = select(goes_on, -of_row / h, T(0));
      Velocity d[bodies];
      solve($qs.J, C, unused, d);
      for (int i = 0; i < bodies; ++i) s.v[i] = choose(goes_on, s.v[i] + d[i], s.v[i]);
    }}
    if (any(s.residual > T(single ? 1e8 * {1} : 10 * {1}))) {{  // with renewed directions
      Velocity moves[bodies];
      close(s, at, T(0.2), moves);
      const auto keep = T(4) * weighed(s.q, moves) <= h * h * weighed(s.q, s.v);
      for (int i = 0; i < bodies; ++i) s.v[i] = s.v[i] + select(keep, T(1) / h, T(0)) * moves[i];
    }}
)";

constexpr const char* rattle_drifts = R"(    for (int i = 0; i < bodies; ++i) s.v[i] = s.v[i] + half * a[i];
{0}    s.time = s.time + h;
)";

// Forces of the second kick are those at the end's velocity, to second order: 2 v_half - v_start.
constexpr const char* rattle_kicks = R"(    for (int i = 0; i < bodies; ++i) before[i] = T(2) * s.v[i] - before[i];
    fall($ss.q, s.time, before, a);
    for (int i = 0; i < bodies; ++i) s.v[i] = s.v[i] + half * a[i];
)";

constexpr const char* rattle_ends = R"(    T b[rows];
    rates(s.J, s.v, b);
    for (T& of_row : b) of_row = -of_row;
    Velocity d[bodies];
    solve($qs.J, b, s.lambda, d);
    for (T& of_row : s.lambda) of_row = of_row / half;
    for (int i = 0; i < bodies; ++i) s.v[i] = s.v[i] + d[i], s.pull[i] = (T(1) / half) * d[i];
)";

}  // namespace

std::string rattle(double tolerance, const Contents& has) {
  std::string text = rattle_begins;
  text += has.rows ? fmt::format(rattle_closes, drifts(has), tolerance) : fmt::format(rattle_drifts, drifts(has));
  if (has.gyroscopes) text += follows;
  if (has.rows) text += evaluates;
  text += rattle_kicks;
  if (has.rows) text += rattle_ends;
  return text + fmt::format("    return {};\n  }}\n", has.rows ? "s.residual" : "T(0)");
}

}  // namespace cdot::compile
