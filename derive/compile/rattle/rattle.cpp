#include "derive/compile/rattle/rattle.hpp"

#include <fmt/format.h>

#include "derive/compile/foresight/foresight.hpp"
#include "derive/compile/methods/bonds.hpp"
#include "derive/compile/methods/weights.hpp"
#include "derive/compile/rattle/start.hpp"

namespace cdot::compile {
namespace {

// As the World does it: runtime/step/rattle.cpp.
constexpr const char* begins = R"(
  // RATTLE: half a kick with forces along J of the start such that C = 0 after the drift, the drift, and half a kick
  // along J of the end such that J v = -dC/dt there.
  static T step(State& s, T h = T(default_step)) {{
{}    const T half = T(0.5) * h;
    Velocity before[bodies], a[bodies];
)";
constexpr const char* starts_with_motors = R"(    Mask started[groups];
    start(s, h, started);
)";

// Effects act by their rates at both ends of the step.
constexpr const char* dampens = R"(    dampen($ss.q, s.time, s.v, h, before);
    for (int i = 0; i < bodies; ++i) s.v[i] = before[i];
)";

// Gaps of ends at the start, and whether a body met one of its mechanism until the drift ended: there friction takes
// its share of the impact at once, and the next step does not repeat it. Without loads it is enough that the drift
// closed half of a gap: there the end already slows the body.
constexpr const char* notes_gaps = R"(    T gap[bounded], side_at_start[bounded];
    nearest($ss.q, s.time, gap, side_at_start);
    for (int i = 0; i < bounded; ++i) gap[i] = side_at_start[i] * gap[i];
)";
constexpr const char* strikes = R"(    Mask struck[groups];
    for (Mask& of_group : struck) of_group = T(1) < T(0);
    T off[bounded], side_at_end[bounded];
    nearest($ss.q, s.time, off, side_at_end);
    for (int i = 0; i < bounded; ++i) {{
      const T met = T((single ? 1e9 : 1e5) * {0});
      const auto meets = gap[i] > met && side_at_end[i] * off[i] <= {1};
      struck[group_of_bound[i]] = struck[group_of_bound[i]] || meets;
    }}
)";
constexpr const char* begins_where_struck =
    "    for (int i = 0; i < groups; ++i) s.begins[i] = select(struck[i], T(1), s.begins[i]);\n";
constexpr const char* begins_where_started =
    "    for (int i = 0; i < groups; ++i) s.begins[i] = select(started[i], T(1), s.begins[i]);\n";
// Ends that are not met yet do not slow their bodies before: a blow in two parts would load friction in both of them.
constexpr const char* waits_for_ends = R"(    for (int i = 0; i < bounded; ++i) {{
      const auto waits = side_at_end[i] * off[i] > T((single ? 1e9 : 1e5) * {}) && magnitude(side_at_end[i]) > T(0);
      B.low[i] = select(waits, T(0), B.low[i]), B.high[i] = select(waits, T(0), B.high[i]);
    }}
)";

constexpr const char* notes_velocities = "    for (int i = 0; i < bodies; ++i) before[i] = s.v[i];\n";

constexpr const char* first_kick = R"(    fall($ss.q, s.time, s.v, a);
    for (int i = 0; i < bodies; ++i) s.v[i] = s.v[i] + half * {};
)";

// The first guess of the joints' forces.
constexpr const char* guesses = R"(    T foreseen[rows], found[rows];
    Velocity pull[bodies];
    foresee(s, T(1), foreseen);
    for (int i = 0; i < rows; ++i) found[i] = foreseen[i];
    apply($qs.J, found, pull);
)";

constexpr const char* closing_begins = R"(    Evaluated at;
    at.time = s.time, s.time = s.time + h;
    for (int i = 0; i < bodies; ++i) at.q[i] = s.q[i];
    const T left = s.residual;
    T least = T(1e30), vain = T(0);
    auto goes_on = T(0) < T(1), astray = T(1) < T(0);
)";

