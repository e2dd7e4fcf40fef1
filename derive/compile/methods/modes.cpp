#include "derive/compile/methods/modes.hpp"

#include <fmt/format.h>
#include <string_view>

#include "derive/compile/methods/bonds.hpp"
#include "derive/compile/methods/cones.hpp"
#include "derive/compile/methods/loads.hpp"

namespace cdot::compile {
namespace {

constexpr const char* pulls = R"(
  // Accelerations with the rows in their modes.
  static void pull($dconst Pose (&q)[bodies], const T& time, const Velocity (&v)[bodies], {0}const T (&hold)[bounded],
                   {10}{1}T (&force)[bounded], {7}Velocity (&a)[bodies]) {{
    Bounded B;
    accelerate($pq, time, v, {2}a, B);
{11}    Mask held[bounded];
    for (int e = 0; e < bounded; ++e) held[e] = magnitude(hold[e]) < T(0.5);
    const auto solve = [&](T (&now)[bounded]) {{
      for (int e = 0; e < bounded; ++e) now[e] = is_rate[e] ? {14} : T(0);
      divide(B, held, B.c, now);
    }};
    {8}
    for (int e = 0; e < bounded; ++e) {{
      for (int i = 0; i < bodies; ++i) a[i] = a[i] + force[e] * B.g[e][i];
{3}    }}
  }}

  // The rates of change at a stage of a Runge-Kutta method, whose poses are turned.
  static void slope($dEvaluated& at, const Velocity (&v)[bodies], {4}const T (&hold)[bounded], {10}{12}{7}Slope& k) {{
$w{5}{13}    Velocity a[bodies];
    pull($pat.q, at.time, v, {6}force, {9}a);
    for (int i = 0; i < bodies; ++i) k.set(i, rate_of(at.q[i], v[i]), a[i]);
  }}
)";

constexpr const char* adds_forces =
    "      for (int i = 0; i < rows; ++i) lambda[i] = lambda[i] + force[e] * B.l[e][i];\n";

// As the World does it: runtime/events/events.cpp.
constexpr const char* kinds_of_rows = R"(
  static Mask is_endless(const T& bound) { return magnitude(bound) > T(1e29); }
  // Of row i: its value and its force have one end each; it holds on both sides; its distance from its end.
  static Mask has_one_end(const Guards& G, int i) {
    const Mask low = magnitude(G.low[i]) > T(0), high = magnitude(G.high[i]) > T(0);
    return is_rate[i] ? T(1) < T(0) : (low && !high) || (high && !low);
  }
  static Mask is_equation(const Guards& G, int i) { return is_endless(G.low[i]) && is_endless(G.high[i]); }
  static T gap(const Guards& G, int i) { return select(magnitude(G.low[i]) > T(0), -G.off[i], G.off[i]); }

  // Before the start of a run: ends that are passed hold, for the projection.
  static void hold_passed_ends(State& s) {
    Guards G;
    guard($ss.q, s.time, s.v, G);
    for (int i = 0; i < bounded; ++i) {
      const Mask passed = is_equation(G, i) || (has_one_end(G, i) && gap(G, i) < T(0));
      s.hold[i] = is_rate[i] ? T(1) : select(passed, T(0), T(1));
    }
  }
)";

constexpr const char* resolutions = R"(
  // Raises the resolutions of the rows to those at these accelerations, for steps of about h.
  static void raise_resolutions(State& s, const Velocity (&a)[bodies], const T& h) {
    T of_value[bounded], of_rate[bounded], of_force[bounded], of_hop[bounded];
    resolve($ss.q, s.time, s.v, a, s.modes.force, h, of_value, of_rate, of_force, of_hop);
    for (int i = 0; i < bounded; ++i) {
      s.modes.of_value[i] = T(slight) * of_value[i];
      s.modes.of_rate[i] = larger(s.modes.of_rate[i], T(slight) * of_rate[i]);
      s.modes.of_force[i] = larger(s.modes.of_force[i], T(slight) * of_force[i]);
      s.modes.of_hop[i] = larger(s.modes.of_hop[i], T(slight) * of_hop[i]);
    }
  }
)";

