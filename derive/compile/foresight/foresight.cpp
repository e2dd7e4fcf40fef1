#include "derive/compile/foresight/foresight.hpp"

#include <fmt/format.h>

namespace cdot::compile {
namespace {

constexpr const char* solves_either = R"(
  CDOT_SCENE_INLINE static void solve($gconst Jacobian& J, const Aim& B, const Mask& aimed, const T (&b)[rows],
                                      T (&lambda)[rows], Velocity (&d)[bodies]) {
    if (!any(aimed)) return solve($tJ, b, lambda, d);
    solve($tJ, B, b, lambda, d);
    if (!any(!aimed)) return;
    T of_others[rows];
    Velocity others[bodies];
    solve($tJ, b, of_others, others);
    for (int i = 0; i < rows; ++i) lambda[i] = select(aimed, lambda[i], of_others[i]);
    for (int i = 0; i < bodies; ++i) d[i] = choose(aimed, d[i], others[i]);
  }
)";

// Loops that compilers make wide: their numbers are read as wide as the last step stored them.
constexpr const char* foresees = R"(
  // Numbers that continue the last ones as a polynomial, in units: the sum of their differences.
  static void foresee(const State& s, const T& unit, T (&lambda)[{7}]) {{
    T sum[{7}];
    const T in_units = unit;
    if (any(s.known < T({0}.5))) {{
      for (int i = 0; i < {7}; ++i) sum[i] = {1};
    }} else {{
      for (int i = 0; i < {7}; ++i) sum[i] = {2};
    }}
    for (int i = 0; i < {7}; ++i) lambda[i] = in_units * sum[i];
  }}
  static void append(const T& d_0{4}) {{
    const T {5};
    {6};
  }}
  // The ones found instead. Where they were not much better foreseen than by the last ones, a series begins; not if
  // `well`, when all were foreseen almost to the goal.
  static void remember(State& s, const Mask& fits, const Mask& well, const T& unit, const T (&found)[{7}],
                       const T (&foreseen)[{7}]) {{
    T now[{7}];
    const T rate = T(1) / unit;
    for (int i = 0; i < {7}; ++i) now[i] = rate * found[i];
    auto goes_on = fits && (well || s.known < T(1.5));
    if (any(!goes_on)) {{
      T misses[{7}], changes[{7}];
      for (int i = 0; i < {7}; ++i) misses[i] = now[i] - rate * foreseen[i];
      for (int i = 0; i < {7}; ++i) changes[i] = now[i] - s.past[0].of[i];
      goes_on = goes_on || (fits && T(2) * largest(misses) < largest(changes));
    }}
    for (int i = 0; i < {7}; ++i) append(now[i]{3});
    s.known = select(goes_on, select(s.known < T({0}.5), s.known + T(1), s.known), T(1));
  }}
)";

// Rounds on K leave a share of the error, by which J has turned since the start of the step. Where two more of them
// would leave {2} (worst / {2})^2 > {1}, J' M^-1 J^T with J' of the pose is exact to the size of the move. The first
// round tells the share; where the last step told that three rounds would not do, it aims.
constexpr const char* aiming = R"(      if (round < 8) {{
        const Mask newly = round == 0 ? goes_on && {0} && worst * s.share * s.share * s.share > {1}
                                      : goes_on{3} && worst * worst * worst > {1} * {2} * {2};
        if (round == 1) s.share = select(goes_on && !aimed && {2} < T(1e29), worst / {2}, s.share);
        if (any(newly) && !any(aimed)) {{
          aim($ss.q, s.time, s.J, B);
        }} else if (any(newly)) {{
          Aim now;
          aim($ss.q, s.time, s.J, now);
          T* const numbers = reinterpret_cast<T*>(&B);
          const T* const others = reinterpret_cast<const T*>(&now);
          for (unsigned i = 0; i < sizeof B / sizeof(T); ++i) numbers[i] = select(newly, others[i], numbers[i]);
        }}
        aimed = aimed || newly;
      }}
)";

}  // namespace

std::vector<FunctionText> functions_of_foresight(const derive::Program& apply, const derive::Program& aim,
                                                 const derive::Program& solve_aimed) {
  if (apply.outputs.empty()) return {};
  return {{"d = M^-1 J^T lambda", "apply($gconst Jacobian& J, const T (&lambda)[rows], Velocity (&d)[bodies])", &apply},
          {"The factor of J' M^-1 J^T with J' of the pose",
           "aim($dconst Pose (&q)[bodies], const T& time, const Jacobian& J, Aim& B)", &aim},
          {"J' M^-1 J^T lambda = b, d = M^-1 J^T lambda",
           "solve($gconst Jacobian& J, const Aim& B, const T (&b)[rows], T (&lambda)[rows], Velocity (&d)[bodies])",
           &solve_aimed}};
}

// As long as the step is the same, multipliers are a smooth series. Its next number, by a polynomial through the last k
// ones, is the sum of their backward differences of the orders 0 to k - 1.
std::string foresight_of(const std::string& numbers, int count) {
  std::string known, all, differences, stores;
  for (int k = count; k-- > 0;) {
    const std::string d = fmt::format("s.past[{}].of[i]", k),
                      known_d = fmt::format("select(s.known > T({}.5), {}, T(0))", k, d);
    all = all.empty() ? d : fmt::format("{} + ({})", d, all);
    known = known.empty() ? known_d : fmt::format("{} + ({})", known_d, known);
  }
  std::string places, members;
  for (int k = 0; k < count; ++k) {
    places += fmt::format(", s.past[{}].of[i]", k), members += fmt::format(", T& past_{}", k);
    stores += fmt::format("{0}past_{1} = d_{1}", k == 0 ? "" : ", ", k);
    if (k > 0) differences += fmt::format("{0}d_{1} = d_{2} - past_{2}", k == 1 ? "" : ", ", k, k - 1);
  }
  return fmt::format(foresees, count - 1, known, all, places, members, differences, stores, numbers);
}

std::string foresight(bool rattle) { return solves_either + foresight_of("rows", foreseen_by(rattle)); }

// In the plane sines come from their angles, so that no round-off gathers over the steps.
std::string moves_as_foreseen(bool spatial) {
  return std::string(spatial
                         ? "    shift(s.q, moves);\n"
                         : "    for (int i = 0; i < bodies; ++i) move(s.q[i], s.q[i], moves[i]);\n    turn(s.q);\n") +
         "    Aim B;\n    Mask aimed = T(1) < T(0);\n";
}

// In space the way of the rounds counts for large angles, which are not foreseen: they take those of the World.
std::string aims(bool spatial) {
  return fmt::format(aiming, "foreseen", "goal", "before", spatial ? " && !is_slow && foreseen" : " && !is_slow") +
         "      aimed = aimed && !renews;\n";
}

std::string drift_aims() { return fmt::format(aiming, "by_series", "fine", "last", "") + "      last = worst;\n"; }

}  // namespace cdot::compile
