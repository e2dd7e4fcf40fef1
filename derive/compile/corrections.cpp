#include "derive/compile/corrections.hpp"

#include <fmt/format.h>

#include "derive/compile/foresight/foresight.hpp"
#include "derive/compile/methods/weights.hpp"
#include "derive/compile/texts.hpp"

namespace cdot::compile {
namespace {

std::string when(bool condition, const char* text) { return condition ? text : ""; }

// As in the World: runtime/solve/direct.cpp.
constexpr const char* close_begins = R"(
  // Newton on C, with J as it is evaluated: anew where a round leaves more than the share `slow` of the error. Adds up
  // the moves{0}. Returns the error before. A lane that is done waits for the others unchanged.
  static T close(State& s, Evaluated& at, const T& slow, {1}Velocity (&moves)[bodies]{2}) {{
    const T left = s.residual;
    T before = T(1e30), error = T(0);
    auto goes_on = T(0) < T(1), renewed = T(1) < T(0);
    bool is_back = false;
    Pose free[bodies];
    for (int i = 0; i < bodies; ++i) free[i] = s.q[i];
)";

constexpr const char* errors_of_rows = R"(      T C[rows];
      errors($ss.q, s.time, C);
      const T of_joints = largest(C);
)";

// Ends that are passed take part from then on. A step brings rows to their ends to round-off only.
constexpr const char* errors_of_ends = R"(      T over[bounded];
      past($ss.q, s.time, over);
{}      const T worst = select(largest(over) > of_joints, largest(over), of_joints);
)";

constexpr const char* leaves_out_free_rows =
    "      for (int i = 0; i < bounded; ++i) over[i] = select(active[i], over[i], T(0));\n";

constexpr const char* ends_join = R"(      auto more = T(1) < T(0);
      for (int i = 0; i < bounded; ++i) {
        const auto joins = goes_on && magnitude(over[i]) > T(8 * epsilon) && !active[i];
        if (!first) more = more || joins;
        active[i] = active[i] || joins;
      }
)";

constexpr const char* round_begins = R"(      s.residual = worst;
      const bool first = round == 0;
      const T goal = T(single ? 1e7 * {0} : {0});
      goes_on = goes_on && worst > {1};
      if (first) {{
        error = worst;
        goes_on = goes_on && !(magnitude(worst - left) <= T(single ? -1 : 1e-9) * worst);  // contradicting joints
      }}
)";

constexpr const char* renews = R"(      const auto is_slow = goes_on && {0}worst > slow * before;
      goes_on = goes_on && !(is_slow && renewed && worst > T(0.5) * before);
{4}      const auto renews = goes_on && is_slow;
      if (any(renews)) {{
{2}        at.time = select(renews, s.time, at.time);
        for (int i = 0; i < bodies; ++i) at.q[i] = is_pack ? choose(renews, s.q[i], at.q[i]) : s.q[i];
{1}        renewed = renewed || renews;
      }}
{3}      before = worst;
)";

// Where no pose nearby meets all joints, Newton may end anywhere.
constexpr const char* ends_rounds = R"(      if (is_back || !any(goes_on) || round == 20) {{
        const auto worse = worst > error;
        if (is_back || !any(worse)) return error;
        take_back(s, worse, free, moves{});
        goes_on = T(1) < T(0), is_back = true;
        continue;
      }}
)";

constexpr const char* take_back = R"(
  // Of these lanes: poses as before the rounds, and nothing that the rounds have summed up.
  CDOT_SCENE_RARE static void take_back(State& s, const Mask& these, Pose (&free)[bodies],
                                        Velocity (&moves)[bodies]{0}) {{
{1}    for (int i = 0; i < bodies; ++i) s.q[i] = choose(these, free[i], s.q[i]);
    for (int i = 0; i < bodies; ++i) moves[i] = choose(these, still(), moves[i]);
{2}  }}
)";

