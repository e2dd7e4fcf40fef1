#include "derive/compile/steps.hpp"

#include <fmt/format.h>

#include "derive/compile/collocation/radau.hpp"
#include "derive/compile/foresight/foresight.hpp"
#include "derive/compile/gyroscopes.hpp"
#include "derive/compile/methods/bonds.hpp"
#include "derive/compile/methods/runge_kutta.hpp"
#include "derive/compile/methods/weights.hpp"
#include "derive/compile/midpoint/implicit.hpp"
#include "derive/compile/one_freedom/step.hpp"
#include "derive/compile/rattle/rattle.hpp"
#include "derive/compile/texts.hpp"
#include "derive/compile/types.hpp"

namespace cdot::compile {
namespace {

std::string closes(const Contents& has) {
  return declares_gained(has) + "    Velocity moves[bodies];\n    close(s, at, T(0.2), moves" + gained(has) + ");\n";
}
constexpr const char* begins_series = R"(    s.known = T(0), s.share = T(0);
    for (Multipliers& numbers : s.past)
      for (T& of_row : numbers.of) of_row = T(0);
    Velocity moves[bodies];
)";
// Alone a mechanism needs them where an end is passed; lanes, where J is renewed in others.
std::string notes_poses(const Contents& has) {
  const std::string copies = "for (int i = 0; i < bodies; ++i) at.q[i] = s.q[i];\n";
  return "    Evaluated at;\n    at.time = s.time;\n" +
         (has.ends ? "    " + copies : "    if (is_pack) {\n      " + copies + "    }\n");
}

constexpr const char* euler_begins = R"(
  // Symplectic Euler: velocities with the joints' impulses, then poses, then C = 0 and J v = -dC/dt.
  static T step(State& s, T h = T(default_step)) {
)";

constexpr const char* euler_begins_open = R"(
  // Symplectic Euler: velocities with the joints' impulses, then poses. Nothing projects these onto C = 0.
  static T step(State& s, T h = T(default_step)) {
)";

constexpr const char* euler_by_joints = R"(    push($qs.v, h);
    T rate[rows];
    rates(s.J, s.v, rate);
{}    Velocity d[bodies];
    solve($qs.J, rate, s.lambda, d);
    for (int i = 0; i < rows; ++i) s.lambda[i] = -s.lambda[i];
    for (int i = 0; i < bodies; ++i) s.v[i] = s.v[i] - d[i];
)";

constexpr const char* feeds_back = R"(    T C[rows];
    errors($ss.q, s.time, C);
    const T share = T({}) / h;
    for (int i = 0; i < rows; ++i) rate[i] = rate[i] + share * C[i];
)";

constexpr const char* returns_errors = R"(    T left[rows];
    errors($ss.q, s.time, left);
    return largest(left);
  }
)";

constexpr const char* euler_by_kick = R"(    Velocity next[bodies];
{}    for (int i = 0; i < bodies; ++i) s.v[i] = next[i];
)";

constexpr const char* euler_bears = "    bear($ss.q, s.time, s.v, h, next, s.bonds.borne);\n";

constexpr const char* kick_with_bounds = R"(    Bounded B;
    T mu[bounded];
    kick({0}, B);
{2}    for (int e = 0; e < bounded; ++e) {{
      for (int i = 0; i < bodies; ++i) next[i] = next[i] + mu[e] * B.g[e][i];
    }}
{1})";

constexpr const char* adds_impulses = R"(    for (int e = 0; e < bounded; ++e) {
      for (int i = 0; i < rows; ++i) s.lambda[i] = s.lambda[i] + mu[e] * B.l[e][i];
    }
)";

// The multipliers are foreseen where the last step ended at C = 0.
constexpr const char* euler_moves_as_foreseen =
    R"(    s.known = select(left > T(single ? 1e7 * {0} : {0}), T(0), s.known);
    T foreseen[rows], total[rows];
    foresee(s, h * h, foreseen);
    for (int i = 0; i < rows; ++i) total[i] = foreseen[i];
    Velocity moves[bodies];
    apply($qs.J, foreseen, moves);
    {2} is_foreseen = s.known > T(0.5);
{1})";

