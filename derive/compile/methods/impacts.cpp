#include <fmt/format.h>

#include "derive/compile/methods/cones.hpp"
#include "derive/compile/methods/loads.hpp"
#include "derive/compile/methods/modes.hpp"

namespace cdot::compile {
namespace {

// As the World does it: runtime/events/impacts.cpp.
constexpr const char* stops = R"(
  // Inelastic impacts: rows that close at their end stop by impulses. True for those that have one.{9}
  static {8} stop_what_hits(State& s, {10}Mask (&stopped)[bounded]) {{
    Guards G;
    Bounded B;
    guard($ss.q, s.time, s.v, G);
    Mask hits = T(1) < T(0);
    for (int i = 0; i < bounded; ++i) {{
      stopped[i] = T(1) < T(0);
      const T bound = select(G.missing[i] > T(0), G.high[i], G.low[i]);
      const Mask one = has_one_end(G, i), meets = one && gap(G, i) <= s.modes.of_value[i];
      const Mask drives = is_rate[i] ? !is_equation(G, i) : T(1) < T(0);
{6}      hits = hits || ((meets || drives{7}) && is_endless(bound) && magnitude(G.missing[i]) > s.modes.of_rate[i]);
    }}
    if (!any(hits)) return{11};
    reach($ss.q, s.time, {0}B);
    T hold[bounded], mu[bounded];
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
{5}{2}    for (int e = 0; e < bounded; ++e) {{
      stopped[e] = hits && magnitude(mu[e]) > T(0){3};
      for (int i = 0; i < bodies; ++i) s.v[i] = choose(hits, s.v[i] + mu[e] * B.g[e][i], s.v[i]);
    }}
{4}  }}
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
  const auto text = [&](const char* by_load, const std::string& settles, const char* slips, const std::string& turns) {
    return fmt::format(stops, J, by_load, settles, slips, yields_of(has), turns, has.events ? latches_close : "",
                       has.events ? " || closes" : "", may_end ? "Mask" : "void",
                       may_end ? "\n  // Returns the lanes in which it ends a row or a joint by its load." : "",
                       may_end ? "const T& h, " : "", may_end ? " hits" : "");
  };
  if (!has.loads) return text("", "    solve(mu);\n", "", "");
  const std::string none = has.rows ? "T none[rows];\n    for (T& of_row : none) of_row = T(0);\n    " : "";
  return text(impacts_by_load, fmt::format(settles_impact, none, (has.rows ? "s.J, none, " : "") + corners(has)),
              unless_it_slips, has.cones ? std::string(all_turn) + none_turned : "");
}

}  // namespace cdot::compile