std::string takes_back(const Contents& has) {
  constexpr const char* none = "    for (T& of_row : {0}) of_row = select(these, T(0), of_row);\n";
  std::string nothing = has.foresees ? fmt::format(none, "total") : "";
  if (has.weighs && has.weighs_joints()) nothing += fmt::format(none, "gained");
  if (has.weighs && has.ends) nothing += fmt::format(none, "gained_by_ends");
  return fmt::format(take_back, when(has.foresees, ", T (&total)[rows]") + parameters_of_gained(has),
                     when(has.foresees, "    turn(free);\n"), nothing);
}

constexpr const char* moves_of_rows = R"(      T lambda[rows];
      Velocity d[bodies];
      solve({}s.J, {}C, lambda, d);
)";

constexpr const char* takes_back_errors = "      for (int i = 0; i < bodies; ++i) d[i] = -d[i];\n";

constexpr const char* no_moves = R"(      Velocity d[bodies];
      for (int i = 0; i < bodies; ++i) d[i] = still();
)";

constexpr const char* moves_of_ends = R"(      T mu[bounded] = {{}};
      auto passed = T(1) < T(0);
      for (int i = 0; i < bounded; ++i) passed = passed || active[i];
      if (any(passed)) {{
        if (!reached) reach($sat.q, at.time, {0}B);
{3}        reached = true;
        T along_ends[bounded], c[bounded];
        along($sat.q, at.time, d, along_ends);
        for (int i = 0; i < bounded; ++i) c[i] = -over[i] - along_ends[i];
        divide(B, active, c, mu);
{1}      }}
{2})";

constexpr const char* adds_moves_of_ends = R"(        for (int e = 0; e < bounded; ++e) {
          for (int i = 0; i < bodies; ++i) d[i] = d[i] + mu[e] * B.g[e][i];
        }
)";

// Where inertias turn: impulses are found with M^-1 and J of `at`, but act on M^-1 as it is, as in the World.
constexpr const char* moves_by_all = R"(      Pose mixed[bodies];
      for (int i = 0; i < bodies; ++i) mixed[i] = at.q[i], mixed[i].I = s.q[i].I;
{0}      displace($smixed, at.time, {1}mu, d);
)";
constexpr const char* sums_impulses = R"(      for (int i = 0; i < rows; ++i) lambda[i] = -lambda[i];
      if (reached) {
        for (int e = 0; e < bounded; ++e) {
          for (int i = 0; i < rows; ++i) lambda[i] = lambda[i] + mu[e] * B.l[e][i];
        }
      }
)";

std::string ends_of(const Contents& has) {
  const bool keeps = has.gyroscopes && !has.modes;
  const std::string by_all = fmt::format(moves_by_all, has.rows ? sums_impulses : "", has.rows ? "s.J, lambda, " : "");
  return fmt::format(moves_of_ends, has.rows ? "s.J, " : "", keeps ? "" : adds_moves_of_ends, keeps ? by_all : "",
                     when(has.shares_impulses(), "        if (!reached) share(s.J, B);\n"));
}

constexpr const char* moves_bodies =
    R"(      for (int i = 0; i < bodies; ++i) d[i] = choose(goes_on, {}d[i], still()), moves[i] = moves[i] + d[i];
{}    }}
  }}
)";

// Turning a pose by nothing would change its bits, in a lane that waits.
constexpr const char* moves_poses_in_space = R"(      if (is_pack) {
        Pose next[bodies];
        for (int i = 0; i < bodies; ++i) next[i] = s.q[i];
        for (int i = 0; i < bodies; ++i) move(next[i], s.q[i], d[i]);
        turn(next);
        for (int i = 0; i < bodies; ++i) s.q[i] = choose(goes_on, next[i], s.q[i]);
      } else {
        shift(s.q, d);
      }
)";

constexpr const char* project_begins = R"(
  // Velocities onto J v = -dC/dt.
  static void project(State& s) {
)";

constexpr const char* projects_rows = R"(    rates(s.J, s.v, rate);
    Velocity d[bodies];
    solve($qs.J, rate, lambda, d);
    for (int i = 0; i < bodies; ++i) s.v[i] = s.v[i] - d[i];
)";