// In space the pose at the end depends on the way of the rounds, but for small angles.
constexpr const char* foresees_small_turns = R"(    T most = T(0);
    for (const Velocity& d : moves) most = larger(d.wx * d.wx + d.wy * d.wy + d.wz * d.wz, most);
    is_foreseen = is_foreseen && most < T(1e-8);
    for (int i = 0; i < rows; ++i) total[i] = select(is_foreseen, foreseen[i], T(0));
    for (int i = 0; i < bodies; ++i) moves[i] = choose(is_foreseen, moves[i], still());
)";

constexpr const char* euler_corrects_as_foreseen =
    R"(    const T error = close(s, at, T(0.2), is_foreseen, moves, total);
    const auto fits = s.residual <= T(single ? 1e7 * {0} : {0});
    if (any(!fits)) {{
      for (int i = 0; i < rows; ++i) total[i] = select(fits, total[i], T(0));
    }}
    remember(s, fits, error <= T(single ? 1e10 * {0} : 1e3 * {0}), h * h, total, foreseen);
    // A displacement beyond the motion of the step, or of an error older than it, would add energy.
    auto is_slight = {1};
    const auto keep = (is_foreseen || left <= T(0.1) * error) && is_slight;
    for (int i = 0; i < bodies; ++i) s.v[i] = s.v[i] + select(keep, T(1) / h, T(0)) * moves[i];
)";

constexpr const char* is_slight = "T(4) * weighed(s.q, moves) <= h * h * weighed(s.q, s.v)";
// The bounds decide for most steps.
constexpr const char* is_slight_by_bounds = R"(T(4) * weighed_at_most(moves) <= h * h * weighed_at_least(s.v);
    if (any(!is_slight)) is_slight = is_slight || T(4) * weighed(s.q, moves) <= h * h * weighed(s.q, s.v))";

constexpr const char* euler_corrects = R"({0}    Velocity moves[bodies];
    const T error = close(s, at, T(0.2), moves{1});
    // A displacement beyond the motion of the step, or of an error older than it, would add energy.
    const auto keep = left <= T(0.1) * error && T(4) * weighed(s.q, moves) <= h * h * weighed(s.q, s.v);
    for (int i = 0; i < bodies; ++i) s.v[i] = s.v[i] + select(keep, T(1) / h, T(0)) * moves[i];
)";

std::string euler(const Mechanism& mechanism, const Contents& has) {
  const double tolerance = mechanism.tolerance;
  std::string text = has.open ? euler_begins_open : euler_begins;
  if (has.effects || has.bounded) {
    const std::string arguments =
        has.rows ? "$ss.q, s.time, s.v, s.J, h, next, s.lambda" : "$ss.q, s.time, s.v, h, next";
    const std::string kicks =
        has.bounded ? fmt::format(kick_with_bounds, arguments, has.rows ? adds_impulses : "", settles_impulses(has))
                    : fmt::format("    kick({});\n", arguments);
    text += fmt::format(euler_by_kick, kicks + (has.bears ? euler_bears : ""));
  } else {
    text += has.rows ? fmt::format(euler_by_joints, has.feeds ? fmt::format(feeds_back, mechanism.fed_back) : "")
                     : "    push($qs.v, h);\n";
  }
  text += shares(has, "s.lambda");
  if (has.closes()) text += "    const T left = s.residual;\n" + notes_poses(has);
  if (has.gyroscopes || !has.foresees) text += drifts(has, "s");
  text += "    s.time = s.time + h;\n";
  if (has.gyroscopes) text += follows;
  if (has.foresees)
    text += fmt::format(
                euler_moves_as_foreseen, tolerance,
                (has.spatial ? foresees_small_turns : std::string()) +
                    (has.gyroscopes ? "" : "    for (int i = 0; i < bodies; ++i) move(s.q[i], s.q[i], h * s.v[i]);\n"),
                has.spatial ? "auto" : "const auto") +
            fmt::format(euler_corrects_as_foreseen, tolerance, has.gyroscopes ? is_slight_by_bounds : is_slight);
  else if (has.closes()) text += fmt::format(euler_corrects, declares_gained(has), gained(has));
  if (has.gyroscopes && has.closes()) text += follows;
  text += "$C";
  if (has.rows) text += evaluates;
  if (has.weighs) text += euler_weighs(has);
  else if (has.projects()) text += "    project(s);\n";
  if (has.events) text += "    latch(s);\n";
  if (has.rows && has.open) return text + returns_errors;
  return text + fmt::format("    return {};\n  }}\n", has.closes() ? "s.residual" : "T(0)");
}

