#include "derive/compile/methods/bonds.hpp"

#include <algorithm>
#include <fmt/format.h>

#include "derive/compile/scene/groups.hpp"

namespace cdot::compile {
namespace {

constexpr const char* bonds_type_text =
    R"(  // 1 for a joint that holds, 0 for one that is broken for good; the load on each, as of the last step [N], [N m].
  struct Bonds {{
    T holds[{0}], load[{0}];
  }};
)";

// As the World does it: runtime/effects/breaking.cpp. Of bonds at the same distance the joint with the lower number
// goes first.
constexpr const char* snap_begins = R"(
  // Joints that carry too much after a step: in each mechanism the one that is most beyond its strength breaks.
  static void snap(State& s{0}) {{
    constexpr int bonds = {1}, joint[bonds] = {{{2}}}, of[bonds] = {{{3}}}, joints = {4}, mechanisms = {5};
    using std::sqrt;
    T from[bonds], least[mechanisms], first[mechanisms];
    for (T& of_joint : first) of_joint = T(-1);
    for (T& of_joint : least) of_joint = T(1e30);
)";

constexpr const char* snap_chooses = R"(    strain({}s.time, s.bonds.load, from);
    for (int k = 0; k < bonds; ++k) {{
      T &far = least[of[k]], &which = first[of[k]];
      const auto breaks = s.bonds.holds[joint[k]] > T(0) && from[k] <= T(0) && from[k] < far;
      far = select(breaks, from[k], far), which = select(breaks, T(joint[k]), which);
    }}
    auto some = T(1) < T(0);
    Mask now[joints];
    for (Mask& of_joint : now) of_joint = some;
    for (int k = 0; k < bonds; ++k) now[joint[k]] = magnitude(first[of[k]] - T(joint[k])) < T(0.5);
    for (const Mask& of_joint : now) some = some || of_joint;
    if (!any(some)) return;
    for (int k = 0; k < joints; ++k) s.bonds.holds[k] = select(now[k], T(0), s.bonds.holds[k]);
{}  }}
)";

// The norm of its rows' forces.
std::string load_of(const Bond& bond, const std::vector<std::size_t>& rows) {
  if (bond.joint < 0) return fmt::format("    s.bonds.load[{}] = magnitude(of_bounds[{}]);\n", bond.holds, bond.rope);
  const auto joint = static_cast<std::size_t>(bond.joint);
  std::string squares;
  for (std::size_t r = rows[joint]; r < rows[joint + 1]; ++r)
    squares += fmt::format("{0}force[{1}] * force[{1}]", squares.empty() ? "" : " + ", r);
  return fmt::format("    s.bonds.load[{}] = sqrt({});\n", bond.holds, squares);
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

}  // namespace

std::string bonds_type(const Mechanism& mechanism) { return fmt::format(bonds_type_text, mechanism.breakable()); }

std::string arguments_of_strain(const Mechanism& mechanism) {
  return fmt::format("$dconst T& time, const T (&load)[{}], T (&from)[{}])", mechanism.breakable(),
                     mechanism.bonds.size());
}

std::string arguments_of_draw(const Contents& has) {
  return std::string(has.rows ? ", const Jacobian& J, const T (&lambda)[rows]" : "") +
         (has.repeats() ? ", const T (&mu)[bounded]" : "") + ", Velocity (&d)[bodies])";
}

std::string snap_of(const Mechanism& mechanism, const std::vector<std::size_t>& rows, const Contents& has) {
  const std::vector<int> groups = groups_of(mechanism);
  std::vector<int> joints, of;
  std::string loads, forgets = has.rows ? evaluates : "";
  for (const Bond& bond : mechanism.bonds) {
    const bool is_rope = bond.joint < 0;
    const auto number = static_cast<std::size_t>(is_rope ? bond.rope : bond.joint);
    int group = 0;
    for (const int body : is_rope ? mechanism.bounded[number].bodies : mechanism.joints[number].bodies)
      group = std::max(group, groups[static_cast<std::size_t>(body)]);
    const bool another = joints.empty() || joints.back() != bond.holds;
    joints.push_back(bond.holds), of.push_back(group);
    if (!another) continue;
    loads += load_of(bond, rows);
    for (std::size_t r = is_rope ? 0 : rows[number]; !is_rope && r < rows[number + 1]; ++r)
      forgets += fmt::format("    s.lambda[{0}] = select(now[{1}], T(0), s.lambda[{0}]);\n", r, bond.holds);
    if (is_rope)
      forgets += fmt::format("    s.force[{0}] = select(now[{1}], T(0), s.force[{0}]);\n", number, bond.holds);
  }
  if (has.rattle) forgets += pulls_anew(mechanism, has);
  const std::string arguments =
      std::string(has.rows ? ", const T (&force)[rows]" : "") + (has.bounded ? ", const T (&of_bounds)[bounded]" : "");
  std::string text = fmt::format(snap_begins, arguments, mechanism.bonds.size(), fmt::join(joints, ", "),
                                 fmt::join(of, ", "), mechanism.breakable(), 1 + *std::ranges::max_element(groups));
  if (has.rows) text += "    (void)force;\n";
  if (has.bounded) text += "    (void)of_bounds;\n";
  return text + loads + fmt::format(snap_chooses, "$s", forgets);
}

}  // namespace cdot::compile