constexpr const char* decides = R"(
  // Forces and accelerations are complementary: a row stays held if its force lies within its bounds.
  static void decide(State& s, {8}const Mask (&stopped)[bounded]) {{
    Guards G;
    Bounded B;
    guard($ss.q, s.time, s.v, G);
    accelerate($ss.q, s.time, s.v, {0}s.a, B);
    T hold[bounded], force[bounded];
    for (int i = 0; i < bounded; ++i) {{
      const Mask both = is_equation(G, i), one = has_one_end(G, i);
      const Mask hops = one && G.missing[i] * G.missing[i] <= s.modes.of_hop[i];
      const Mask slow = stopped[i] || hops || magnitude(G.missing[i]) <= T(4) * s.modes.of_rate[i];
      const Mask off = one && !(slow && gap(G, i) <= s.modes.of_value[i]), slips = !both && !one && !slow;
      const Mask up = slips && G.missing[i] > T(0), down = slips && !up;
      B.low[i] = select(off, T(0), select(up, G.high[i], G.low[i]));
      B.high[i] = select(off, T(0), select(down, G.low[i], G.high[i]));
      const T end = select(magnitude(G.low[i]) > T(0), T(1), T(-1));
      s.hold[i] = select(off, end, select(up, T(1), select(down, T(-1), T(0))));
{7}{1}    }}
    const auto solve = [&](T (&now)[bounded]) {{
      for (T& of_row : hold) of_row = T(0);
      settle(B, hold, now);
    }};
{5}    {2}
    for (int i = 0; i < bounded; ++i) {{
      const Mask up = force[i] >= B.high[i], down = force[i] <= B.low[i];
      const Mask leaves = !is_equation(G, i) && magnitude(s.hold[i]) < T(0.5) && (up || down){4};
      const T end = select(magnitude(G.low[i]) > T(0), T(1), T(-1));
      s.hold[i] = select(leaves, select(has_one_end(G, i), end, select(up, T(1), T(-1))), s.hold[i]);
{3}    }}
{6}  }}
)";

// An end that began to hold where it is passed holds its bodies there: the step's end does not close it, and the next
// start moves them. As the World does it: runtime/solve/projection.cpp.
constexpr const char* holds_beyond = R"(    constexpr bool late[bounded] = {{{0}}};
    for (int i = 0; i < bounded; ++i) {{
      const Mask passed = magnitude(s.hold[i]) < T(0.5) && gap(G, i) < T((single ? -1e9 : -1e5) * {1});
      if (late[i]) s.hold[i] = select(passed, T(0.25), s.hold[i]);
    }}
)";

constexpr const char* is_pressed =
    "      m.margin[i] = select(s.hold[i] < T(0) && s.hold[i] > T(-0.5), T(1e30), m.margin[i]);  // a motor presses\n";
constexpr const char* margins_begin = R"(
  // How far each row is from its next event, in units of the resolution. Off: C - end. Held: its force from its bounds.
  // At a bound: the missing rate. Returns how far the furthest end is passed, beyond a few resolutions.
  static T find_margins(State& s) {
    T passed = T(0);
    Modes& m = s.modes;
    Guards G;
    guard($ss.q, s.time, s.v, G);
    grow(G, m);
    for (int i = 0; i < bounded; ++i) {
      const T from_bounds = smaller(m.force[i] - G.low[i], G.high[i] - m.force[i]);
      const T held = from_bounds / (m.of_force[i] + T(slight) * magnitude(m.force[i]));
      const T slips = select(s.hold[i] > T(0), G.missing[i], -G.missing[i]) / m.of_rate[i];
      const T bound = select(G.low[i] < G.high[i], slips, T(1e30));
      // Ends that have crossed since a row was off: there was no way between them.
      const T met = is_rate[i] ? bound : select(is_equation(G, i), -magnitude(G.off[i]) / m.of_value[i], bound);
      const T away = select(has_one_end(G, i), gap(G, i) / m.of_value[i], met);
      m.margin[i] = smaller(select(magnitude(s.hold[i]) < T(0.5), held, away), T(1e30));
      m.margin[i] = select(s.hold[i] < T(0) && s.hold[i] > T(-0.5), T(1e30), m.margin[i]);  // a motor presses
      passed = select(has_one_end(G, i), larger(passed, -gap(G, i) - T(4) * m.of_value[i]), passed);
    }
)";