std::string text_of_step(const Mechanism& mechanism, const Contents& has) {
  if (mechanism.method == Method::euler) return euler(mechanism, has);
  if (mechanism.method == Method::rattle) return rattle(mechanism.tolerance, has);
  if (mechanism.method == Method::implicit) return implicit(mechanism, has);
  if (mechanism.method == Method::radau5) return radau(mechanism, has);
  return runge_kutta(mechanism.method, has, slope_size(mechanism, has.apart).rates <= few_rates);
}

}  // namespace

Contents contents_of(const Mechanism& mechanism, const Equations& equations) {
  return {.rows = !equations.rows.empty(),
          .effects = !mechanism.effects.empty(),
          .bounded = !mechanism.bounded.empty(),
          .ends = equations.has_ends,
          .events = equations.has_events,
          .late_ends = equations.has_late_ends,
          .numbers_of_J = !equations.stored.empty(),
          .forces = mechanism.has_events_by_force(),
          .spatial = mechanism.spatial(),
          .gyroscopes = mechanism.has_gyroscopes(),
          .angles = mechanism.angles > 0,
          .rattle = mechanism.method == Method::rattle,
          .midpoint = mechanism.method == Method::implicit,
          .dampens = !equations.dampen.outputs.empty(),
          .looks = !equations.effect_of.empty(),
          .finishes = equations.finishes,
          .exerts = equations.exerts,
          .frees = !equations.freed.empty(),
          .carries = mechanism.method == Method::rattle && carries_spin(mechanism, !equations.effect_of.empty()),
          .ends_drift = !equations.drift_of_ends.outputs.empty(),
          .modes = !mechanism.bounded.empty() && mechanism.on_accelerations(),
          .loads = mechanism.has_loads(),
          .cones = mechanism.has_cones(),
          .strong = mechanism.has_strong_motors(),
          .bonds = !mechanism.bonds.empty(),
          .snaps = !mechanism.bonds.empty() && mechanism.on_accelerations(),
          .bears = !equations.bear_start.outputs.empty() || !equations.bear.outputs.empty(),
          .bears_end = !equations.bear_end.outputs.empty(),
          .shares = !equations.share.outputs.empty(),
          .weighs = mechanism.weighs(),
          .clutches = equations.has_clutches,
          .drags = std::ranges::any_of(mechanism.bodies, &Body::drags),
          .foresees = !equations.apply.outputs.empty(),
          .one_freedom = equations.freedom.exists(),
          .open = mechanism.open,
          .feeds = mechanism.fed_back > 0,
          .turns = std::ranges::any_of(mechanism.bodies, &Body::turns),
          .taut = equations.taut > 0,
          .apart = equations.apart,
          .collocated = mechanism.method == Method::radau5 ? mechanism.components() : 0};
}

Calls calls_of(Method method, const Contents& has) {
  if (has.one_freedom) return {};                                   // beside those of its angles
  Calls calls{.evaluate = 1, .errors = 2, .rates = 1, .solve = 2};  // the corrections
  if (has.ends) calls.past = has.approaches() ? 3 : 2;
  if (has.events) calls.distances = 1;
  if (has.modes) calls.guard = 2, calls.reach = 1;
  if (method == Method::rattle) {
    calls.fall = 2, calls.dampen = has.dampens, calls.notice = has.looks, calls.look = has.looks ? 2 : 0;
    if (has.finishes) calls.finish = 1, --calls.rates, --calls.solve;
    return calls;
  }
  if (has.open && has.effects) return {.evaluate = 1, .errors = 1, .kick = 1};
  if (has.open) return {.evaluate = 1, .errors = has.feeds ? 2 : 1, .rates = 1, .solve = 1};
  if (method == Method::euler) {
    if (has.effects || has.bounded) calls.kick = 1;
    else ++calls.rates, ++calls.solve;
    return calls;
  }
  if (method == Method::implicit) {
    calls = {.evaluate = 1, .errors = 1, .rates = 1, .solve = 1, .dampen = has.dampens, .notice = has.looks};
    calls.improve = 1, calls.look = has.looks ? 2 : 0;
    if (has.finishes) calls.finish = 1, --calls.solve;
    return calls;
  }
  if (has.collocated > 0) {
    const int columns = static_cast<int>(has.collocated), stages = 3;
    calls.evaluate += columns + stages;
    calls.fall = calls.accelerate = 2 * columns + stages + 1;
    calls.newton = operations_of_collocation(has.collocated);
    return calls;
  }
  calls.fall = calls.accelerate = stages_of(method);
  calls.evaluate += calls.fall - 1;
  return calls;
}

