#include "derive/compile/methods/weights.hpp"

#include <fmt/format.h>

#include "derive/compile/methods/cones.hpp"
#include "derive/compile/methods/loads.hpp"

namespace cdot::compile {
namespace {

constexpr const char* weighs_rows =
    "      for (int i = 0; i < rows; ++i) gained[i] = gained[i] - select(goes_on, lambda[i], T(0));\n";
constexpr const char* weighs_ends = R"(      for (int e = 0; reached && e < bounded; ++e) {{
        const T now = select(goes_on, mu[e], T(0));
        gained_by_ends[e] = gained_by_ends[e] + now;
{}      }}
)";
constexpr const char* weighs_rows_by_ends =
    "        for (int i = 0; i < rows; ++i) gained[i] = gained[i] + now * B.l[e][i];\n";

constexpr const char* project_weighs = R"(
  static void project(State& s) {
    T lambda[rows];
    project(s, lambda);
  }
  static void project(State& s, T (&lambda)[rows]) {
    T rate[rows];
)";

// The whole impulses are loads.
constexpr const char* euler_projects = R"(    T projected[rows];
    project(s, projected);
)";
constexpr const char* euler_weighs_rows = R"(    T carried[rows];
    for (int i = 0; i < rows; ++i) carried[i] = (s.lambda[i] - projected[i] + select(keep, gained[i] / h, T(0))) / h;
)";
constexpr const char* euler_weighs_bounded = R"(    for (int i = 0; i < bounded; ++i) s.force[i] = mu[i] / h;
)";
constexpr const char* euler_weighs_ends =
    R"(    for (int i = 0; i < bounded; ++i) s.force[i] = (mu[i] + select(keep, gained_by_ends[i] / h, T(0))) / h;
)";

