#include "derive/compile/midpoint/implicit.hpp"

#include <algorithm>
#include <fmt/format.h>

#include "derive/compile/methods/bonds.hpp"
#include "derive/compile/methods/cones.hpp"
#include "derive/compile/methods/loads.hpp"

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

constexpr const char* part_guesses = R"(    T lambda[rows], C[rows], y[rows];
    for (int i = 0; i < rows; ++i) lambda[i] = h * s.lambda[i];
)";

// low and high: bounds of mu in the middle. Impulses of an end and of a motor that drives against it would add up.
constexpr const char* guesses_bounded = R"({}    Bounded B;
    T mu[bounded], x[bounded], low[bounded], high[bounded];
    for (int i = 0; i < bounded; ++i) mu[i] = {}h * s.force[i], low[i] = mu[i], high[i] = mu[i];
)";

std::string guesses_of(const std::vector<Effect>& bounded) {
  std::string anew;
  for (const Effect& of : bounded) anew += fmt::format("{}{}", anew.empty() ? "" : ", ", of.beside_motor);
  if (!std::ranges::any_of(bounded, &Effect::beside_motor)) return fmt::format(guesses_bounded, "", "");
  return fmt::format(guesses_bounded, "    constexpr bool anew[bounded] = {" + anew + "};\n", "anew[i] ? T(0) : ");
}

constexpr const char* declares_ends = "    T off[bounded], side[bounded], missed_ends[bounded];\n";

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
      const T of_joints = largest(C);
)";

// Ends that are passed are errors. Such rows miss their end by a rate.
constexpr const char* measures_ends = R"(      nearest($ss.q, end, off, side);
      for (int i = 0; i < bounded; ++i) {{
        const auto inside = side[i] * off[i] >= T(0) && magnitude(side[i]) > T(0);
        missed_ends[i] = off[i] / h, off[i] = select(inside, T(0), off[i]);
      }}
      const T worst = {};
)";

// The impulses of rows with bounds take half of the change x. Their bounds without loads stay for the end.
constexpr const char* keeps_plain = R"(      T plain_low[bounded], plain_high[bounded];
      for (int i = 0; i < bounded; ++i) plain_low[i] = B.low[i], plain_high[i] = B.high[i];
)";
constexpr const char* settles_round = R"(      T hold[bounded];
      for (int i = 0; i < bounded; ++i) hold[i] = s.hold[i];
{2}{1}      for (int i = 0; i < bounded; ++i) {{
        s.hold[i] = select(goes_on, hold[i], s.hold[i]);
        low[i] = select(goes_on, mu[i] + T(2) * {3}low[i], low[i]), high[i] = select(goes_on, mu[i] + T(2) * {3}high[i], high[i]);
        mu[i] = mu[i] + select(goes_on, T(2) * x[i], T(0));
      }}
{0})";

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

constexpr const char* finishes = R"(    finish($ss.q, s.time, s.v, {0}h, {1}d{2}{3});
{4}    for (int i = 0; i < bodies; ++i) s.v[i] = d[i];
)";

constexpr const char* projects = R"(    solve($qs.J, rate, y, d);
    for (int i = 0; i < bodies; ++i) s.v[i] = s.v[i] - d[i];
    for (int i = 0; i < rows; ++i) y[i] = -y[i];
)";

// A motor keeps to the bounds of the middle; the whole impulse of an end never pulls.
constexpr const char* settles_end = R"(    for (int i = 0; i < bounded; ++i) {{
      const bool as_middle = is_rate[i]{2};
      B.low[i] = (as_middle ? low[i] : B.low[i]) - mu[i], B.high[i] = (as_middle ? high[i] : B.high[i]) - mu[i];
    }}
{1}    for (int i = 0; i < bounded; ++i) mu[i] = mu[i] + x[i], s.force[i] = mu[i] / h;
{0})";