// Where a time is unlimited the distance is no number: no event.
constexpr const char* margins_of_events = R"(    constexpr bool waits[bounded] = {{{0}}};
    T after[bounded], until[bounded];
    distances($ss.q, s.time, s.v, {1}after, until);
    for (int i = 0; i < bounded; ++i) {{
      const T near = T(single ? 1e-5 : 1e-10);
      m.margin[i] = select(s.events.began[i] < T(waits[i] ? 1 : 0), smaller(m.margin[i], after[i] / near), m.margin[i]);
      m.margin[i] = select(s.events.ended[i] < T(1), smaller(m.margin[i], until[i] / near), m.margin[i]);
    }}
)";

constexpr const char* chooses = R"(
  // The modes from now on, for steps of about h.{3}
  static {4} {2}(State& s, const T& h) {{
{1}    for (T& of_row : s.modes.of_rate) of_row = T(0);
    for (T& of_row : s.modes.of_force) of_row = T(0);
    for (T& of_row : s.modes.of_hop) of_row = T(0);
    Velocity a[bodies];
    fall($ss.q, s.time, s.v, a);
    raise_resolutions(s, a, h);
    Mask stopped[bounded];
{7}{5}    decide(s, {8}stopped);
    project(s);
    pull($ss.q, s.time, s.v, {0});
    raise_resolutions(s, s.a, h);
    find_margins(s);
    for (int i = 0; i < watched; ++i) s.modes.chosen[i] = s.modes.margin[i];
    s.modes.known = T(1);
{6}  }}
)";

constexpr const char* stops_and_keeps =
    "    {}Mask ended = stop_what_hits(s, h, {}stopped);\n{}    const State struck = s;\n";
constexpr const char* starts_and_ends = "    ended = start_motors(s, h, pressed, stands, ended) || ended;\n";
// Forces may make events happen, as of a pin that is too weak: then the modes are others.
constexpr const char* latches = R"(
  // True in lanes where an event happens.
  static Mask latches(State& s) {
    const Events before = s.events;
    latch(s);
    Mask some = T(1) < T(0);
    for (int i = 0; i < bounded; ++i)
      some = some || s.events.began[i] > before.began[i] || s.events.ended[i] > before.ended[i];
    return some;
  }
)";
constexpr const char* chooses_again = R"(
  static void choose_modes(State& s, const T& h) {{
    Mask ended = choose_once(s, h);
    for (;;) {{
      const Mask {};
      if (!any(again)) return;
      State next = s;
      ended = choose_once(next, h) && again;
      replace(s, next, again);
    }}
  }}
)";

constexpr const char* types =
    R"(  // Of rows with bounds: forces; resolutions, below which a value, a rate or a force counts as 0, and squared rates
  // below which a row hops off its end and is back at once; how far each row is from its next event in these units,
  // when its mode was chosen and now.
  struct Modes {{
    T force[bounded], of_value[bounded], of_rate[bounded], of_force[bounded], of_hop[bounded], chosen[watched],
        margin[watched];
    T known;  // 1 where the modes are those of the next step
{0}  }};
  // Of such rows: the distance from their end, what their rates miss, and the bounds of their forces.
  struct Guards {{
    T off[bounded], missing[bounded], low[bounded], high[bounded];
{1}  }};
)";

constexpr const char* types_of_bonds =
    R"(  // Of joints that may break: how far each is from breaking. None holds beyond its strength: chosen is 0.
  struct Modes {
    T chosen[watched], margin[watched];
    T known;  // 1 where joints that carry too much are broken
  };
)";