// A lane without a held row keeps its bits.
constexpr const char* projects_held_rows = R"(    Mask held[bounded], some = T(1) < T(0);
    for (int i = 0; i < bounded; ++i) held[i] = magnitude(s.hold[i]) < T(0.5), some = some || held[i];
    if (!any(some)) return;
    Bounded B;
    Guards G;
    T mu[bounded];
    reach($ss.q, s.time, {}B);
    guard($ss.q, s.time, s.v, G);
    for (T& of_row : mu) of_row = T(0);
    divide(B, held, G.missing, mu);
    for (int e = 0; e < bounded; ++e) {{
      for (int i = 0; i < bodies; ++i) s.v[i] = choose(some, s.v[i] + mu[e] * B.g[e][i], s.v[i]);
    }}
)";

}  // namespace

std::string corrections_of(double tolerance, const Contents& has, const std::string& renew) {
  std::string text;
  if (has.closes()) {
    if (has.foresees) text += foresight(has.rattle);
    text += takes_back(has);
    text += fmt::format(close_begins, has.foresees ? " and multipliers to those foreseen" : "",
                        has.foresees ? "Mask foreseen, " : "",
                        (has.foresees ? ", T (&total)[rows]" : "") + parameters_of_gained(has));
    text +=
        has.foresees ? moves_as_foreseen(has.spatial) : "    for (int i = 0; i < bodies; ++i) moves[i] = still();\n";
    text += when(has.ends,
                 "    Bounded B;\n    bool reached = false;  // B is that of `at`\n    Mask active[bounded];\n"
                 "    for (int i = 0; i < bounded; ++i) ") +
            when(has.ends, !has.modes      ? "active[i] = T(1) < T(0);\n"
                           : has.late_ends ? "active[i] = magnitude(s.hold[i]) < T(0.125);\n"
                                           : "active[i] = magnitude(s.hold[i]) < T(0.5);\n");
    text += "    for (int round = 0;; ++round) {\n";
    text += has.rows ? errors_of_rows : "      const T of_joints = T(0);\n";
    text += has.ends ? fmt::format(errors_of_ends, has.modes ? leaves_out_free_rows : "")
                     : "      const T worst = of_joints;\n";
    text +=
        fmt::format(round_begins, tolerance, has.foresees ? "(first ? select(foreseen, T(-1), goal) : goal)" : "goal");
    text += when(has.ends && !has.modes, ends_join);
    if (has.foresees) text += fmt::format(goes_astray, gained(has));
    text += fmt::format(
        renews, has.ends && !has.modes ? "!more && " : "",
        when(has.rows, "        evaluate($sat.q, at.time, s.J);\n") + when(has.ends, "        reached = false;\n"),
        renew, has.foresees ? aims(has.spatial) : "",
        fmt::format(ends_rounds, when(has.foresees, ", total") + gained(has)));
    const bool turns_with_ends = has.ends && has.gyroscopes && !has.modes;
    text += has.rows ? fmt::format(moves_of_rows, turns_with_ends ? "at.q, " : "$q", has.foresees ? "B, aimed, " : "")
                     : no_moves;
    text += when(has.foresees,
                 "      for (int i = 0; i < rows; ++i) total[i] = total[i] - select(goes_on, lambda[i], T(0));\n");
    text += gains_of_rows(has);
    if (has.ends) text += (has.rows ? takes_back_errors : "") + ends_of(has) + gains_of_ends(has);
    text +=
        fmt::format(moves_bodies, has.ends ? "" : "-", has.spatial ? moves_poses_in_space : "      shift(s.q, d);\n");
  }
  if (has.weighs_joints()) text += project_with_impulses();
  else if (has.projects()) text += project_begins + when(has.rows, "    T rate[rows], lambda[rows];\n");
  if (has.projects()) text += when(has.rows, projects_rows) + when(has.shares_impulses(), "    share(s.J, lambda);\n");
  if (has.modes) text += fmt::format(projects_held_rows, has.rows ? "s.J, " : "");
  if (has.projects()) text += "  }\n";
  return text;
}

}  // namespace cdot::compile
