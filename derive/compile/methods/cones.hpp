// Rows of cones as text: one force of bounded size along several coordinates, as friction in a plane. As the World does
// it: runtime/solve/loads.hpp. Each row is bounded by a corner of a box that lies on the cone; corners are found beside
// the loads.
#pragma once

namespace cdot::compile {

// Whether a round of Broyden's method may go to loads and corners, and where it goes else.
inline constexpr const char* goes_with_cones = R"(
  // The first row of the cone of each; -1: it is alone.
  static constexpr int cone_of[bounded] = {{{}}};
  static T in_cone(int i, const T (&x)[bounded], const T (&y)[bounded]) {{
    T sum = T(0);
    for (int k = 0; k < bounded; ++k)
      if (cone_of[k] == cone_of[i]) sum = sum + x[k] * y[k];
    return sum;
  }}
  static T size_in_cone(int i, const T (&x)[bounded]) {{
    using std::sqrt;
    return sqrt(in_cone(i, x, x));
  }}
  static T most_in_cone(int i, const T (&x)[bounded]) {{
    T most = T(0);
    for (int k = 0; k < bounded; ++k)
      if (cone_of[k] == cone_of[i]) most = larger(most, x[k]);
    return most;
  }}

  // Loads are positive. Where one would not be, friction grows faster than the load that it needs: then it grows. So
  // does a corner that would turn round.
  static Mask may_go(int i, const Mask& turns, const T (&next)[bounded], const T (&found)[bounded]) {{
    return (cone_of[i] < 0 ? next[i] : select(turns, in_cone(i, next, found), next[i])) >= T(0);
  }}
  static T instead(int i, const Mask& turns, const T (&load)[bounded], const T (&found)[bounded]) {{
    const T grown = T(2) * larger(load[i], found[i]);
    if (cone_of[i] < 0) return grown;
    const T size = size_in_cone(i, found);
    return select(turns, T(2) * larger(size_in_cone(i, load), size) * inverse(size) * found[i], grown);
  }}

  // Corners in place of loads, in the directions of the last solution.
  static void begin_corners(const Bounded& B, const Mask (&turns)[bounded], const T (&turned)[bounded],
                            const T (&share)[bounded], T (&load)[bounded]) {{
    T one[bounded];
    for (T& of_row : one) of_row = T(1);
    for (int i = 0; i < bounded; ++i) {{
      if (cone_of[i] < 0) continue;
      const T size = size_in_cone(i, share), bound = B.high[i] + turned[i] + B.by_high[i] * load[i];
      load[i] = select(turns[i], bound * select(size > T(0), share[i] / size, inverse(size_in_cone(i, one))), load[i]);
    }}
  }}

  // The next corners in place of the loads found: along p = force - slip / K, or as the present ones if their box has p.
  static void find_corners(const Bounded& B, const Mask (&turns)[bounded], const T (&turned)[bounded],
                           const T (&now)[bounded], const T (&corner)[bounded], T (&found)[bounded]) {{
    T p[bounded], next[bounded];
    for (int i = 0; i < bounded; ++i) {{
      T slip = -B.c[i];
      for (int j = 0; j < bounded; ++j) slip = slip + entry(B.S, i, j) * now[j];
      p[i] = now[i] + turned[i] - slip * inverse(most_in_cone(i, B.K));
    }}
    for (int i = 0; i < bounded; ++i) {{
      const T bound = B.high[i] + turned[i] + B.by_high[i] * found[i];
      const T to_bound = bound * inverse(size_in_cone(i, corner));
      Mask stays = T(0) < T(1);
      for (int k = 0; k < bounded; ++k)
        if (cone_of[k] == cone_of[i]) stays = stays && magnitude(p[k]) <= to_bound * magnitude(corner[k]);
      next[i] = select(stays, to_bound * corner[i], bound * inverse(size_in_cone(i, p)) * p[i]);
    }}
    for (int i = 0; i < bounded; ++i)
      if (cone_of[i] >= 0) found[i] = select(turns[i], next[i], found[i]);
  }}
)";

