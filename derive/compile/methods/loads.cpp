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
  static Mask {12}($dconst Pose (&q)[bodies], const T& time, {2}Bounded& B, T (&force)[bounded],
                           T (&load)[bounded], {13}const Solve& solve) {{
    const Bounded plain = B;
    Search search;
{14}    for (int i = 0; i < bounded; ++i) load[i] = larger(T(0), load[i]);
{3}    for (int round = 0; round < {4} && any(busy); ++round) {{
      T now[bounded], found[bounded], change[bounded], worst = T(0);
      for (int i = 0; i < bounded; ++i) {{
        const T taken = {15}load[i];
        B.low[i] = plain.low[i] + plain.by_low[i] * taken, B.high[i] = plain.high[i] + plain.by_high[i] * taken;
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

constexpr const char* all_lanes = "    Mask busy = T(0) < T(1);\n";

// Without cones: `share` of the loads bounds forces. Loads that run away are `beyond`.
constexpr const char* shared_lanes = R"(    Mask busy = lanes;
    T last[bounded], last_found[bounded];
)";
constexpr const char* notes_running_away = R"(      T way = T(0), together = T(0), size = T(0);
      for (int i = 0; i < bounded && round > 0; ++i) {
        const T step = load[i] - last[i];
        way = way + step * step, together = together + step * (found[i] - last_found[i]), size = size + load[i] * load[i];
      }
      for (int i = 0; i < bounded; ++i) last[i] = load[i], last_found[i] = found[i];
      beyond = beyond || (busy && way > T(single ? 1e-6 : 1e-16) * size && together > way);
)";
// As the World does it: settle_loads() in runtime/solve/loads.hpp.
constexpr const char* least_loads = R"(
  // The same for whole loads. Where friction changes its own load by more than it is, more than one load is possible:
  // the right one is the least, to which the load tends as friction grows from none.
  template <class Solve>
  static Mask settle_loads($dconst Pose (&q)[bodies], const T& time, {0}Bounded& B, T (&force)[bounded],
                           T (&load)[bounded], const Solve& solve) {{
    constexpr int parts = 16;
    const Bounded plain = B;
    const Mask all = T(0) < T(1);
    Mask beyond = !all, jams = settle_share($pq, time, {1}B, force, load, T(1), all, beyond, solve);
    const Mask doubtful = beyond && !jams;
    if (!any(doubtful)) return jams;
    for (int i = 0; i < bounded; ++i) load[i] = select(doubtful, T(0), load[i]);
    Mask grows = doubtful;
    for (int part = 1; part <= parts; ++part) {{
      const Mask lanes = part < parts ? grows : doubtful;
      Mask passes = !all;
      B = plain;
      const Mask stuck = settle_share($pq, time, {1}B, force, load,
                                      select(lanes, T(double(part) / parts), T(1)), lanes, passes, solve);
      grows = grows && !stuck && !passes;
      if (part == parts) jams = jams || stuck;
    }}
    return jams;
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
  if (!has.cones) {
    const std::string arguments = std::string(has.rows ? "J, lambda, " : "") +
                                  (has.corrects_loads() && has.rows ? "drawn, " : "") +
                                  (has.corrects_loads() ? "before, " : "");
    return goes_with_loads +
           fmt::format(changes, "", "", parameters, "", "some_rounds", "", carries + notes_running_away,
                       enough_of_loads, moves_loads, "", "", "T(1)", "settle_share",
                       "const T& share, const Mask& lanes, Mask& beyond, ", shared_lanes, "share * ") +
           fmt::format(least_loads, parameters, arguments);
  }
  if (has.midpoint) carries += fmt::format(carries_for_cones, joints);
  return fmt::format(goes_with_cones, cones) +
         fmt::format(changes, "const Mask (&turns)[bounded], ", "turns[i], ", parameters + parameters_of_cones,
                     begins_corners, "3 * some_rounds", bounds_corners, carries + finds_corners, enough_of_corners,
                     moves_corners, ends_corners, unless_plain, lengthens, "settle_loads", "", all_lanes, "");
}

std::string corners(const Contents& has, const char* share) {
  return has.cones ? fmt::format("turns, turned, {}, ", share) : "";
}

}  // namespace cdot::compile
