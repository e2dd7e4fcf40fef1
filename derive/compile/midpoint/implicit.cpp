#include "derive/compile/midpoint/implicit.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace cdot::compile {
namespace {

// As the World does it: runtime/step/midpoint.cpp and runtime/step/find_middle.cpp.
constexpr const char* part_begins = R"(
  // A part of a step by the implicit midpoint rule: the mean velocity v follows from forces and J of the middle q + h v / 2,
  // such that C = 0 after the drift by v. The end has 2 v less that of the start, projected onto J v = -dC/dt. False in
  // lanes where the part is too long: Newton fails, or the joints do work. A last part may lose energy.
  static Mask go(State& s, const T& h, const Mask& last) {
    const T half = T(0.5) * h, end = s.time + h;
    Evaluated at;
    at.time = s.time;
    for (int i = 0; i < bodies; ++i) at.q[i] = s.q[i];
    Velocity before[bodies];
)";

constexpr const char* part_dampens = R"(    dampen($ss.q, s.time, s.v, h, before);
    for (int i = 0; i < bodies; ++i) s.v[i] = before[i];
)";

constexpr const char* weighs = R"(    T K[effect_rows];
    weigh_effects($ss.q, s.time, K);
)";

constexpr const char* notes_part = "    for (int i = 0; i < bodies; ++i) before[i] = s.v[i];\n";

constexpr const char* part_guesses = R"(    Inertia W[bodies];
    T lambda[rows], C[rows], y[rows];
    for (int i = 0; i < rows; ++i) lambda[i] = h * s.lambda[i];
)";

// Goals of Newton: the change of a pose beside the size of the mechanism, and C beside its tolerance. Round-off may
// stop it before. A larger change than twice the size means that the part is too long.
constexpr const char* rounds_begin = R"(    s.time = s.time + half;
    T missed = T(1e30), work = T(0), residual = T(0);
    auto goes_on = T(0) < T(1), found = T(1) < T(0);
    Pose middle[bodies];
    Velocity d[bodies];
    for (int i = 0; i < bodies; ++i) middle[i] = s.q[i];
    for (int round = 0; round < 25 && any(goes_on); ++round) {
)";

constexpr const char* keeps_middle = "      for (int i = 0; i < bodies; ++i) middle[i] = s.q[i];\n";

constexpr const char* measures = R"(      errors($ss.q, end, C);
      const T worst = largest(C);
)";

constexpr const char* rounds_end =
    R"(      const T way = farthest(d, h), miss = larger(T(single ? 1e6 : 1e12) * way, T({1}) * worst);
      residual = select(goes_on, worst, residual), work = select(goes_on, power, work);
      for (int i = 0; i < bodies; ++i) s.v[i] = choose(goes_on, s.v[i] + d[i], s.v[i]);
{0}      const auto ends = miss <= T(1) || (miss <= T(single ? 1e4 : {2}) && miss > T(0.5) * missed);
      const auto fails = !(way < T(2));
      found = found || (goes_on && ends && !fails);
      goes_on = goes_on && !ends && !fails;
      missed = miss;
    }}
)";

constexpr const char* adds_lambda =
    "      for (int i = 0; i < rows; ++i) lambda[i] = lambda[i] + select(goes_on, T(2) * y[i], T(0));\n";

constexpr const char* judges_middle = R"(    const T slight = T(single ? 0.5e-2 : 0.5e-4);  // beside twice the energy
    const auto does_work = select(last, work, magnitude(work)) > slight * moved_energy(s.q, s.v, before);
    found = found && (!does_work || hardly_moves(s.v, h));
)";

constexpr const char* doubles = R"(    s.time = end;
    for (int i = 0; i < bodies; ++i) s.v[i] = T(2) * s.v[i] - before[i];
)";

constexpr const char* looks_part =
    R"(    T C_now[damped], rate_now[damped], K_now[triangles], given[damped], at_end[damped];
    notice($ss.q, s.time, s.v, C_now, rate_now, K_now);
    find_rates($sC_now, rate_now, K_now, s.time, h, given, at_end);
)";

constexpr const char* finishes = R"(    finish($ss.q, s.time, s.v, {0}h, {1}d{2});
    for (int i = 0; i < bodies; ++i) s.v[i] = d[i];
)";

constexpr const char* projects = R"(    solve($qs.J, rate, y, d);
    for (int i = 0; i < bodies; ++i) s.v[i] = s.v[i] - d[i];
    for (int i = 0; i < rows; ++i) y[i] = -y[i];
)";

constexpr const char* judges_end = R"(    T loss = T(0);
    for (int i = 0; i < rows; ++i) loss = loss - T(0.5) * y[i] * rate[i];
    found = found && (last || !(loss > slight * energy) || stands);
    for (int i = 0; i < rows; ++i) s.lambda[i] = (lambda[i] + y[i]) / h;
)";