// turns: whose corners are to be found; turned: impulses so far, which count in the size of the force; share:
// directions of the last solution.
inline constexpr const char* parameters_of_cones =
    "const Mask (&turns)[bounded], const T (&turned)[bounded], T (&share)[bounded], ";
inline constexpr const char* all_turn = R"(    Mask turns[bounded];
    for (int i = 0; i < bounded; ++i) turns[i] = T(cone_of[i]) > T(-0.5);
)";
inline constexpr const char* none_turned = "    T turned[bounded] = {};\n";

inline constexpr const char* begins_corners = R"(    T carried[bounded];
    begin_corners(B, turns, turned, share, load);
)";
inline constexpr const char* bounds_corners = R"(      for (int i = 0; i < bounded; ++i) {
        const T most = magnitude(load[i]);
        B.low[i] = select(turns[i], -most - turned[i], B.low[i]), B.high[i] = select(turns[i], most - turned[i], B.high[i]);
      }
)";

// The loads of cones are those of whole forces.
inline constexpr const char* carries_for_cones = R"(      T of_cones[bounded];
      for (int i = 0; i < bounded; ++i) whole[i] = force[i] + turned[i];
      carry($pq, time, {}whole, of_cones);
      for (int i = 0; i < bounded; ++i) found[i] = cone_of[i] < 0 ? found[i] : of_cones[i];
)";
inline constexpr const char* finds_corners =
    R"(      for (int i = 0; i < bounded; ++i) carried[i] = select(busy, found[i], carried[i]);
      find_corners(plain, turns, turned, now, load, found);
)";

// Cones of bodies with several contacts stick and slip by turns, which misleads Broyden's method: after some rounds
// they take each solution as it is.
inline constexpr const char* unless_plain = " && round < 2 * careful_rounds";
inline constexpr const char* lengthens = "T(round < some_rounds ? 1 : 0.5)";
inline constexpr const char* enough_of_corners =
    "round < some_rounds       ? T(single ? 1e-3 : 1e-9)\n"
    "                       : round < 2 * some_rounds ? T(single ? 1e-2 : 1e-6)\n"
    "                                                 : T(single ? 1e-2 : 1e-4)";
inline constexpr const char* moves_corners = R"(      const Mask more = busy && worst > enough * largest(found);
      for (int i = 0; i < bounded; ++i) {
        if (cone_of[i] < 0) continue;
        const T size = size_in_cone(i, found);
        share[i] = select(turns[i] && busy && !more && size > T(0), found[i] * inverse(size), share[i]);
      }
      busy = more;
      change_loads(search, round, busy, turns, change, found, load);)";
inline constexpr const char* ends_corners =
    "    for (int i = 0; i < bounded; ++i) load[i] = select(turns[i], carried[i], load[i]);\n";

// By Runge-Kutta methods rows of a cone are held (0), or they slip (1): their force has the size of its bound and the
// direction against the slip. runtime/solve/cones.hpp tells why it does so by a slip that was noted: State::share.
inline constexpr const char* aims_cones = R"(
  // Bounds of cones that slip, along the directions of their forces. Along the noted slip of speed s a slip counts as at
  // least s / 100; and as the slowest one that steps of h can brake.
  static void aim_cones(const T (&missing)[bounded], const T (&share)[bounded], const T (&force)[bounded], const T& h,
                        const Mask (&slips)[bounded], Bounded& B) {
    T aimed[bounded];
    for (int i = 0; i < bounded; ++i) {
      const T s = size_in_cone(i, share), along = in_cone(i, missing, share) * inverse(s);
      const T least = T(0.5) * h * most_in_cone(i, B.K) * size_in_cone(i, force) - size_in_cone(i, missing);
      aimed[i] = missing[i] + larger(T(0), larger(T(0.01) * s - along, least)) * inverse(s) * share[i];
    }
    for (int i = 0; i < bounded; ++i) {
      if (cone_of[i] < 0) continue;
      const T part = aimed[i] * inverse(size_in_cone(i, aimed));
      B.high[i] = select(slips[i], part * B.high[i], B.high[i]), B.low[i] = select(slips[i], B.high[i], B.low[i]);
      B.by_high[i] = select(slips[i], part * B.by_high[i], B.by_high[i]);
      B.by_low[i] = select(slips[i], B.by_high[i], B.by_low[i]);
    }
  }
)";

