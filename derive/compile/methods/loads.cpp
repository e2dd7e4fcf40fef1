#include "derive/compile/methods/loads.hpp"

#include <fmt/format.h>

#include "derive/compile/methods/cones.hpp"

namespace cdot::compile {
namespace {

constexpr const char* goes_with_loads = R"(
  // Loads are positive. Where one would not be, friction grows faster than the load that it needs: then it grows.
  static Mask may_go(int i, const T (&next)[bounded], const T (&)[bounded]) { return next[i] >= T(0); }
  static T instead(int i, const T (&load)[bounded], const T (&found)[bounded]) {
    return T(2) * larger(load[i], found[i]);
  }
)";

// As the World does it: runtime/solve/loads.hpp, runtime/number/broyden.hpp.
constexpr const char* changes = R"(
  static Mask is_loaded(const Bounded& B, int i) {{ return magnitude(B.by_low[i]) + magnitude(B.by_high[i]) > T(0); }}
  static constexpr int careful_rounds = 20, some_rounds = 80, most_steps = 25;
  struct Search {{
    T steps[most_steps][bounded], sizes[most_steps];
  }};

  // One round of Broyden's method in the lanes of `busy`, which gets there by `change` from the last one. It forgets its
  // steps where there are many, and in lanes that may not go there.
  static void change_loads(Search& search, int round, const Mask& busy, {0}T (&change)[bounded],
                           const T (&found)[bounded], T (&load)[bounded]) {{
    const auto product = [](const T (&x)[bounded], const T (&y)[bounded]) {{
      T sum = T(0);
      for (int i = 0; i < bounded; ++i) sum = sum + x[i] * y[i];
      return sum;
    }};
    const int place = round % (most_steps + 1);
    const bool is_known = place < most_steps{10};
    T lengthen = {11};
    for (int j = 0; is_known && j < place; ++j) {{
      const T share = select(search.sizes[j] > T(0), product(search.steps[j], change) / search.sizes[j], T(0));
      if (j + 1 == place) lengthen = T(1) / (T(1) - share);
      else
        for (int i = 0; i < bounded; ++i) change[i] = change[i] + share * search.steps[j + 1][i];
    }}
    Mask goes_on = magnitude(lengthen) < T(1e6);
    T next[bounded], other[bounded];
    for (int i = 0; i < bounded; ++i) {{
      change[i] = select(goes_on, lengthen, T(1)) * change[i], next[i] = load[i] + change[i];
      if (is_known) search.steps[place][i] = change[i];
    }}
    for (int i = 0; i < bounded; ++i) {{
      const Mask may = may_go(i, {1}next, found);
      other[i] = select(may, next[i], instead(i, {1}load, found)), goes_on = goes_on && may;
    }}
    for (int i = 0; i < bounded; ++i) load[i] = select(busy, other[i], load[i]);
    if (is_known) search.sizes[place] = product(change, change);
    for (int j = 0; j < most_steps && j <= place; ++j)
      search.sizes[j] = is_known ? select(goes_on, search.sizes[j], T(0)) : T(0);
  }}

  // Repeats solve(), which finds forces within the bounds of B, until the loads with which these grow are those that it
  // yields. The bounds are then those of these loads. lambda: of the joints without these forces. True in lanes that
  // jam: no finite force lets the rows slip on.
  template <class Solve>
  static Mask settle_loads($dconst Pose (&q)[bodies], const T& time, {2}Bounded& B, T (&force)[bounded],
                           T (&load)[bounded], const Solve& solve) {{
    const Bounded plain = B;
    Search search;
    Mask busy = T(0) < T(1);
    for (int i = 0; i < bounded; ++i) load[i] = larger(T(0), load[i]);
{3}    for (int round = 0; round < {4} && any(busy); ++round) {{
      T now[bounded], found[bounded], change[bounded], worst = T(0);
      for (int i = 0; i < bounded; ++i) {{
        B.low[i] = plain.low[i] + plain.by_low[i] * load[i], B.high[i] = plain.high[i] + plain.by_high[i] * load[i];
        B.S[i * (i + 1) / 2 + i] = entry(plain.S, i, i);
      }}
{5}      solve(now);
      for (int i = 0; i < bounded; ++i) force[i] = select(busy, now[i], force[i]);
{6}      for (int i = 0; i < bounded; ++i) change[i] = found[i] - load[i], worst = larger(worst, magnitude(change[i]));
      const T enough = round < careful_rounds ? T(single ? 1e-6 : 1e-13) : {7};
{8}
    }}
{9}    return busy;
  }}
)";

constexpr const char* enough_of_loads = "T(single ? 1e-3 : 1e-9)";
constexpr const char* moves_loads = R"(      busy = busy && worst > enough * largest(found);
      change_loads(search, round, busy, change, found, load);)";

// With the corrections of the last step, which turn the velocities: `before`, and of joints `drawn`.
constexpr const char* carries_with_corrections = R"(      T whole[bounded];
      for (int i = 0; i < bounded; ++i) whole[i] = force[i] + before[i];
)";

constexpr const char* carries_of_joints = R"(      T all[rows];
      for (int i = 0; i < rows; ++i) all[i] = lambda[i]{0};
      for (int e = 0; e < bounded; ++e) {{
        for (int i = 0; i < rows; ++i) all[i] = all[i] + force[e] * B.l[e][i];
      }}
)";

}  // namespace

std::string arguments_of_carry(const Contents& has) {
  return std::string(has.rows ? ", const Jacobian& J, const T (&lambda)[rows]" : "") +
         ", const T (&force)[bounded], T (&load)[bounded])";
}

std::string settle_loads_of(const Contents& has, const std::string& cones) {
  const std::string force = has.corrects_loads() ? "whole" : "force";
  std::string carries = has.corrects_loads() ? carries_with_corrections : "";
  if (has.rows) carries += fmt::format(carries_of_joints, has.corrects_loads() ? " + drawn[i]" : "");
  const std::string joints = has.rows ? "J, all, " : "";
  carries += fmt::format("      carry($pq, time, {}{}, found);\n", joints, force);
  std::string parameters = has.rows ? "const Jacobian& J, const T (&lambda)[rows], " : "";
  if (has.corrects_loads())
    parameters += std::string(has.rows ? "const T (&drawn)[rows], " : "") + "const T (&before)[bounded], ";
  if (!has.cones)
    return goes_with_loads + fmt::format(changes, "", "", parameters, "", "some_rounds", "", carries, enough_of_loads,
                                         moves_loads, "", "", "T(1)");
  if (has.midpoint) carries += fmt::format(carries_for_cones, joints);
  return fmt::format(goes_with_cones, cones) +
         fmt::format(changes, "const Mask (&turns)[bounded], ", "turns[i], ", parameters + parameters_of_cones,
                     begins_corners, "3 * some_rounds", bounds_corners, carries + finds_corners, enough_of_corners,
                     moves_corners, ends_corners, unless_plain, lengthens);
}

std::string corners(const Contents& has, const char* share) {
  return has.cones ? fmt::format("turns, turned, {}, ", share) : "";
}

}  // namespace cdot::compile
