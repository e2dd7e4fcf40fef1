#include "derive/compile/methods/bonds.hpp"

#include <algorithm>
#include <fmt/format.h>

#include "derive/compile/methods/events.hpp"
#include "derive/compile/scene/groups.hpp"

namespace cdot::compile {
namespace {

constexpr const char* bonds_type_text =
    R"(  static constexpr int joints = {0}, strengths = {1}, mechanisms = {2};
  // 1 for a joint that holds, 0 for one that is broken for good; the load on each, as of the last step [N], [N m].
  struct Bonds {{
    T holds[{0}], load[{0}];
{5}{6}  }};
  // The joint of each strength, and its mechanism.
  static constexpr int joint_of[strengths] = {{{3}}}, mechanism_of[strengths] = {{{4}}};
)";

// As the World does it: runtime/effects/breaking.cpp. Of bonds at the same distance the joint with the lower number
// goes first.
constexpr const char* snap_begins = R"(
  // Joints that carry too much: in each mechanism the one that is most beyond its strength breaks.
  static {0} snap(State& s{1}) {{
    weigh_joints(s{2});
    T from[strengths], least[mechanisms], first[mechanisms];
    for (T& of_joint : first) of_joint = T(-1);
    for (T& of_joint : least) of_joint = T(1e30);
)";

constexpr const char* snap_chooses = R"(    strain($ss.time, s.bonds.load, from);
    for (int k = 0; k < strengths; ++k) {{
      T &far = least[mechanism_of[k]], &which = first[mechanism_of[k]];
      const auto breaks = s.bonds.holds[joint_of[k]] > T(0) && from[k] <= {0} && from[k] < far{4};
      far = select(breaks, from[k], far), which = select(breaks, T(joint_of[k]), which);
    }}
    auto some = T(1) < T(0);
    Mask now[joints];
    for (Mask& of_joint : now) of_joint = some;
    for (int k = 0; k < strengths; ++k)
      now[joint_of[k]] = magnitude(first[mechanism_of[k]] - T(joint_of[k])) < T(0.5);
    for (const Mask& of_joint : now) some = some || of_joint;
    if (!any(some)) return{1};
    for (int k = 0; k < joints; ++k) s.bonds.holds[k] = select(now[k], T(0), s.bonds.holds[k]);
{2}{3}  }}
)";

// Rows end first, as pins that shear: without them the joints carry other loads.
constexpr const char* finds_events = R"(    constexpr int mechanism_of_bound[bounded] = {{{0}}};
{1}    Mask happens[mechanisms];
    for (Mask& of_mechanism : happens) of_mechanism = T(1) < T(0);
    for (int i = 0; i < bounded; ++i) {{
      const T &began = s.events.began[i], &ended = s.events.ended[i];
{2}      happens[mechanism_of_bound[i]] = happens[mechanism_of_bound[i]] || begins_now || ends_now;
    }}
)";

// A step that passes the strength of a joint ends there: runtime/events/bonds.cpp.
constexpr const char* margins_of_joints = R"({0}{3}    weigh_joints(s, {1});
    T from[strengths];
    strain($ss.time, s.bonds.load, from);
    for (int k = 0; k < strengths; ++k)
      m.margin[{2}k] = select(s.bonds.holds[joint_of[k]] > T(0), smaller(from[k] / near, T(1e30)), T(1e30));
)";

constexpr const char* chooses_joints = R"(
  static void find_margins(State& s) {{
    Modes& m = s.modes;
{0}  }}

  // Where forces break a joint, the others carry other loads.
  static void choose_modes(State& s, const T&) {{
    for (Mask again = T(0) < T(1); any(again);) {{
      State next = s;
{2}      replace(s, next, again);
      again = snap(s, {1}, T(single ? 1e-5 : 1e-10));
    }}
    find_margins(s);
    s.modes.known = T(1);
  }}
)";

constexpr const char* shares_in_place = R"(
  static void share(const Jacobian& J, T (&lambda)[rows]) {
    T shared[rows];
    share(J, lambda, shared);
    for (int i = 0; i < rows; ++i) lambda[i] = shared[i];
  }
)";
constexpr const char* shares_of_ends = R"(
  static void share(const Jacobian& J, Bounded& B) {
    for (T (&of_row)[rows] : B.l) share(J, of_row);
  }
)";
constexpr const char* shares_now = "    T shared[rows];\n    share(s.J, force, shared);\n";