constexpr const char* series_begins = R"(    T last = T(1e30);
    auto by_series = s.known > T(0.5);
    Aim B;
    Mask aimed = T(1) < T(0);
)";

constexpr const char* ends_begin = R"(    Bounded reached;
    bool reaches = false;
    T total[bounded] = {};
)";

constexpr const char* rattle_round_begins = "    for (int round = 0; round < 100; ++round) {\n";

// Rounds after the first one turn little.
constexpr const char* drifts_beside = R"(      Pose close_by[bodies];
      for (int i = 0; i < bodies; ++i) close_by[i] = s.q[i];
      for (int i = 0; i < bodies; ++i) move(s.q[i], at.q[i], h * s.v[i]);
      if (round == 0) turn(s.q);
      else turn(s.q, close_by);
)";

constexpr const char* joint_errors = R"(      T C[rows], impulse[rows];
      errors($ss.q, s.time, C);
)";
// An end that was passed in this half holds from then on, until it would pull.
constexpr const char* end_errors = R"(      T over[bounded], side[bounded];
      nearest($ss.q, s.time, over, side);
      for (int i = 0; i < bounded; ++i) {
        const auto inside = side[i] * over[i] >= T(0) && magnitude(side[i]) > T(0);
        over[i] = select(inside && !(magnitude(total[i]) > T(0)), T(0), over[i]);
      }
)";

constexpr const char* judges = R"(      s.residual = select(goes_on, worst, s.residual);
      if (round == 0) goes_on = goes_on && !(magnitude(worst - left) <= T(single ? -1 : 1e-9) * worst);
      const T fine = T(single ? 1e6 * {0} : 0.01 * {0});
      const auto is_fine = worst <= fine, is_small = worst <= T(single ? 1e7 * {0} : {0});
{1}      const auto shrinks = worst < T(0.7) * least;
      vain = select(shrinks, T(0), vain + T(1)), least = select(shrinks, worst, least);
      goes_on = goes_on && !is_fine && (shrinks || (!is_small && vain <= T(4)));
      astray = astray || (goes_on && vain > T(0));
      if (!any(goes_on)) break;
)";

// A guess that leaves slow rounds: begins again with the forces at the end of the last step.
constexpr const char* leaves_series =
    R"(      const auto strays = goes_on && by_series && !is_small && worst > T(0.2) * last;
      if (any(strays)) {
        for (int i = 0; i < rows; ++i) found[i] = select(strays, s.lambda[i], found[i]);
        for (int i = 0; i < bodies; ++i) s.v[i] = choose(strays, before[i] + half * (a[i] + s.pull[i]), s.v[i]);
        by_series = by_series && !strays, aimed = aimed && !strays;
        least = select(strays, T(1e30), least), last = select(strays, T(1e30), last);
        --round;
        continue;
      }
)";