// Loads of the first half: its forces, and the impulses of ends.
constexpr const char* found_at_first = R"(    T found[rows];
    for (int i = 0; i < rows; ++i) found[i] = s.lambda[i];
)";
constexpr const char* found_by_moves = R"(      for (int i = 0; i < rows; ++i)
        found[i] = select(fails, select(keep, s.lambda[i] + gained[i] / (h * half), T(0)), found[i]);
)";
constexpr const char* ends_by_moves = R"(      for (int i = 0; i < bounded; ++i)
        total[i] = select(fails, select(keep, gained_by_ends[i] / h, T(0)), total[i]);
)";
constexpr const char* sums_bounds = R"(    for (int e = 0; e < bounded; ++e) s.force[e] = ({0}{1}mu[e]) / h;
)";
constexpr const char* notes_repeats = R"(    T repeated[bounded];
    for (int e = 0; e < bounded; ++e) {{
      repeated[e] = select(magnitude(B.low[e] * B.high[e]) > T(0), mu[e], T(0));
{}      s.repeats[e] = is_rate[e] ? repeated[e] / half : T(0);
    }}
)";
// As the World does it: bound_rows() and settle_clutches() in runtime/step/kick_drift.cpp.
constexpr const char* bounds_clutches = R"(    T held_before[bounded];
    Mask one_way[bounded];
    for (int e = 0; e < bounded; ++e) {{
      one_way[e] = T(1) < T(0), held_before[e] = s.hold[e];
      if (!is_rate[e]) continue;
      const Mask pulls = magnitude(B.low[e]) > T(0), pushes = magnitude(B.high[e]) > T(0);
      const T first = half * s.repeats[e];
      one_way[e] = {}!(pulls && pushes) && (pulls || pushes);
      B.low[e] = select(one_way[e] && pushes, -first, B.low[e]);
      B.high[e] = select(one_way[e] && pulls, -first, B.high[e]);
    }}
)";
constexpr const char* settles_clutches = R"(      if (is_rate[e]) {
        const T whole = half * s.repeats[e] + mu[e];
        const Mask slips = magnitude(s.hold[e]) > T(0), began = magnitude(s.repeats[e]) > T(0);
        const Mask goes_on = began && (slips || !(magnitude(held_before[e]) > T(0)));
        repeated[e] = select(one_way[e] && (!slips || !(magnitude(whole) > T(0))), T(0.5) * whole, repeated[e]);
        T& begins = s.begins[group_of_bound[e]];
        begins = select(one_way[e] && magnitude(mu[e]) > T(0) && !goes_on, T(1), begins);
      }
)";
// As the World does it: begins_to_stick() in runtime/step/kick_drift.cpp.
constexpr const char* notes_sticking = R"(    for (int e = 0; e < bounded; ++e) {{
      if (!is_rate[e]{0}) continue;
      T missed = -B.c[e];
      for (int i = 0; i < bounded; ++i) missed = missed + entry(B.S, e, i) * mu[i];
      const T slight = larger(T(single ? 1e-5 : 1e-11), T(single ? 1e-4 : 1e-9) * largest(B.c));
      const Mask has_rate = !(magnitude(s.hold[e]) > T(0)) || magnitude(missed) <= slight;
      const Mask sticks = {1}B.low[e] < B.high[e] && has_rate;
      T& begins = s.begins[group_of_bound[e]];
      begins = select(sticks && !(s.stuck[e] > T(0)), T(1), begins);
      s.stuck[e] = select(sticks, T(1), T(0));
    }}
)";
constexpr const char* notes_sticking_at_start = R"(    for (int e = 0; e < bounded; ++e) {{
      const Mask sticks = {}begins[group_of_bound[e]] && !(magnitude(hold[e]) > T(0));
      if (is_rate[e]) s.stuck[e] = select(sticks, T(1), s.stuck[e]);
    }}
)";
// Else round-off alternates, and may grow: calm_sticking_rows() in runtime/step/kick_drift.hpp.
constexpr const char* calms_repeats =
    R"(      const T few = T(1e-3) * (B.high[e] - B.low[e]), first = half * s.repeats[e], change = mu[e] - first;
      const T least = select(magnitude(mu[e]) < magnitude(first), magnitude(mu[e]), magnitude(first));
      const Mask sticks = {}mu[e] - B.low[e] > few && B.high[e] - mu[e] > few;
      const Mask goes_on = sticks && magnitude(change) <= larger(few, T(3) * least);
      repeated[e] = repeated[e] - select(goes_on, T(0.125) * change, T(0));
)";
constexpr const char* carries_rows = R"(    T carried[rows];
    for (int i = 0; i < rows; ++i) carried[i] = T(0.5) * (found[i] + s.lambda[i]);
)";

constexpr const char* end_changes_of_rows =
    "          for (int i = 0; i < rows; ++i) found[i] = found[i] + (T(1) / half) * mu[e] * reached.l[e][i];\n";

constexpr const char* start_repeats = R"(    for (int e = 0; e < bounded; ++e) {{
      const T again = is_rate[e] ? {} : T(0);
      s.repeats[e] = select(begins[group_of_bound[e]], again, s.repeats[e]);
    }}
)";

// Corrections turn the velocities, so they count in the loads of the next step.
constexpr const char* keeps_before = "    for (int i = 0; i < bounded; ++i) s.before[i] = {};\n";
constexpr const char* keeps_drawn =
    "    for (int i = 0; i < rows; ++i) s.drawn[i] = (select(keep, gained[i] / h, T(0)) - projected[i]) / h;\n";

// Corrections do not count in the size of a force.
std::string turns_alone(const Contents& has) { return has.cones ? std::string(all_turn) + none_turned : ""; }

constexpr const char* settles_euler = R"(    T before[bounded];
    for (int i = 0; i < bounded; ++i) before[i] = h * s.before[i];
{0}{2}    settle_loads($ss.q, s.time, {1}before, {3}B, mu, s.load, [&](T (&now)[bounded]) {{ settle(B, s.hold, now); }});
)";
constexpr const char* settles_euler_joints = R"(    T drawn[rows];
    for (int i = 0; i < rows; ++i) drawn[i] = h * s.drawn[i];
)";