long operations_of(const Equations& e, const Calls& calls) {
  const std::pair<int, const Program*> programs[] = {{calls.evaluate, &e.evaluate},
                                                     {calls.errors, &e.errors},
                                                     {calls.rates, &e.rates},
                                                     {calls.accelerate, &e.accelerate},
                                                     {calls.solve, &e.solve},
                                                     {1, &e.apply},
                                                     {calls.fall, &e.fall},
                                                     {calls.kick, &e.kick},
                                                     {calls.past, &e.past},
                                                     {1, &e.angles},
                                                     {calls.distances, &e.distances},
                                                     {calls.dampen, &e.dampen},
                                                     {calls.notice, &e.notice},
                                                     {calls.look, &e.look},
                                                     {calls.finish, &e.finish},
                                                     {1, &e.weigh},
                                                     {calls.improve, &e.stiffen},
                                                     {calls.guard, &e.guard},
                                                     {calls.reach, &e.reach},
                                                     {calls.improve, &e.improve},
                                                     {1, &e.bear},
                                                     {1, &e.bear_start},
                                                     {1, &e.bear_end}};
  long sum = calls.newton + operations_of_freedom(e.freedom);
  for (const auto& [times, program] : programs) sum += long{times} * derive::count(*program).total();
  return sum;
}

namespace {

// Of the member `modes`: margins are those of rows with bounds and of joints that may break.
long numbers_of_modes(const Mechanism& mechanism, const Contents& has) {
  if (!has.strides()) return 0;
  const long bounded = long(mechanism.bounded.size()), strengths = has.snaps ? long(mechanism.bonds.size()) : 0;
  return (has.cones ? 2 : 1) + (has.loads ? 7 : 6) * bounded + 2 * strengths;
}

}  // namespace

long state_bytes_of(const Mechanism& mechanism, const Equations& equations, const Contents& has) {
  long of_bodies = 0;
  for (const Body& body : mechanism.bodies) of_bodies += numbers_of(mechanism, body, has.pulls());
  const long of_rows = long{has.foresees ? 1 + foreseen_by(has.rattle) : 1} * long(equations.rows.size()) +
                       long(equations.stored.size()) + (has.closes() ? 1 : 0) + (has.foresees ? 2 : 0) +
                       numbers_of_freedom(equations.freedom) + (has.exerts ? equations.groups : 0) +
                       numbers_of_modes(mechanism, has) + (has.weighs_blows() ? 3 : 2) * mechanism.breakable() +
                       (has.bears ? long(equations.first_borne.back()) : 0) +
                       (has.events ? 3 * long(mechanism.bounded.size()) : 0);
  return long{sizeof(double)} *
         (1 + of_bodies + of_rows + long(mechanism.bounded.size()) +
          (has.midpoint || has.weighs ? long(mechanism.bounded.size()) : 0) +
          (has.carries_over() ? 2 * long(mechanism.bounded.size()) + long(equations.rows.size()) : 0) +
          (long{has.sticks()} + long{has.repeats()} + long{has.cones}) * long(mechanism.bounded.size()) +
          long(equations.constants.inputs.size()) + 2 * mechanism.angles);
}