constexpr const char* joint_changes =
    R"(      for (int i = 0; i < rows; ++i) C[i] = select(goes_on, C[i] {}, T(0));
      Velocity d[bodies];
      solve($qs.J, {}C, impulse, d);
{}      for (int i = 0; i < bodies; ++i) d[i] = -d[i];
)";
// Rows of velocities are free in the first half, as in the World: of all impulses those with none of theirs. F.lambda
// of each such row is 1 in it and 0 in the others.
constexpr const char* frees = R"(
  static constexpr int freed = {0}, freed_rows[freed] = {{{1}}};
  struct Freed {{
    T lambda[freed][rows];
    Velocity d[freed][bodies];
  }};
  static void find_freed(const State& s, Freed& F) {{
    for (int f = 0; f < freed; ++f) {{
      T b[rows];
      for (T& of_row : b) of_row = T(0);
      b[freed_rows[f]] = T(1);
      solve($qs.J, b, F.lambda[f], F.d[f]);
    }}
    for (int f = 0; f < freed; ++f) {{
      const T scale = inverse(F.lambda[f][freed_rows[f]]);
      for (T& of_row : F.lambda[f]) of_row = scale * of_row;
      for (Velocity& of_body : F.d[f]) of_body = scale * of_body;
      for (int g = 0; g < freed; ++g)
        if (g != f) free(F, f, F.lambda[g], F.d[g]);
    }}
  }}
  static void free(const Freed& F, int f, T (&lambda)[rows], Velocity (&d)[bodies]) {{
    const T share = lambda[freed_rows[f]];
    for (int i = 0; i < rows; ++i) lambda[i] = lambda[i] - share * F.lambda[f][i];
    for (int i = 0; i < bodies; ++i) d[i] = d[i] - share * F.d[f][i];
  }}
)";
constexpr const char* frees_changes = R"(      Freed F;
      find_freed(s, F);
      for (int f = 0; f < freed; ++f) free(F, f, impulse, d);
)";
constexpr const char* frees_ends = R"(          for (int f = 0; f < freed; ++f) {
            T along_freed[bounded];
            along($sat.q, at.time, F.d[f], along_freed);
            for (int e = 0; e < bounded; ++e) {
              const T share = reached.l[e][freed_rows[f]];
              for (int i = e; i < bounded; ++i) {
                T& of_both = reached.S[i * (i + 1) / 2 + e];
                of_both = of_both - share * along_freed[i];
              }
              free(F, f, reached.l[e], reached.g[e]);
            }
          }
)";
constexpr const char* shares_impulse = "      share(s.J, impulse);\n";
constexpr const char* shares_ends = "          share(s.J, reached);\n";
constexpr const char* notes_found =
    "      for (int i = 0; i < rows; ++i) found[i] = found[i] - (T(1) / half) * impulse[i];\n";
constexpr const char* no_changes = R"(      Velocity d[bodies];
      for (int i = 0; i < bodies; ++i) d[i] = still();
)";

// Ends that are passed take part in the round.
constexpr const char* end_changes = R"(      Mask passed[bounded];
      auto some = T(1) < T(0);
      for (int i = 0; i < bounded; ++i) passed[i] = goes_on && (magnitude(over[i]) > T(0) || magnitude(total[i]) > T(0)), some = some || passed[i];
      if (any(some)) {{
        if (!reaches) {{
          reach($sat.q, at.time, {0}reached);
{2}        }}
        reaches = true;
        T along_ends[bounded], c[bounded], mu[bounded];
        along($sat.q, at.time, d, along_ends);
        for (int i = 0; i < bounded; ++i) c[i] = -over[i] / h - along_ends[i], mu[i] = T(0);
        push(reached, passed, c, side, total, mu);
        for (int e = 0; e < bounded; ++e) {{
          for (int i = 0; i < bodies; ++i) d[i] = d[i] + mu[e] * reached.g[e][i];
{1}        }}
      }}
)";

// Where that fails, or reverses the velocities, the step starts again, with renewed directions. Other lanes keep what
// they have.
constexpr const char* round_ends =
    R"(      for (int i = 0; i < bodies; ++i) s.v[i] = choose(goes_on, s.v[i] + d[i], s.v[i]);
    }}
    Velocity change[bodies];
    for (int i = 0; i < bodies; ++i) change[i] = s.v[i] - before[i];
    const auto reverses = astray && T(4) * weighed(s.q, change) > weighed(s.q, before);
    const auto fails = reverses || s.residual > T(single ? 1e8 * {0} : 10 * {0});
    if (any(fails)) {{
      Pose next[bodies];
      for (int i = 0; i < bodies; ++i) s.v[i] = choose(fails, before[i] + half * {1}, s.v[i]);
      for (int i = 0; i < bodies; ++i) next[i] = s.q[i];
{2}      for (int i = 0; i < bodies; ++i) s.q[i] = choose(fails, s.q[i], next[i]);
      const T found_residual = s.residual{5};
      s.residual = select(fails, left, s.residual);
      Velocity moves[bodies];
{3}      for (int i = 0; i < bodies; ++i) s.q[i] = choose(fails, s.q[i], next[i]);
      s.residual = select(fails, s.residual, found_residual);
{6}      const auto keep = fails && T(4) * weighed(s.q, moves) <= h * h * weighed(s.q, s.v);
      for (int i = 0; i < bodies; ++i) s.v[i] = choose(keep, s.v[i] + (T(1) / h) * moves[i], s.v[i]);
{4}    }}
)";