// With improve() of a step of 2 h: (M + h G) d = h f + J^T lambda with J (v + d) = -dC/dt.
constexpr const char* rescue_begins = R"(
  // A part by linearly implicit Euler, which takes every step.
  static void rescue(State& s, const T& h) {
    const T twice = T(2) * h;
    Velocity d[bodies], before[bodies];
    T power;
    for (int i = 0; i < bodies; ++i) before[i] = s.v[i];
)";
constexpr const char* rescues_rows = R"(    Evaluated at;
    at.time = s.time;
    for (int i = 0; i < bodies; ++i) at.q[i] = s.q[i];
    Inertia W[bodies];
    T lambda[rows], C[rows], y[rows];
    for (int i = 0; i < rows; ++i) lambda[i] = twice * s.lambda[i];
    stiffen($ss.q, s.time, {}twice, lambda, W);
    rates(s.J, s.v, C);
    for (int i = 0; i < rows; ++i) lambda[i] = T(0), C[i] = twice * C[i];
)";
constexpr const char* rescue_moves = "    for (int i = 0; i < bodies; ++i) s.v[i] = s.v[i] + d[i];\n";
constexpr const char* rescue_closes = R"(    Velocity moves[bodies];
    close(s, at, T(0.2), moves);
    for (int i = 0; i < bodies; ++i) s.v[i] = s.v[i] + (T(1) / h) * moves[i];
    for (int i = 0; i < rows; ++i) s.lambda[i] = y[i] / h;
)";

constexpr const char* parts = R"(
  // The implicit midpoint rule; a step that is too long is taken in parts, in each lane for itself.
  static T step(State& s, T h = T(default_step)) {{
    for (T parts = T(1), done = T(0);;) {{
      const auto busy = done < parts, last = T(2) * parts > T(single ? 8 : 64);
      if (!any(busy)) return {0};
      const T part = h / parts;
      State next = s;
      const auto found = go(next, part, last) && busy, halves = busy && !found && !last, fails = busy && !found && last;
      replace(s, next, found);
      if (any(fails)) {{
        next = s;
        rescue(next, part);
        replace(s, next, fails);
      }}
      done = select(found || fails, done + T(1), select(halves, T(2) * done, done));
      parts = select(halves, T(2) * parts, parts);
    }}
  }}
)";

// The velocities at the end: J v = -dC/dt, with what effects do there.
std::string ending(const Contents& has) {
  std::string text;
  if (has.gyroscopes) text += follows;
  text += "$C";
  if (has.rows) text += evaluates;
  if (has.drags) text += "    drag(s.v, half);\n";
  if (has.looks) text += looks_part;
  if (has.rows)
    text +=
        "    T rate[rows];\n    rates(s.J, s.v, rate);\n"
        "    const T energy = moved_energy(s.q, s.v, before);\n    const auto stands = hardly_moves(s.v, h);\n";
  if (has.finishes)
    text += fmt::format(finishes, has.rows ? "s.J, " : "", has.looks ? "given, at_end, " : "", has.rows ? ", y" : "");
  else if (has.rows) text += projects;
  return has.rows ? text + judges_end : text + "    (void)last, (void)work, (void)residual;\n";
}

std::string gyroscopes(const Contents& has) { return has.gyroscopes ? "s.g, " : ""; }

// q: poses of the middle; h: of the step.
std::string improves(const Contents& has, const std::string& q, const std::string& h) {
  return fmt::format("    improve($s{}, s.time, s.v, before, {}{}, {}{}d, {}power);\n", q,
                     (has.rows ? "W, " : "") + gyroscopes(has), h, has.rows ? "lambda, C, " : "",
                     has.effects ? "K, " : "", has.rows ? "y, " : "");
}

std::string round(const Mechanism& mechanism, const Contents& has) {
  std::string text = rounds_begin + drifts(has, "at", "half") + keeps_middle + drifts(has, "at", "h");
  text += has.rows ? measures : "      const T worst = T(0);\n";
  if (has.rows) text += "      stiffen($smiddle, s.time, " + gyroscopes(has) + "h, lambda, W);\n";
  text += "      T power;\n" + improves(has, "middle", "h");
  const auto bodies = static_cast<double>(std::ranges::count_if(mechanism.bodies, &Body::moves));
  const double goal = 0.01 * mechanism.tolerance, few = std::clamp(bodies * bodies, 1e2, 1e4);
  return text +
         fmt::format(rounds_end, has.rows ? adds_lambda : "", fmt::format("single ? {} : {}", 1e-8 / goal, 1 / goal),
                     few) +
         drifts(has, "at", "h");
}

std::string rescue(const Contents& has) {
  std::string text = rescue_begins;
  if (has.rows) text += fmt::format(rescues_rows, gyroscopes(has));
  if (has.effects) text += weighs;
  text += improves(has, "s.q", "twice") + rescue_moves + drifts(has, "s", "h") + "    s.time = s.time + h;\n";
  if (has.gyroscopes) text += follows;
  if (has.rows) text += rescue_closes;
  if (has.rows && has.gyroscopes) text += follows;
  text += "$C";
  if (has.rows) text += std::string(evaluates) + "    project(s);\n";
  return text + "    (void)power;\n  }\n";
}

}  // namespace

std::string implicit(const Mechanism& mechanism, const Contents& has) {
  std::string text = part_begins;
  if (has.dampens) text += part_dampens;
  if (has.effects) text += weighs;
  if (has.drags) text += "    drag(s.v, half);\n";
  text += notes_part;
  if (has.rows) text += part_guesses;
  text += round(mechanism, has);
  if (has.rows) text += std::string(judges_middle) + "    s.residual = residual;\n";
  text += doubles + ending(has) + "    return found;\n  }\n";
  return text + rescue(has) + fmt::format(parts, has.closes() ? "s.residual" : "T(0)");
}

}  // namespace cdot::compile