// In pull(), which reads the sizes of forces as the last stage has found them, as that of another trial of the step.
inline constexpr const char* aims_at_stage = R"(    Guards G;
    Mask slips[bounded], turns[bounded];
    guard($pq, time, v, G);
    for (int e = 0; e < bounded; ++e) slips[e] = T(cone_of[e]) > T(-0.5) && hold[e] > T(0.5), turns[e] = T(1) < T(0);
    aim_cones(G.missing, share, force, step, slips, B);
    T turned[bounded] = {}, none[bounded] = {};
)";

// Before forces decide: rows that are slow or have stopped may hold.
inline constexpr const char* offers_cones = R"(    Mask slips[bounded], turns[bounded];
    T turned[bounded] = {};
    for (int i = 0; i < bounded; ++i) {
      Mask slow = size_in_cone(i, G.missing) <= T(single ? 4 : 1e3) * most_in_cone(i, s.modes.of_rate);
      for (int k = 0; k < bounded; ++k)
        if (cone_of[k] == cone_of[i]) slow = slow || stopped[k];
      turns[i] = slow && T(cone_of[i]) > T(-0.5), slips[i] = !slow && T(cone_of[i]) > T(-0.5);
      s.share[i] = select(slips[i], G.missing[i], s.share[i]);
      const Mask both = turns[i] || slips[i];
      B.low[i] = select(both, G.low[i], B.low[i]), B.high[i] = select(both, G.high[i], B.high[i]);
      B.by_low[i] = select(both, G.by_low[i], B.by_low[i]), B.by_high[i] = select(both, G.by_high[i], B.by_high[i]);
    }
    aim_cones(G.missing, s.share, s.modes.force, s.modes.step, slips, B);
)";
// After they have: those whose force has reached its bound slip.
inline constexpr const char* decides_cones = R"(    for (int i = 0; i < bounded; ++i) {
      if (cone_of[i] < 0) continue;
      const T bound = G.high[i] + G.by_high[i] * s.modes.load[i];
      const Mask reached = size_in_cone(i, force) >= T(single ? 1 - 1e-4 : 1 - 1e-9) * bound && !jams;
      const T slowest = T(single ? 4 : 1e3) * most_in_cone(i, s.modes.of_rate);
      s.share[i] = select(turns[i] && reached, slowest * s.share[i], s.share[i]);
      s.hold[i] = select(turns[i] && !reached, T(0), T(1));
    }
    for (int i = 0; i < bounded; ++i) s.modes.force[i] = force[i];
)";

// Held, how far the force is from its bound; else how far the speed along the noted slip is from a hundredth and from a
// hundred times that of it.
inline constexpr const char* margins_of_cones = R"(    for (int i = 0; i < bounded; ++i) {
      if (cone_of[i] < 0) continue;
      const T size = size_in_cone(i, m.force), s_noted = size_in_cone(i, s.share);
      const T along = in_cone(i, G.missing, s.share) * inverse(s_noted);
      const T held = (G.high[i] - size) / (most_in_cone(i, m.of_force) + T(single ? 1e-4 : 1e-9) * size);
      const T slips = smaller(along - T(0.01) * s_noted, T(100) * s_noted - along) / most_in_cone(i, m.of_rate);
      const T margin = select(s.hold[i] < T(0.5), held, select(G.high[i] > T(0), slips, T(1e30)));
      m.margin[i] = smaller(margin, T(1e30));
    }
)";

}  // namespace cdot::compile