// Forces of the second kick are those at the end's velocity, to second order: 2 v_half - v_start.
constexpr const char* notes_start = R"(    Pose start_q[bodies];
    for (int i = 0; i < bodies; ++i) start_q[i] = s.q[i];
)";

constexpr const char* second_kick = R"({1}    for (int i = 0; i < bodies; ++i) before[i] = T(2) * s.v[i] - before[i];
    fall($ss.q, s.time, before, a);
{0}    for (int i = 0; i < bodies; ++i) s.v[i] = s.v[i] + half * a[i];
)";

constexpr const char* joints_end = R"(    T rate[rows];
    rates(s.J, s.v, rate);
    Velocity d[bodies];
    solve($qs.J, rate, s.lambda, d);
    for (int i = 0; i < rows; ++i) s.lambda[i] = (T(-1) / half) * s.lambda[i];
    for (int i = 0; i < bodies; ++i) s.v[i] = s.v[i] - d[i], s.pull[i] = (T(-1) / half) * d[i];
)";
constexpr const char* remembers = R"(    for (int i = 0; i < rows; ++i) found[i] = select(fails, s.lambda[i], found[i]);
    remember(s, !fails, T(1) < T(0), T(1), found, foreseen);
)";

constexpr const char* looks = R"(    T C_now[damped], rate_now[damped], K_now[triangles], given[damped], end[damped];
    notice($ss.q, s.time, before, C_now, rate_now, K_now);
    find_rates($sC_now, rate_now, K_now, s.time, h, given, end);
)";

// Ends that would pull give back what they gave.
constexpr const char* pushes = R"(
  // S mu = c in the rows of `acts`; those that would pull in the whole give back their totals.
  static void push(const Bounded& B, Mask (&acts)[bounded], const T (&c)[bounded], const T (&side)[bounded],
                   T (&total)[bounded], T (&mu)[bounded]) {
    for (bool more = true; more;) {
      divide(B, acts, c, mu);
      more = false;
      for (int i = 0; i < bounded; ++i) {
        const auto pulls = acts[i] && side[i] * (total[i] + mu[i]) < T(0);
        mu[i] = select(pulls, -total[i], mu[i]), acts[i] = acts[i] && !pulls, more = more || any(pulls);
      }
    }
    for (int i = 0; i < bounded; ++i) total[i] = total[i] + mu[i];
  }
)";

// Newton on the velocities of the drift, with J of its start.
std::string closing(double tolerance, const Contents& has) {
  std::string text = closing_begins;
  if (has.foresees) text += series_begins;
  if (has.ends) text += ends_begin;
  text += rattle_round_begins + (has.spatial ? drifts(has, "at") : drifts_beside);
  if (has.rows) text += joint_errors;
  if (has.ends) text += end_errors;
  text += has.rows ? "      T worst = largest(C);\n" : "      T worst = largest(over);\n";
  if (has.rows && has.ends) text += "      worst = select(largest(over) > worst, largest(over), worst);\n";
  text += fmt::format(judges, tolerance, has.foresees ? leaves_series : "");
  if (has.foresees) text += drift_aims();
  text += has.rows ? fmt::format(joint_changes, has.foresees ? "* (T(1) / h)" : "/ h", has.foresees ? "B, aimed, " : "",
                                 has.frees ? frees_changes : "")
                   : no_changes;
  if (has.ends)
    text += fmt::format(end_changes, has.rows ? "s.J, " : "", weighs_end_changes(has),
                        std::string(has.frees ? frees_ends : "") + (has.shares ? shares_ends : ""));
  if (has.shares) text += shares_impulse;
  if (has.foresees || has.weighs_joints()) text += notes_found;
  return text + fmt::format(round_ends, tolerance, has.pulls() ? "(a[i] + s.pull[i])" : "a[i]", drifts(has, "at"),
                            has.foresees
                                ? closes_unforeseen
                                : declares_gained(has) + "      close(s, at, T(0.2), moves" + gained(has) + ");\n",
                            weighs_failures(has), has.foresees ? ", found_share = s.share" : "",
                            has.foresees ? "      s.share = select(fails, s.share, found_share);\n" : "");
}

