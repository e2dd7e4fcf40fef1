#include "derive/compile/methods/loads.hpp"

#include <fmt/format.h>

namespace cdot::compile {
namespace {

// As the World does it: runtime/solve/loads.hpp, runtime/number/broyden.hpp.
constexpr const char* settles = R"(
  static Mask is_loaded(const Bounded& B, int i) {{ return magnitude(B.by_low[i]) + magnitude(B.by_high[i]) > T(0); }}
  static constexpr int most_rounds = 24;
  struct Search {{
    T steps[most_rounds][bounded], sizes[most_rounds];
  }};

  // One round of Broyden's method in the lanes of `busy`, which gets there by `change` from the last one. Where a load
  // would become negative, friction grows faster than the load that it needs: then the load grows.
  static void change_loads(Search& search, int round, const Mask& busy, T (&change)[bounded], const T (&found)[bounded],
                           T (&load)[bounded]) {{
    const auto product = [](const T (&x)[bounded], const T (&y)[bounded]) {{
      T sum = T(0);
      for (int i = 0; i < bounded; ++i) sum = sum + x[i] * y[i];
      return sum;
    }};
    T lengthen = T(1);
    for (int j = 0; j < round; ++j) {{
      const T share = select(search.sizes[j] > T(0), product(search.steps[j], change) / search.sizes[j], T(0));
      if (j + 1 == round) lengthen = T(1) / (T(1) - share);
      else
        for (int i = 0; i < bounded; ++i) change[i] = change[i] + share * search.steps[j + 1][i];
    }}
    Mask goes_on = magnitude(lengthen) < T(1e6);
    for (int i = 0; i < bounded; ++i) {{
      const T step = select(goes_on, lengthen, T(1)) * change[i], next = load[i] + step;
      search.steps[round][i] = step;
      const Mask right = next >= T(0);
      load[i] = select(busy, select(right, next, T(2) * larger(load[i], found[i])), load[i]);
      change[i] = select(right, T(0), T(1));
    }}
    for (const T& turned : change) goes_on = goes_on && turned < T(0.5);
    search.sizes[round] = product(search.steps[round], search.steps[round]);
    for (int j = 0; j <= round; ++j) search.sizes[j] = select(goes_on, search.sizes[j], T(0));
  }}

  // Repeats solve(), which finds forces within the bounds of B, until the loads with which these grow are those that it
  // yields. The bounds are then those of these loads. lambda: of the joints without these forces. True in lanes that
  // jam: no finite force lets the rows slip on.
  template <class Solve>
  static Mask settle_loads($dconst Pose (&q)[bodies], const T& time, {0}{2}Bounded& B, T (&force)[bounded],
                           T (&load)[bounded], const Solve& solve) {{
    const Bounded plain = B;
    Search search;
    Mask busy = T(0) < T(1);
    for (int i = 0; i < bounded; ++i) load[i] = larger(T(0), load[i]);
    for (int round = 0; round < most_rounds && any(busy); ++round) {{
      T now[bounded], found[bounded], change[bounded], worst = T(0);
      for (int i = 0; i < bounded; ++i) {{
        B.low[i] = plain.low[i] + plain.by_low[i] * load[i], B.high[i] = plain.high[i] + plain.by_high[i] * load[i];
        B.S[i * (i + 1) / 2 + i] = entry(plain.S, i, i);
      }}
      solve(now);
      for (int i = 0; i < bounded; ++i) force[i] = select(busy, now[i], force[i]);
{1}      for (int i = 0; i < bounded; ++i) change[i] = found[i] - load[i], worst = larger(worst, magnitude(change[i]));
      const T enough = round < 20 ? T(single ? 1e-6 : 1e-13) : T(single ? 1e-3 : 1e-9);
      busy = busy && worst > enough * largest(found);
      change_loads(search, round, busy, change, found, load);
    }}
    return busy;
  }}
)";

// With the corrections of the last step, which turn the velocities: `before`, and of joints `drawn`.
constexpr const char* carries_with_corrections = R"(      T whole[bounded];
      for (int i = 0; i < bounded; ++i) whole[i] = force[i] + before[i];
)";

constexpr const char* carries_of_joints = R"(      T all[rows];
      for (int i = 0; i < rows; ++i) all[i] = lambda[i]{0};
      for (int e = 0; e < bounded; ++e) {{
        for (int i = 0; i < rows; ++i) all[i] = all[i] + force[e] * B.l[e][i];
      }}
      carry($pq, time, J, all, {1}, found);
)";

}  // namespace

std::string arguments_of_carry(const Contents& has) {
  return std::string(has.rows ? ", const Jacobian& J, const T (&lambda)[rows]" : "") +
         ", const T (&force)[bounded], T (&load)[bounded])";
}

std::string settle_loads_of(const Contents& has) {
  const std::string force = has.corrects_loads() ? "whole" : "force";
  const std::string carries = has.rows
                                  ? fmt::format(carries_of_joints, has.corrects_loads() ? " + drawn[i]" : "", force)
                                  : fmt::format("      carry($pq, time, {}, found);\n", force);
  const std::string corrections =
      std::string(has.rows ? "const T (&drawn)[rows], " : "") + "const T (&before)[bounded], ";
  return fmt::format(settles, has.rows ? "const Jacobian& J, const T (&lambda)[rows], " : "",
                     (has.corrects_loads() ? carries_with_corrections : "") + carries,
                     has.corrects_loads() ? corrections : "");
}

}  // namespace cdot::compile