// An end that was hit takes energy by itself.
constexpr const char* judges_end = R"(    T loss = T(0);
    for (int i = 0; i < rows; ++i) loss = loss - T(0.5) * y[i] * rate[i];
)";
constexpr const char* forgives_hits = R"(    for (int i = 0; i < bounded; ++i)
      if (!is_rate[i]) loss = select(magnitude(mu[i]) > T(0), T(0), loss);
)";
constexpr const char* stores_end = R"(    found = found && (last || !(loss > slight * energy) || hardly_moves(s.v, h));
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
constexpr const char* rescue_notes_start = R"(    Evaluated at;
    at.time = s.time;
    for (int i = 0; i < bodies; ++i) at.q[i] = s.q[i];
)";
constexpr const char* rescues_rows = R"(    T lambda[rows], C[rows], y[rows];
    for (int i = 0; i < rows; ++i) lambda[i] = twice * s.lambda[i];
)";
constexpr const char* rescues_bounded = R"(    Bounded B;
    T mu[bounded], x[bounded];
    for (int i = 0; i < bounded; ++i) mu[i] = twice * s.force[i];
)";
constexpr const char* forgets_rows = R"(    rates(s.J, s.v, C);
    for (int i = 0; i < rows; ++i) lambda[i] = T(0), C[i] = twice * C[i];
)";
constexpr const char* forgets_bounded = "    for (T& of_row : mu) of_row = T(0);\n";
// C may shrink to an end within the step, but not further.
constexpr const char* aims_at_ends = R"(    T off[bounded], side[bounded], missed_ends[bounded];
    nearest($ss.q, s.time, off, side);
    along($ss.q, s.time, s.v, missed_ends);
{}    for (int i = 0; i < bounded; ++i)
      missed_ends[i] = missed_ends[i]{} + select(side[i] * off[i] > T(0), off[i] / h, T(0));
)";
constexpr const char* declares_drift = R"(    T of_ends[bounded];
    drift_of_ends($ss.q, s.time, of_ends);
)";
constexpr const char* adds_drift = " + of_ends[i]";
constexpr const char* rescue_settles = R"({1}    for (int i = 0; i < bounded; ++i) s.force[i] = x[i] / h;
{0})";
constexpr const char* rescue_moves = "    for (int i = 0; i < bodies; ++i) s.v[i] = s.v[i] + d[i];\n";
constexpr const char* rescue_closes = R"(    Velocity moves[bodies];
    close(s, at, T(0.2), moves);
    for (int i = 0; i < bodies; ++i) s.v[i] = s.v[i] + (T(1) / h) * moves[i];
)";
constexpr const char* rescue_notes = "    for (int i = 0; i < rows; ++i) s.lambda[i] = y[i] / h;\n";

constexpr const char* parts = R"(
  // The implicit midpoint rule; a step that is too long is taken in parts, in each lane for itself.
  static T step(State& s, T h = T(default_step)) {{
    for (T parts = T(1), done = T(0);;) {{
      const auto busy = done < parts, last = T(2) * parts > T(single ? 8 : 64);
      if (!any(busy)) {{
{1}        return {0};
      }}
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

// Bounds of x grow with what carries a load: with x, and this share of the impulses so far. Half of the change of an
// impulse has half of its bounds, so half of its load.
constexpr const char* settles_loaded = R"(    {{
      T before[bounded], load[bounded];
      for (int i = 0; i < bounded; ++i) before[i] = {2}mu[i], load[i] = magnitude(before[i]);
{3}{5}      settle_loads($s{0}, s.time, {4}before, {6}B, x, load, [&](T (&now)[bounded]) {{ settle(B, {1}, now); }});
    }}
)";
constexpr const char* draws_joints = R"(      T drawn[rows];
      for (int i = 0; i < rows; ++i) drawn[i] = {}lambda[i];
      evaluate($s{}, s.time, s.J);
)";

constexpr std::string_view in_middle_by = "T(0.5) * ", alone = "T(0) * ", at_end_by = "";
// The size of a force in a cone is that of its whole impulse.
constexpr const char* turns = R"(      T turned[bounded];
      for (int i = 0; i < bounded; ++i) turned[i] = {}mu[i];
)";