// The end's impulses of joints, effects and rows with bounds together.
std::string finishing(double tolerance, const Contents& has) {
  std::string text = "    Velocity next[bodies];\n";
  if (!has.pulls()) text += "    Velocity pull[bodies];\n";
  if (has.bounded) text += "    Bounded B;\n    T mu[bounded];\n";
  text += fmt::format("    finish($ss.q, s.time, s.v, {}h, {}next, {}{}{});\n", has.rows ? "s.J, " : "",
                      has.looks ? "given, end, " : "", has.rows ? "s.lambda, " : "", has.pulls() ? "s.pull" : "pull",
                      has.bounded ? ", B" : "");
  if (has.bounded) {
    if (has.strikes() && has.loads) text += fmt::format(waits_for_ends, tolerance);
    text += bounds_of_clutches(has);
    text += has.loads ? settles_end_with_loads(has) : "    settle(B, s.hold, mu);\n";
    text += sticking_rows(has) + weighs_bounds(has);
    text += fmt::format(sums_pulls, "next[i] = next[i] + mu[e] * B.g[e][i], ",
                        has.rows ? fmt::format(sums_lambda, "s.") : "", "s.",
                        has.repeats() ? "repeated[e]" : repeats_of_start(has));
  }
  if (has.rows) text += "    for (T& of_row : s.lambda) of_row = of_row / half;\n";
  text += "    for (int i = 0; i < bodies; ++i) s.v[i] = next[i]";
  return text + (has.pulls() ? ", s.pull[i] = (T(1) / half) * s.pull[i];\n" : ";\n");
}

}  // namespace

std::string pushes_of(const Contents& has) { return has.ends ? pushes : ""; }

std::string frees_of(const std::vector<int>& rows) {
  return rows.empty() ? "" : fmt::format(frees, rows.size(), fmt::join(rows, ", "));
}

std::string rattle(double tolerance, const Contents& has) {
  std::string text = fmt::format(begins, has.starts_motors() ? starts_with_motors
                                         : has.exerts        ? "    start(s, h);\n"
                                                             : "");
  text += bears_at_start(has);
  if (has.strikes()) text += notes_gaps;
  text += has.dampens ? dampens : notes_velocities;
  if (has.carries) text += notes_start;
  if (has.foresees) text += guesses;
  text += weighs_first_half(has);
  text += fmt::format(first_kick, has.foresees ? "(a[i] + pull[i])" : has.pulls() ? "(a[i] + s.pull[i])" : "a[i]");
  text += has.closes() ? closing(tolerance, has) : drifts(has, "s") + "    s.time = s.time + h;\n";
  if (has.strikes()) text += fmt::format(strikes, tolerance, has.loads ? "met" : "T(0.5) * gap[i]");
  if (has.gyroscopes) text += follows;
  text += "$C";
  if (has.rows) text += evaluates;
  text += fmt::format(second_kick, has.looks ? looks : "", has.carries ? "    carry(start_q, s.q, before);\n" : "");
  text += has.finishes ? finishing(tolerance, has) : has.rows ? joints_end : "";
  if (has.foresees) text += remembers;
  text += bears_at_end(has, "end");
  text += shares(has, "s.lambda");
  text += rattle_weighs(has);
  if (has.strikes()) text += begins_where_struck;
  if (has.starts_motors()) text += begins_where_started;
  if (has.events) text += "    latch(s);\n";
  return text + fmt::format("    return {};\n  }}\n", has.closes() ? "s.residual" : "T(0)");
}

}  // namespace cdot::compile
