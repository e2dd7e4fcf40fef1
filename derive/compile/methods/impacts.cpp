#include <fmt/format.h>

#include "derive/compile/methods/cones.hpp"
#include "derive/compile/methods/loads.hpp"
#include "derive/compile/methods/modes.hpp"

namespace cdot::compile {
namespace {

// As the World does it: runtime/events/impacts.cpp.
constexpr const char* finds_blow = R"(
  // The impulses of a blow: ends that are met only push, and motors with a bounded force do not act.
  static void find_blow(State& s, const Guards& G, Bounded& B, T (&mu)[bounded]) {{
    reach($ss.q, s.time, {0}B);
    T hold[bounded];
    for (int i = 0; i < bounded; ++i) {{
      const Mask low = is_endless(G.low[i]), high = is_endless(G.high[i]), one = has_one_end(G, i);
      const Mask both = low && high, some = is_rate[i] ? low || high : both;
      const Mask may = (one && gap(G, i) <= s.modes.of_value[i]) || (!one && some);
      B.low[i] = select(may && low, G.low[i], T(0)), B.high[i] = select(may && high, G.high[i], T(0));
      B.c[i] = G.missing[i], B.K[i] = entry(B.S, i, i);
{1}    }}
    const auto solve = [&](T (&now)[bounded]) {{
      for (T& of_row : hold) of_row = T(0);
      settle(B, hold, now);
    }};
{3}{2}  }}
)";

constexpr const char* finds_pressed_ends = R"(
  // The impulses by which ends that are met would stop motors of unlimited force that drive against them, without those
  // that are round-off, and what the rates miss after them. False in lanes without such an impulse.
  static Mask find_pressed_ends(State s, T (&mu)[bounded], T (&missing)[bounded]) {
    Guards G;
    Bounded B;
    guard($ss.q, s.time, s.v, G);
    find_blow(s, G, B, mu);
    for (int e = 0; e < bounded; ++e) {
      for (int i = 0; i < bodies; ++i) s.v[i] = s.v[i] + mu[e] * B.g[e][i];
      mu[e] = select(has_one_end(G, e), mu[e], T(0));
    }
    guard($ss.q, s.time, s.v, G);
    const T most = largest(mu);
    for (int e = 0; e < bounded; ++e) {
      missing[e] = G.missing[e];
      mu[e] = select(magnitude(mu[e]) <= T(slight) * most, T(0), mu[e]);
    }
    return most > T(0);
  }
)";

constexpr const char* stops = R"(
  // Inelastic impacts: rows that close at their end stop by impulses. True for those that have one.{5}
  static {4} stop_what_hits(State& s, {6}Mask (&stopped)[bounded]) {{
    Guards G;
    Bounded B;
    guard($ss.q, s.time, s.v, G);
    Mask hits = T(1) < T(0);
    for (int i = 0; i < bounded; ++i) {{
      stopped[i] = T(1) < T(0);
      const T bound = select(G.missing[i] > T(0), G.high[i], G.low[i]);
      const Mask one = has_one_end(G, i), meets = one && gap(G, i) <= s.modes.of_value[i];
      const Mask drives = is_rate[i] ? !is_equation(G, i) : T(1) < T(0);
{2}      hits = hits || ((meets || drives{3}) && is_endless(bound) && magnitude(G.missing[i]) > s.modes.of_rate[i]);
    }}
    if (!any(hits)) return{7};
    T mu[bounded];
    find_blow(s, G, B, mu);
    for (int e = 0; e < bounded; ++e) {{
      stopped[e] = hits && magnitude(mu[e]) > T(0){0};
      for (int i = 0; i < bodies; ++i) s.v[i] = choose(hits, s.v[i] + mu[e] * B.g[e][i], s.v[i]);
    }}
{1}  }}
)";

// From its event on a latch holds its bodies on both sides.
constexpr const char* latches_close =
    "      const Mask closes = (is_rate[i] ? T(0) : s.events.began[i]) > T(0) && is_equation(G, i);\n";

// The load of a blow is its impulse over the step: joints that it overloads break, and events happen by it, at once.
constexpr const char* yields = R"(    State yields = s;
{0}    for (int e = 0; e < bounded; ++e) {{
      yields.modes.force[e] = mu[e] / h;
{1}    }}
    Mask ended = T(1) < T(0);
{2}    ended = ended && hits;
    for (T& of_row : yields.modes.force) of_row = T(0);
    replace(s, yields, ended);
    return ended;
)";
constexpr const char* weighs_blow = R"(    for (int k = 0; k < joints; ++k) {
      T& most = yields.bonds.struck[k];
      most = select(hits, larger(most, yields.bonds.load[k]), most), s.bonds.struck[k] = most;
    }
)";
constexpr const char* blow_of_rows = "    T blow[rows];\n    for (T& of_row : blow) of_row = T(0);\n";
constexpr const char* blow_of_effects =
    "    T unmoved[borne_rows];  // a blow has no impulse of theirs\n    for (T& of_row : unmoved) of_row = T(0);\n";
constexpr const char* adds_blow =
    "      for (int i = 0; i < rows; ++i) blow[i] = blow[i] + yields.modes.force[e] * B.l[e][i];\n";

// Rows that a load moves get bounds of impulses by it; a row that slips in the impact is not stopped.
constexpr const char* impacts_by_load = "      B.by_low[i] = G.by_low[i], B.by_high[i] = G.by_high[i];\n";
constexpr const char* settles_impact = R"(    T load[bounded];
    for (T& of_row : load) of_row = T(0);
    {}settle_loads($ss.q, s.time, {}B, mu, load, solve);
)";
constexpr const char* unless_it_slips = " && (!is_loaded(B, e) || (B.low[e] < mu[e] && mu[e] < B.high[e]))";
// The end of stop_what_hits(), where loads may end something.
std::string yields_of(const Contents& has) {
  if (!yields_to_loads(has)) return "";
  const bool weighs_rows = has.snaps && has.rows;
  std::string ends = has.forces ? "    ended = latches(yields);\n" : "";
  if (has.snaps)
    ends += fmt::format("{}    ended = snap(yields, {}yields.modes.force, {}{}) || ended;\n",
                        has.bears ? blow_of_effects : "", weighs_rows ? "blow, " : "", has.bears ? "unmoved, " : "",
                        near_event) +
            weighs_blow;
  return fmt::format(yields, weighs_rows ? blow_of_rows : "", weighs_rows ? adds_blow : "", ends);
}

}  // namespace

bool yields_to_loads(const Contents& has) { return has.forces || has.snaps; }

std::string stops_of(const Contents& has) {
  const bool may_end = yields_to_loads(has);
  const std::string J = has.rows ? "s.J, " : "";
  const std::string none = has.rows ? "T none[rows];\n    for (T& of_row : none) of_row = T(0);\n    " : "";
  const std::string settles = has.loads
                                  ? fmt::format(settles_impact, none, (has.rows ? "s.J, none, " : "") + corners(has))
                                  : "    solve(mu);\n";
  return fmt::format(finds_blow, J, has.loads ? impacts_by_load : "", settles,
                     has.cones ? std::string(all_turn) + none_turned : "") +
         (has.strong ? finds_pressed_ends : "") +
         fmt::format(stops, has.loads ? unless_it_slips : "", yields_of(has), has.events ? latches_close : "",
                     has.events ? " || closes" : "", may_end ? "Mask" : "void",
                     may_end ? "\n  // Returns the lanes in which it ends a row or a joint by its load." : "",
                     may_end ? "const T& h, " : "", may_end ? " hits" : "");
}

}  // namespace cdot::compile
