#include <fmt/format.h>

#include "derive/compile/methods/cones.hpp"
#include "derive/compile/methods/loads.hpp"
#include "derive/compile/methods/modes.hpp"

namespace cdot::compile {
namespace {

// As the World does it: runtime/events/impacts.cpp.
constexpr const char* finds_blow = R"(
  // The impulses of a blow: ends that are met only push, and motors with a bounded force do not act.{4}
  static void find_blow(State& s, const Guards& G, {5}Bounded& B, T (&mu)[bounded]{9}) {{
    reach($ss.q, s.time, {0}B);
    T hold[bounded];
    for (int i = 0; i < bounded; ++i) {{
      const Mask low = is_endless(G.low[i]), high = is_endless(G.high[i]), one = has_one_end(G, i);
      const Mask both = low && high, some = is_rate[i] ? low || high : both;
      const Mask may = {6}(one && gap(G, i) <= s.modes.of_value[i]) || (!one && some){7};
{8}
      B.c[i] = G.missing[i];
{1}    }}
    const auto solve = [&](T (&now)[bounded]) {{
      for (T& of_row : hold) of_row = T(0);
      settle(B, hold, now{10});
    }};
{3}{2}  }}
)";

constexpr const char* bounds_of_blow =
    "      B.low[i] = select(may && low, G.low[i], T(0)), B.high[i] = select(may && high, G.high[i], T(0));";
constexpr const char* bounds_beside_motors =
    "      B.low[i] = select(may && (low || pressed[i]), T(-1e30), T(0));\n"
    "      B.high[i] = select(may && (high || pressed[i]), T(1e30), T(0));";

constexpr const char* starts_motors = R"(
  // Of a row: it is a motor of unlimited force that lacks its rate.
  static Mask lacks(const Guards& G, const Modes& m, int i) {
    return is_rate[i] ? is_equation(G, i) && magnitude(G.missing[i]) > T(4) * m.of_rate[i] : T(1) < T(0);
  }

  // Ends that are met and stop such motors are pressed, whatever moves and whatever the forces are, and these motors
  // stand. Motors push ten thousand times as hard as the bodies are heavy, and half of that: with them grow the impulses
  // of the ends on which they press, and no others.
  static void find_pressed_ends(State s, Mask (&pressed)[bounded], Mask (&stands)[bounded]) {
    Guards G;
    Bounded B;
    T half[bounded], mu[bounded], lacked = T(0);
    for (int e = 0; e < bounded; ++e) pressed[e] = stands[e] = T(1) < T(0);
    guard($ss.q, s.time, s.v, G);
    find_blow(s, G, pressed, stands, B, half, T(2e-4));
    find_blow(s, G, pressed, stands, B, mu, T(1e-4));
    for (int e = 0; e < bounded; ++e) {
      for (int i = 0; i < bodies; ++i) s.v[i] = s.v[i] + mu[e] * B.g[e][i];
      mu[e] = select(has_one_end(G, e), mu[e] - half[e], T(0));
    }
    guard($ss.q, s.time, s.v, G);
    for (int e = 0; e < bounded; ++e)
      lacked = larger(lacked, select(lacks(G, s.modes, e), magnitude(G.missing[e]), T(0)));
    const T most = largest(mu);
    const Mask some = lacked > T(0) && most > T(0);
    for (int e = 0; e < bounded; ++e) {
      pressed[e] = some && magnitude(mu[e]) > T(1e-3) * most;
      stands[e] = some && lacks(G, s.modes, e) && magnitude(G.missing[e]) > T(1e-6) * lacked;
    }
  }
)";

constexpr const char* reaches_rates = R"(
  // The other motors reach their rates by impulses.{0}
  static {1} start_motors(State& s, {2}const Mask (&pressed)[bounded], const Mask (&stands)[bounded]{3}) {{
    Guards G;
    Bounded B;
    T mu[bounded];
    guard($ss.q, s.time, s.v, G);
    Mask now = T(1) < T(0);
    for (int e = 0; e < bounded; ++e) now = now || (lacks(G, s.modes, e) && !stands[e]);
{4}    if (!any(now)) return{5};
    find_blow(s, G, pressed, stands, B, mu);
    for (int e = 0; e < bounded; ++e) {{
      for (int i = 0; i < bodies; ++i) s.v[i] = choose(now, s.v[i] + mu[e] * B.g[e][i], s.v[i]);
    }}
{6}  }}
)";

constexpr const char* stops = R"(
  // Inelastic impacts: rows that close at their end stop by impulses. True for those that have one.{5}
  static {4} stop_what_hits(State& s, {6}{8}Mask (&stopped)[bounded]) {{
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
    find_blow(s, G, {9}B, mu);
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
{2}    ended = ended && {3};
    for (T& of_row : yields.modes.force) of_row = T(0);
    replace(s, yields, ended);
    return ended;
)";
constexpr const char* weighs_blow = R"(    for (int k = 0; k < joints; ++k) {{
      T& most = yields.bonds.struck[k];
      most = select({}, larger(most, yields.bonds.load[k]), most), s.bonds.struck[k] = most;
    }}
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
// The end of a blow in some lanes, where loads may end something.
std::string yields_of(const Contents& has, const char* lanes) {
  if (!yields_to_loads(has)) return "";
  const bool weighs_rows = has.snaps && has.rows;
  std::string ends = has.forces ? "    ended = latches(yields);\n" : "";
  if (has.snaps)
    ends += fmt::format("{}    ended = snap(yields, {}yields.modes.force, {}{}) || ended;\n",
                        has.bears ? blow_of_effects : "", weighs_rows ? "blow, " : "", has.bears ? "unmoved, " : "",
                        near_event) +
            fmt::format(weighs_blow, lanes);
  return fmt::format(yields, weighs_rows ? blow_of_rows : "", weighs_rows ? adds_blow : "", ends, lanes);
}

std::string rates_of_motors(const Contents& has) {
  const bool may_end = yields_to_loads(has);
  const auto if_ends = [&](const char* text) { return may_end ? text : ""; };
  return fmt::format(reaches_rates, if_ends(" Returns the lanes in which that ends a row or a joint."),
                     may_end ? "Mask" : "void", if_ends("const T& h, "), if_ends(", const Mask& chooses_anew"),
                     if_ends("    now = now && !chooses_anew;\n"), if_ends(" now"), yields_of(has, "now"));
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
  const auto if_strong = [&](const char* text) { return has.strong ? text : ""; };
  return fmt::format(finds_blow, J, has.loads ? impacts_by_load : "", settles,
                     has.cones ? std::string(all_turn) + none_turned : "",
                     if_strong("\n  // Pressed ends hold on both sides, and rows that are out have none."),
                     if_strong("const Mask (&pressed)[bounded], const Mask (&out)[bounded], "),
                     if_strong("!out[i] && ("), if_strong(")"), has.strong ? bounds_beside_motors : bounds_of_blow,
                     if_strong(", const T& softness = T(usual_softness)"), if_strong(", softness")) +
         if_strong(starts_motors) + (has.strong ? rates_of_motors(has) : "") +
         fmt::format(stops, has.loads ? unless_it_slips : "", yields_of(has, "hits"), has.events ? latches_close : "",
                     has.events ? " || closes" : "", may_end ? "Mask" : "void",
                     may_end ? "\n  // Returns the lanes in which it ends a row or a joint by its load." : "",
                     may_end ? "const T& h, " : "", may_end ? " hits" : "", if_strong(pressed_and_standing),
                     if_strong("pressed, stands, "));
}

}  // namespace cdot::compile