namespace {

// The poses onto C = 0 and the velocities onto J v = -dC/dt, at the start of a run or beyond an end.
std::string closing_of(Method method, const Contents& has) {
  const bool accelerates = works_on_accelerations(method);
  std::string text;
  if (has.modes) text += "    hold_passed_ends(s);\n";
  if (has.closes()) text += "    s.residual = T(1e30);\n";
  if (has.rows) text += evaluates;
  if (has.closes())
    text += notes_poses(has) + (has.foresees ? std::string(begins_series) + closes_unforeseen : closes(has));
  if (has.closes() && has.gyroscopes) text += accelerates ? "$W" : follows;
  if (has.rows) text += evaluates;
  if (has.modes)
    text += fmt::format(
        "    for (T& of_row : s.hold) of_row = T(1);\n    project(s);\n    Bounded B;\n"
        "    accelerate($ss.q, s.time, s.v, {}s.a, B);\n",
        has.rows ? "s.J, s.lambda, " : "");
  else if (accelerates && has.rows)
    text += "    project(s);\n    accelerate($ss.q, s.time, s.v, s.J, s.lambda, s.a);\n";
  else if ((method == Method::rattle || method == Method::implicit) && has.rows) text += "    project(s);\n";
  else if (accelerates) text += "    fall($ss.q, s.time, s.v, s.a);\n";
  return text;
}

// As the World does it: Island::residual of runtime/events/latch.cpp. A step that closed such an end on its way would
// throw its bodies.
constexpr const char* approaches = R"(
  // Where ends began to hold that are passed: bodies move there, as at the start of a run.
  static void approach(State& s) {{
    constexpr bool late[bounded] = {{{0}}};
    T by[bounded];
    past($ss.q, s.time, by);
    Mask some = T(1) < T(0);
    for (int i = 0; i < bounded; ++i)
      if (late[i]) some = some || magnitude(by[i]) > T((single ? 1e9 : 1e5) * {1});
    if (!any(some)) return;
    const State passed = s;
{2}{3}    replace(s, passed, !some);
  }}
)";

}  // namespace

std::string approach_of(const Mechanism& mechanism, const std::string& late, const Contents& has) {
  if (!has.approaches()) return "";
  return fmt::format(approaches, late, mechanism.tolerance, closing_of(mechanism.method, has),
                     has.modes ? "    s.modes.known = T(0);\n" : "");
}

std::string begin_of(Method method, const Contents& has) {
  std::string text =
      "\n  // Makes a State whole after its poses, velocities or time were set.\n  static void begin(State& s) {\n"
      "    turn(s.q);\n";
  if (has.gyroscopes) text += works_on_accelerations(method) ? "$W" : "    wind(s);\n";
  text += "$C";
  if (has.bounded && (has.midpoint || has.weighs)) text += "    for (T& of_row : s.force) of_row = T(0);\n";
  if (has.strides()) text += "    s.modes = {};\n";
  if (has.cones) text += "    for (T& of_row : s.share) of_row = T(0);\n";
  if (has.events) text += "    latch(s);\n";
  if (has.rows) text += "    for (int i = 0; i < rows; ++i) s.lambda[i] = T(0);\n";
  if (has.carries_over()) {
    text += "    for (T& of_row : s.load) of_row = T(0);\n    for (T& of_row : s.before) of_row = T(0);\n";
    if (has.rows) text += "    for (T& of_row : s.drawn) of_row = T(0);\n";
  }
  if (has.repeats()) text += "    for (T& of_row : s.repeats) of_row = T(0);\n";
  text += closing_of(method, has);
  if (has.one_freedom) text += begins_freedom;
  if (has.pulls()) text += "    for (Velocity& of_body : s.pull) of_body = still();\n";
  if (has.exerts) text += "    for (T& of_group : s.begins) of_group = T(1);\n";
  return text + "  }\n";
}

std::string step_of(const Mechanism& mechanism, const Contents& has) {
  std::string text = text_of_step(mechanism, has);
  if (has.approaches()) text.insert(text.find('\n', text.find(step_head)) + 1, "    approach(s);\n");
  return text;
}

std::string by_rows(std::string step) {
  step.replace(step.find(step_head), step_head.size() + 3,
               std::string("step_by_rows(State& s, const T& h) {\n") + evaluates);
  return step.insert(step.find("static T step_by_rows"), "CDOT_SCENE_RARE ");
}

}  // namespace cdot::compile