// As project() does it for rows that are held.
constexpr const char* stops_jammed =
    "      s.hold[i] = select(jams && is_loaded(B, i), T(0), s.hold[i]);  // by an impulse\n";

constexpr const char* grows = R"(
  // The bounds with the loads.
  static void grow(Guards& G, const Modes& m) {
    for (int i = 0; i < bounded; ++i) {
      G.low[i] = G.low[i] + G.by_low[i] * m.load[i], G.high[i] = G.high[i] + G.by_high[i] * m.load[i];
    }
  }
  // A row that jams has no load.
  static void forget_jammed(Modes& m) {
    for (const T& load : m.load) m.known = select(load < T(0), T(0), m.known);
  }
)";

constexpr const char* bounds_by_load = R"(      B.by_low[i] = select(off, T(0), select(up, G.by_high[i], G.by_low[i]));
      B.by_high[i] = select(off, T(0), select(down, G.by_low[i], G.by_high[i]));
)";

// A stage goes on as if the row were held, and the next stride chooses anew.
constexpr const char* holds_jammed = R"(
    if (any(jams)) {
      T now[bounded];
      for (int e = 0; e < bounded; ++e) {
        const Mask jammed = jams && is_loaded(B, e);
        held[e] = held[e] || jammed, load[e] = select(jammed, T(-1), load[e]);
      }
      solve(now);
      for (int e = 0; e < bounded; ++e) force[e] = select(jams, now[e], force[e]);
    })";
// Where motors of unlimited force press on ends. Such an end holds on both sides, whatever the forces are. A motor that
// it stops has no force, until it turns back.
constexpr const char* offers_by_motors =
    R"(      B.low[i] = select(pressed[i], T(-1e30), select(stands[i], T(0), B.low[i]));
      B.high[i] = select(pressed[i], T(1e30), select(stands[i], T(0), B.high[i]));
      s.hold[i] = select(pressed[i], T(-0.1), s.hold[i]);
      s.hold[i] = select(stands[i], select(G.missing[i] > T(0), T(1), T(-1)), s.hold[i]);
)";
constexpr const char* finds_pressed = R"(    Mask pressed[bounded], stands[bounded];
    find_pressed_ends(s, pressed, stands);
)";

std::string pull_of(const Contents& has) {
  const bool rows = has.rows, loads = has.loads;
  const char* const slips = has.cones ? "share, step, " : "";
  std::string at_bound = "select(hold[e] > T(0), B.high[e], B.low[e])";
  if (has.strong) at_bound = "select(is_endless(B.low[e]) && is_endless(B.high[e]), T(0), " + at_bound + ")";
  return fmt::format(pulls, rows ? "const Jacobian& J, " : "", rows ? "T (&lambda)[rows], " : "",
                     rows ? "J, lambda, " : "", rows ? adds_forces : "", rows ? "Jacobian& J, T (&forces)[rows], " : "",
                     rows ? "    evaluate($pat.q, at.time, J);\n" : "",
                     fmt::format("{}hold, {}{}", rows ? "J, " : "", slips, rows ? "forces, " : ""),
                     loads ? "T (&load)[bounded], " : "",
                     loads ? fmt::format("const Mask jams = settle_loads($pq, time, {}{}B, force, load, solve);{}",
                                         rows ? "J, lambda, " : "", corners(has, "none"), holds_jammed)
                           : "solve(force);",
                     loads ? "load, " : "", has.cones ? "const T (&share)[bounded], const T& step, " : "",
                     has.cones ? aims_at_stage : "", has.cones ? "T (&force)[bounded], " : "",
                     has.cones ? "" : "    T force[bounded];\n", at_bound);
}

// Blows of ends that are met, then those of motors that start.
std::string stops(const Contents& has) {
  const char* const known = has.strong ? "pressed, stands, " : "";
  if (yields_to_loads(has))
    return fmt::format(stops_and_keeps, has.strong ? "" : "const ", known, has.strong ? starts_and_ends : "");
  return fmt::format("    stop_what_hits(s, {}stopped);\n", known) +
         (has.strong ? "    start_motors(s, pressed, stands);\n" : "");
}