constexpr const char* accelerates_joints = R"(      project(next);
      accelerate($snext.q, next.time, next.v, next.J, next.lambda, next.a);
)";
constexpr const char* accelerates_freely = "      fall($snext.q, next.time, next.v, next.a);\n";
constexpr const char* bears_end = R"(    T more[borne_rows];
    bear_end($ss.q, s.time, s.v, h, {}more);
    for (int i = 0; i < borne_rows; ++i) s.bonds.borne[i] = s.bonds.borne[i] + more[i];
)";
constexpr const char* bears_round = R"(      T borne[borne_rows];
      bear($smiddle, s.time, s.v, d, h, K, borne);
      for (int i = 0; i < borne_rows; ++i) in_middle[i] = select(goes_on, borne[i], in_middle[i]);
)";
constexpr const char* adds_borne =
    "    for (int i = 0; i < borne_rows; ++i) s.bonds.borne[i] = s.bonds.borne[i] + in_middle[i];\n";
constexpr const char* shares_round = R"(      evaluate($smiddle, s.time, s.J);
      share(s.J, y);
)";
constexpr const char* bears_now = "{0}bear($s{1}.q, {1}.time, {1}.v, {1}.bonds.borne);\n";

const std::vector<int>& bodies_of(const Mechanism& mechanism, const Bond& bond) {
  if (bond.joint >= 0) return mechanism.joints[static_cast<std::size_t>(bond.joint)].bodies;
  return bond.effect >= 0 ? mechanism.effects[static_cast<std::size_t>(bond.effect)].bodies
                          : mechanism.bounded[static_cast<std::size_t>(bond.bounded)].bodies;
}

// The norm of its rows' forces.
std::string load_of(const Bond& bond, const FirstRows& rows, const char* forces) {
  if (!bond.carries) return "";
  if (bond.bounded >= 0)
    return fmt::format("    s.bonds.load[{}] = magnitude(of_bounds[{}]);\n", bond.holds, bond.bounded);
  const bool by_force = bond.effect >= 0;
  const std::vector<std::size_t>& first = by_force ? rows.borne : rows.of_joints;
  const auto number = static_cast<std::size_t>(by_force ? bond.holds : bond.joint);
  std::string squares;
  for (std::size_t r = first[number]; r < first[number + 1]; ++r)
    squares += fmt::format("{0}{1}[{2}] * {1}[{2}]", squares.empty() ? "" : " + ", by_force ? "borne" : forces, r);
  return fmt::format("    s.bonds.load[{}] = sqrt({});\n", bond.holds, squares);
}

// Forces of a broken joint.
std::string forgets_forces(const Bond& bond, const FirstRows& rows, const Contents& has) {
  constexpr const char* forgets_row = "    s.{0}[{1}] = select(now[{2}], T(0), s.{0}[{1}]);\n";
  if (bond.bounded >= 0 && bond.carries)
    return fmt::format(forgets_row, has.modes ? "modes.force" : "force", bond.bounded, bond.holds);
  std::string text;
  const auto joint = static_cast<std::size_t>(bond.joint);
  for (std::size_t r = bond.joint < 0 ? 0 : rows.of_joints[joint]; bond.joint >= 0 && r < rows.of_joints[joint + 1];
       ++r)
    text += fmt::format(forgets_row, "lambda", r, bond.holds);
  return text;
}

// By RATTLE the next step begins with the pull of those that are left.
std::string pulls_anew(const Mechanism& mechanism, const Contents& has) {
  std::string text;
  for (std::size_t b = 0; has.repeats() && b < mechanism.bounded.size(); ++b)
    if (const int holds = mechanism.bounded[b].holds; holds >= 0)
      text += fmt::format("    s.repeats[{0}] = select(now[{1}], T(0), s.repeats[{0}]);\n", b, holds);
  return text + fmt::format(
                    "    Velocity pull[bodies];\n    draw($ss.q, s.time, {}{}pull);\n"
                    "    for (int i = 0; i < bodies; ++i) s.pull[i] = choose(some, pull[i], s.pull[i]);\n",
                    has.rows ? "s.J, s.lambda, " : "", has.repeats() ? "s.repeats, " : "");
}

// The parameters of snap() that are forces.
std::string forces_parameters(const Contents& has) {
  return std::string(has.rows ? ", const T (&force)[rows]" : "") +
         (has.bounded ? ", const T (&of_bounds)[bounded]" : "") + (has.bears ? ", const T (&borne)[borne_rows]" : "");
}
std::string sharing_of(const Contents& has) {
  return std::string(has.shares_impulses() || (has.shares && has.midpoint) ? shares_in_place : "") +
         (has.shares_impulses() && has.ends ? shares_of_ends : "");
}

}  // namespace

std::string bears_at_start(const Contents& has) {
  return has.bears ? "    bear_start($ss.q, s.time, s.v, h, s.bonds.borne);\n" : "";
}

std::string declares_borne(const Contents& has) {
  return has.bears ? "    T in_middle[borne_rows];\n    for (T& of_row : in_middle) of_row = T(0);\n" : "";
}

std::string loads_in_round(const Contents& has) {
  return std::string(has.bears ? bears_round : "") + (has.shares ? shares_round : "");
}

std::string shares(const Contents& has, const std::string& impulses) {
  return has.shares ? "    share(s.J, " + impulses + ");\n" : "";
}