std::string settles_x(const Contents& has, const char* q, const char* hold, std::string_view share) {
  if (!has.loads) return fmt::format("    settle(B, {}, x);\n", hold);
  const bool in_middle = share == in_middle_by;
  return fmt::format(settles_loaded, q, hold, share, has.rows ? fmt::format(draws_joints, share, q) : "",
                     has.rows ? "s.J, y, drawn, " : "",
                     has.cones ? all_turn + fmt::format(turns, in_middle ? share : "") : "", corners(has));
}

// The changes by impulses x of rows with bounds.
std::string adds_bounded(const Contents& has, const char* indent) {
  std::string text = fmt::format("{}for (int e = 0; e < bounded; ++e) {{\n", indent);
  text += fmt::format("{}  for (int i = 0; i < bodies; ++i) d[i] = d[i] + x[e] * B.g[e][i];\n", indent);
  if (has.rows) text += fmt::format("{}  for (int i = 0; i < rows; ++i) y[i] = y[i] + x[e] * B.l[e][i];\n", indent);
  return text + indent + "}\n";
}

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
        "    const T energy = moved_energy(s.q, s.v, before);\n";
  if (has.finishes)
    text += fmt::format(
        finishes, has.rows ? "s.J, " : "", has.looks ? "given, at_end, " : "", has.rows ? ", y" : "",
        has.bounded ? ", B" : "",
        has.bounded ? fmt::format(settles_end, adds_bounded(has, "    "), settles_x(has, "s.q", "s.hold", at_end_by),
                                  has.cones ? " && cone_of[i] < 0" : "")
                    : "");
  else if (has.rows) text += projects;
  text += shares(has, "y") + bears_at_end(has, "at_end");
  if (!has.rows) return text + "    (void)last, (void)work, (void)residual;\n";
  return text + judges_end + (has.ends ? forgives_hits : "") + stores_end;
}

std::string snaps(const Contents& has) {
  return fmt::format("        snap(s{}{}{});\n", has.rows ? ", s.lambda" : "", has.bounded ? ", s.force" : "",
                     has.bears ? ", s.bonds.borne" : "");
}

std::string gyroscopes(const Contents& has) { return has.gyroscopes ? "s.g, " : ""; }

std::string stiffens(const Contents& has, const std::string& q, const std::string& h) {
  if (!has.stiffens()) return "";
  return fmt::format("    stiffen($s{}, s.time, {}{}, {}{}W{});\n", q, gyroscopes(has), h, has.rows ? "lambda, " : "",
                     has.bounded ? "mu, " : "", has.taut ? ", N" : "");
}

std::string bounded_arguments(const Contents& has) {
  return std::string(has.bounded ? "mu, " : "") + (has.ends ? "missed_ends, side, " : "");
}

// q: poses of the middle; h: of the step.
std::string improves(const Contents& has, const std::string& q, const std::string& h) {
  return fmt::format("    improve($s{}, s.time, s.v, before, {}{}{}, {}{}{}d, {}power{});\n", q,
                     has.taut         ? "W, N, "
                     : has.stiffens() ? "W, "
                                      : "",
                     has.gyroscopes ? "s.g, mean, " : "", h, has.rows ? "lambda, C, " : "", has.effects ? "K, " : "",
                     bounded_arguments(has), has.rows ? "y, " : "", has.bounded ? ", B" : "");
}

// The errors of a round at its end.
std::string measured(const Contents& has) {
  std::string text = has.rows ? measures : "";
  if (has.ends) text += fmt::format(measures_ends, has.rows ? "larger(largest(off), of_joints)" : "largest(off)");
  else text += fmt::format("      const T worst = {};\n", has.rows ? "of_joints" : "T(0)");
  return text;
}

std::string round(const Mechanism& mechanism, const Contents& has) {
  std::string text = rounds_begin + drifts(has, "at", "half") + keeps_middle + drifts(has, "at", "h");
  text += measured(has) + stiffens(has, "middle", "h");
  if (has.gyroscopes) text += "      find_mean_spins(at.q, s.v, h, mean);\n";
  text += "      T power;\n" + improves(has, "middle", "h");
  if (has.bounded)
    text += fmt::format(settles_round, adds_bounded(has, "      "), settles_x(has, "middle", "hold", in_middle_by),
                        has.loads ? keeps_plain : "", has.loads ? "plain_" : "B.");
  text += loads_in_round(has);
  const auto bodies = static_cast<double>(std::ranges::count_if(mechanism.bodies, &Body::moves));
  const double goal = 0.01 * mechanism.tolerance, few = std::clamp(bodies * bodies, 1e2, 1e4);
  return text +
         fmt::format(rounds_end, has.rows ? adds_lambda : "", fmt::format("single ? {} : {}", 1e-8 / goal, 1 / goal),
                     few) +
         drifts(has, "at", "h");
}