// Where forces of a choice call for another one.
std::string choices_of(const Contents& has) {
  const bool again = yields_to_loads(has);
  std::string text = fmt::format(chooses, arguments_of_pull(has), has.events ? "    latch(s);\n" : "",
                                 again ? "choose_once" : "choose_modes",
                                 again ? " Not in lanes where a blow ended something." : "", again ? "Mask" : "void",
                                 stops(has), again ? "    replace(s, struck, ended);\n    return ended;\n" : "",
                                 has.strong ? finds_pressed : "", has.strong ? "pressed, stands, " : "");
  if (!again) return text;
  const auto snaps = [&](const char* unless) {
    return fmt::format("snap(s, {}, select({}, T(-1e30), {}))", forces_of_state(has), unless, near_event);
  };
  // First events; other modes have other forces.
  const std::string asks = !has.forces ? "again = ended || " + snaps("ended")
                           : has.snaps ? "happens = latches(s) || ended, again = happens || " + snaps("happens")
                                       : "again = latches(s) || ended";
  return text + fmt::format(chooses_again, asks);
}

std::string decides_of(const Contents& has, const std::string& late, double tolerance) {
  const std::string J = has.rows ? "s.J, s.lambda, " : "";
  return fmt::format(
      decides, J, has.loads ? bounds_by_load : "",
      has.loads ? fmt::format("const Mask jams = settle_loads($ss.q, s.time, {}{}B, force, s.modes.load, solve);", J,
                              corners(has))
                : "solve(force);",
      has.loads ? stops_jammed : "", has.loads ? " && !jams" : "", has.cones ? offers_cones : "",
      (has.cones ? decides_cones : "") + (has.late_ends ? fmt::format(holds_beyond, late, tolerance) : ""),
      has.strong ? offers_by_motors : "", has.strong ? pressed_and_standing : "");
}

}  // namespace

std::string modes_types(const Contents& has) {
  const std::string watched =
      fmt::format("  static constexpr int watched = {}{};  // for events\n", has.modes ? "bounded" : "strengths",
                  has.modes && has.snaps ? " + strengths" : "");
  if (!has.modes) return watched + types_of_bonds;
  std::string more = has.loads ? "    T load[bounded];  // forces with which bounds grow\n" : "";
  if (has.cones) more += "    T step;  // [s]\n";
  return watched +
         fmt::format(types, more,
                     has.loads ? "    T by_low[bounded], by_high[bounded];  // what each unit of a load adds\n" : "");
}

std::string arguments_of_pull(const Contents& has) {
  return fmt::format("{}s.hold, {}{}s.modes.force, ", has.rows ? "s.J, " : "",
                     has.cones ? "s.share, s.modes.step, " : "", has.rows ? "s.lambda, " : "") +
         (has.loads ? "s.modes.load, " : "") + "s.a";
}

std::string modes_of(const Contents& has, const std::string& waits, const std::string& cones, const std::string& late,
                     double tolerance) {
  std::string text = pull_of(has) + kinds_of_rows + resolutions;
  if (has.loads) text += grows + settle_loads_of(has, cones);
  if (has.cones) text += aims_cones;
  if (has.forces) text += latches;
  text += stops_of(has) + decides_of(has, late, tolerance);
  std::string margins = margins_begin;
  const auto leave_out = [&](std::string_view line) { margins.erase(margins.find(line), line.size()); };
  if (!has.loads) leave_out("    grow(G, m);\n");
  if (!has.strong) leave_out(is_pressed);
  text += margins;
  if (has.cones) text += margins_of_cones;
  if (has.events) text += fmt::format(margins_of_events, waits, has.forces ? "m.force, " : "");
  if (has.snaps) text += margins_of_bonds(has);
  return text + "    return passed;\n  }\n" + choices_of(has);
}

}  // namespace cdot::compile