// Loads are those of the whole step. The other half of what they bound acts at the start of the next one.
constexpr const char* settles_rattle = R"(    T of_first[bounded], load[bounded];
    for (int i = 0; i < bounded; ++i) {{
      of_first[i] = {0}half * s.repeats[i], load[i] = h * magnitude(s.force[i]);
      const T in_kick = {5};
      B.by_low[i] = in_kick * B.by_low[i], B.by_high[i] = in_kick * B.by_high[i];
    }}
{1}{6}{3}    settle_loads($ss.q, s.time, {2}of_first, {4}B, mu, load, [&](T (&now)[bounded]) {{ settle(B, s.hold, now); }});
)";
// After a blow of motors at the start, which has taken its friction, loads are those of the end alone.
constexpr const char* counts_end_alone = R"(    for (int i = 0; i < bounded; ++i) {{
      const auto alone = started[group_of_bound[i]]{0};
      of_first[i] = select(alone, T(0), of_first[i]);
      B.by_low[i] = select(alone, T(2), T(1)) * B.by_low[i], B.by_high[i] = select(alone, T(2), T(1)) * B.by_high[i];
    }}
{1})";
constexpr const char* counts_rows_of_end_alone =
    "    for (int i = 0; i < rows; ++i) drawn[i] = select(started[group_of_row[i]]{0}, T(0), drawn[i]);\n";
constexpr const char* settles_rattle_joints = R"(    T drawn[rows];
    for (int i = 0; i < rows; ++i) drawn[i] = half * found[i];
)";
constexpr const char* settles_rattle_start = R"(    T before[bounded], load[bounded];
    for (int i = 0; i < bounded; ++i) before[i] = T(0), load[i] = T(0);
{0}{2}    settle_loads($ss.q, s.time, {1}before, {3}B, mu, load, [&](T (&now)[bounded]) {{ settle(B, hold, now); }});
)";
constexpr const char* settles_rattle_start_joints = R"(    T drawn[rows];
    for (T& of_row : drawn) of_row = T(0);
)";

std::string snaps_with_loads(const Contents& has) {
  if (!has.bonds) return {};
  return std::string("    snap(s") + (has.rows ? ", carried" : "") + (has.bounded ? ", s.force" : "") +
         (has.bears ? ", s.bonds.borne" : "") + ");\n";
}

}  // namespace

std::string gained(const Contents& has) {
  if (!has.weighs) return {};
  return std::string(has.weighs_joints() ? ", gained" : "") + (has.ends ? ", gained_by_ends" : "");
}

std::string parameters_of_gained(const Contents& has) {
  if (!has.weighs) return {};
  return std::string(has.weighs_joints() ? ", T (&gained)[rows]" : "") +
         (has.ends ? ", T (&gained_by_ends)[bounded]" : "");
}

std::string declares_gained(const Contents& has) {
  if (!has.weighs) return {};
  return std::string(has.weighs_joints() ? "    T gained[rows];\n    for (T& of_row : gained) of_row = T(0);\n" : "") +
         (has.ends ? "    T gained_by_ends[bounded];\n    for (T& of_row : gained_by_ends) of_row = T(0);\n" : "");
}

std::string gains_of_rows(const Contents& has) {
  return std::string(has.shares_impulses() ? "      share(s.J, lambda);\n" : "") +
         (has.weighs_joints() ? weighs_rows : "");
}

std::string gains_of_ends(const Contents& has) {
  return has.weighs && has.ends ? fmt::format(weighs_ends, has.weighs_joints() ? weighs_rows_by_ends : "") : "";
}

std::string project_with_impulses() { return project_weighs; }

std::string settles_impulses(const Contents& has) {
  if (!has.loads) return "    settle(B, s.hold, mu);\n";
  return fmt::format(settles_euler, has.rows ? settles_euler_joints : "", has.rows ? "s.J, s.lambda, drawn, " : "",
                     turns_alone(has), corners(has));
}