std::string bears_at_end(const Contents& has, const std::string& end) {
  return (has.bears && has.midpoint ? adds_borne : "") +
         (has.bears_end ? fmt::format(bears_end, has.looks ? "given, " + end + ", " : "") : "");
}

std::string forces_of_state(const Contents& has) {
  std::string text = has.rows ? ", s.lambda" : "";
  if (has.bounded) text += ", s.modes.force";
  if (has.bears) text += ", s.bonds.borne";
  return text.substr(std::min<std::size_t>(2, text.size()));
}

std::string bonds_type(const Mechanism& mechanism, std::size_t borne, const Contents& has) {
  const std::vector<int> groups = groups_of(mechanism);
  std::vector<int> joints, of;
  for (const Bond& bond : mechanism.bonds) {
    joints.push_back(bond.holds), of.push_back(group_of(groups, bodies_of(mechanism, bond)));
  }
  const std::string size = has.bears ? fmt::format("  static constexpr int borne_rows = {};\n", borne) : "";
  return size +
         fmt::format(bonds_type_text, mechanism.breakable(), mechanism.bonds.size(),
                     1 + *std::ranges::max_element(groups), fmt::join(joints, ", "), fmt::join(of, ", "),
                     has.weighs_blows() ? "    T struck[joints];  // the largest load of an impact in this step\n" : "",
                     has.bears ? "    T borne[borne_rows];  // forces of effects and soft joints among these\n" : "");
}

std::string arguments_of_strain(const Mechanism& mechanism) {
  return fmt::format("$dconst T& time, const T (&load)[{}], T (&from)[{}])", mechanism.breakable(),
                     mechanism.bonds.size());
}

std::string arguments_of_bear(Method method) {
  if (method == Method::euler) return ", const T& h, const Velocity (&next)[bodies]";
  if (method == Method::implicit) return ", const Velocity (&d)[bodies], const T& h, const T (&K)[effect_rows]";
  return "";
}

std::string arguments_of_bear_end(const Contents& has) {
  return std::string(", const T& h") + (has.looks ? ", const T (&given)[damped], const T (&end)[damped]" : "");
}

std::string arguments_of_draw(const Contents& has) {
  return std::string(has.rows ? ", const Jacobian& J, const T (&lambda)[rows]" : "") +
         (has.repeats() ? ", const T (&mu)[bounded]" : "") + ", Velocity (&d)[bodies])";
}

std::string margins_of_bonds(const Contents& has) {
  return fmt::format(margins_of_joints, "    const T near = T(single ? 1e-5 : 1e-10);\n", forces_of_state(has),
                     has.modes ? "bounded + " : "", has.bears ? fmt::format(bears_now, "    ", "s") : "");
}

std::string snap_of(const Mechanism& mechanism, const FirstRows& rows, const Contents& has) {
  const bool at_once = has.shares && has.snaps;  // by other methods each impulse has been
  std::string loads = at_once ? shares_now : "", after = has.rows ? evaluates : "";
  for (std::size_t k = 0; k < mechanism.bonds.size(); ++k) {
    const Bond& bond = mechanism.bonds[k];
    if (k > 0 && mechanism.bonds[k - 1].holds == bond.holds) continue;
    loads += load_of(bond, rows, at_once ? "shared" : "force"), after += forgets_forces(bond, rows, has);
  }
  if (has.pulls()) after += pulls_anew(mechanism, has);
  const std::string parameters = forces_parameters(has);
  std::string text = sharing_of(has) +
                     "\n  // The loads on joints, by the forces of all rows.\n  static void weigh_joints(State& s" +
                     parameters + ") {\n    using std::sqrt;\n" + (has.rows ? "    (void)force;\n" : "") +
                     (has.bounded ? "    (void)of_bounds;\n" : "") + loads + "  }\n";
  text += fmt::format(
      snap_begins, has.snaps ? "Mask" : "void", parameters + (has.snaps ? ", const T& most" : ""),
      std::string(has.rows ? ", force" : "") + (has.bounded ? ", of_bounds" : "") + (has.bears ? ", borne" : ""));
  const bool waits = has.forces && !has.snaps;  // by other methods an event has ended the step
  if (waits)
    text += fmt::format(finds_events, fmt::join(groups_of_bounds(mechanism), ", "), distances_now(has), happens_now);
  text += fmt::format(snap_chooses, has.snaps ? "most" : "T(0)", has.snaps ? " some" : "", after,
                      has.snaps ? "    return some;\n" : "", waits ? " && !happens[mechanism_of[k]]" : "");
  if (has.snaps && !has.modes)
    text += fmt::format(chooses_joints, margins_of_bonds(has), forces_of_state(has),
                        std::string(has.rows ? accelerates_joints : accelerates_freely) +
                            (has.bears ? fmt::format(bears_now, "      ", "next") : ""));
  return text;
}

}  // namespace cdot::compile