std::string declares(const Contents& has) {
  return std::string(has.stiffens() ? "    Inertia W[bodies];\n" : "") + (has.taut ? "    Taut N;\n" : "") +
         (has.gyroscopes ? "    Velocity mean[bodies];\n" : "");
}

std::string rescue(const Contents& has) {
  std::string text = rescue_begins;
  text += declares(has);
  if (has.closes()) text += rescue_notes_start;
  if (has.rows) text += rescues_rows;
  if (has.bounded) text += rescues_bounded;
  text += stiffens(has, "s.q", "twice");
  if (has.rows) text += forgets_rows;
  if (has.bounded) text += forgets_bounded;
  if (has.ends)
    text += fmt::format(aims_at_ends, has.ends_drift ? declares_drift : "", has.ends_drift ? adds_drift : "");
  if (has.effects) text += weighs;
  if (has.gyroscopes) text += "    for (int i = 0; i < bodies; ++i) mean[i] = s.v[i];\n";
  text += improves(has, "s.q", "twice");
  if (has.bounded)
    text += fmt::format(rescue_settles, adds_bounded(has, "    "), settles_x(has, "s.q", "s.hold", alone));
  text += shares(has, "y");
  if (has.bears) text += "    bear($ss.q, s.time, s.v, d, twice, K, s.bonds.borne);\n";
  text += rescue_moves + drifts(has, "s", "h") + "    s.time = s.time + h;\n";
  if (has.gyroscopes) text += follows;
  if (has.closes()) text += rescue_closes;
  if (has.rows) text += rescue_notes;
  if (has.closes() && has.gyroscopes) text += follows;
  text += "$C";
  if (has.rows) text += std::string(evaluates) + "    project(s);\n";
  return text + "    (void)power;\n  }\n";
}

}  // namespace

std::string arguments_of_improve(const Contents& has) {
  std::string text = ", const Velocity (&before)[bodies], ";
  if (has.stiffens()) text += "const Inertia (&W)[bodies], ";
  if (has.taut) text += "const Taut& N, ";
  if (has.gyroscopes) text += "const Gyroscope* g, const Velocity (&mean)[bodies], ";
  text += "const T& h, ";
  if (has.rows) text += "const T (&lambda)[rows], const T (&C)[rows], ";
  if (has.effects) text += "const T (&K)[effect_rows], ";
  if (has.bounded) text += "const T (&mu)[bounded], ";
  if (has.ends) text += "const T (&missed)[bounded], const T (&side)[bounded], ";
  return text + "Velocity (&d)[bodies], " + (has.rows ? "T (&y)[rows], " : "") + "T& power" +
         (has.bounded ? ", Bounded& B)" : ")");
}

std::string implicit(const Mechanism& mechanism, const Contents& has) {
  std::string text = part_begins + bears_at_start(has);
  if (has.dampens) text += part_dampens;
  if (has.effects) text += weighs;
  if (has.drags) text += "    drag(s.v, half);\n";
  text += notes_part;
  text += declares(has);
  text += declares_borne(has);
  if (has.rows) text += part_guesses;
  if (has.bounded) text += guesses_of(mechanism.bounded);
  if (has.ends) text += declares_ends;
  text += round(mechanism, has);
  if (has.rows) text += judges_middle;
  if (has.closes()) text += "    s.residual = residual;\n";
  text += doubles + ending(has) + "    return found;\n  }\n";
  return text + rescue(has) +
         fmt::format(parts, has.closes() ? "s.residual" : "T(0)",
                     (has.bonds ? snaps(has) : "") + (has.events ? "        latch(s);\n" : ""));
}

}  // namespace cdot::compile