std::string euler_weighs(const Contents& has) {
  std::string text = has.weighs_joints() ? euler_projects : has.rows ? "    project(s);\n" : "";
  if (has.rows && has.bonds) text += euler_weighs_rows;
  if (has.bounded) text += has.ends ? euler_weighs_ends : euler_weighs_bounded;
  if (has.loads) {
    text += fmt::format(keeps_before, has.ends ? "select(keep, gained_by_ends[i] / h, T(0)) / h" : "T(0)");
    if (has.rows) text += keeps_drawn;
  }
  return text + snaps_with_loads(has);
}

std::string weighs_first_half(const Contents& has) { return has.weighs_joints() ? found_at_first : ""; }

std::string weighs_end_changes(const Contents& has) { return has.weighs_joints() ? end_changes_of_rows : ""; }

std::string weighs_failures(const Contents& has) {
  if (!has.weighs) return {};
  return std::string(has.weighs_joints() ? found_by_moves : "") + (has.ends ? ends_by_moves : "");
}

std::string bounds_of_clutches(const Contents& has) {
  return has.clutches ? fmt::format(bounds_clutches, has.loads ? "!is_loaded(B, e) && " : "") : "";
}

std::string sticking_rows(const Contents& has) {
  const std::string plain =
      std::string(has.clutches ? "!one_way[e] && " : "") + (has.loads ? "!is_loaded(B, e) && " : "");
  return has.sticks() ? fmt::format(notes_sticking, has.cones ? " || cone_of[e] >= 0" : "", plain) : "";
}

std::string sticking_rows_at_start(const Contents& has) {
  return has.sticks() ? fmt::format(notes_sticking_at_start, has.loads ? "!is_loaded(B, e) && " : "") : "";
}

std::string weighs_bounds(const Contents& has) {
  std::string calms =
      has.loads ? fmt::format(calms_repeats, has.cones ? "(cone_of[e] < 0 ? is_loaded(B, e) : T(1) < T(0)) && "
                                                       : "is_loaded(B, e) && ")
                : "";
  if (has.clutches) calms += settles_clutches;
  const std::string sums =
      fmt::format(sums_bounds, has.repeats() ? "half * s.repeats[e] + " : "", has.ends ? "total[e] + " : "");
  return (has.weighs ? sums : "") + (has.repeats() ? fmt::format(notes_repeats, calms) : "");
}

std::string rattle_weighs(const Contents& has) {
  return has.weighs ? (has.weighs_joints() && has.bonds ? carries_rows : "") + snaps_with_loads(has) : "";
}

std::string settles_end_with_loads(const Contents& has) {
  const auto unless_struck = [&](const char* group) {
    return has.strikes() ? fmt::format(" && !struck[{}[i]]", group) : std::string();
  };
  const std::string rows_alone =
      has.rows ? fmt::format(counts_rows_of_end_alone, unless_struck("group_of_row")) : std::string();
  return fmt::format(
      settles_rattle, has.ends ? "total[i] + " : "", has.rows ? settles_rattle_joints : "",
      has.rows ? "s.J, s.lambda, drawn, " : "", turns_alone(has), corners(has),
      has.strikes() ? "select(struck[group_of_bound[i]], T(1), T(0.5))" : "T(0.5)",
      has.starts_motors() ? fmt::format(counts_end_alone, unless_struck("group_of_bound"), rows_alone) : "");
}

std::string settles_start_with_loads(const Contents& has) {
  return fmt::format(settles_rattle_start, has.rows ? settles_rattle_start_joints : "",
                     has.rows ? "s.J, lambda, drawn, " : "", turns_alone(has), corners(has));
}

std::string repeats_at_start(const Contents& has) {
  return has.repeats() ? fmt::format(start_repeats, repeats_of_start(has)) : "";
}

std::string repeats_of_start(const Contents& has) {
  return has.clutches ? "mu[e]" : "select(magnitude(B.low[e] * B.high[e]) > T(0), mu[e], T(0))";
}

}  // namespace cdot::compile
