#include "derive/compile/foresight/foresight.hpp"

#include <fmt/format.h>

namespace cdot::compile {
namespace {

constexpr const char* solves_either = R"(
  static void solve($gconst Jacobian& J, const Aim& B, const Mask& aimed, const T (&b)[rows], T (&lambda)[rows],
                    Velocity (&d)[bodies]) {
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

// Loops: no numbers that were stored just before wait for them.
constexpr const char* foresees = R"(
  // Multipliers that continue the last ones as a polynomial, in units.
  static void foresee(const State& s, const T& unit, T (&lambda)[rows]) {{
    T weight[{0}];
    weight[0] = s.known;
{1}    for (int i = 0; i < rows; ++i) lambda[i] = unit * ({2});
  }}
  // The ones found instead. Where they were not much better foreseen than by the last ones, a series begins.
  static void remember(State& s, const Mask& fits, const T& unit, const T (&found)[rows], const T (&foreseen)[rows]) {{
    Multipliers misses, changes, last;
    const T rate = T(1) / unit;
    for (int i = 0; i < rows; ++i) last.of[i] = rate * found[i];
    for (int i = 0; i < rows; ++i) misses.of[i] = last.of[i] - rate * foreseen[i];
    for (int i = 0; i < rows; ++i) changes.of[i] = last.of[i] - s.past[0].of[i];
    for (int k = {3}; k > 0; --k) s.past[k] = s.past[k - 1];
    s.past[0] = last;
    const auto goes_on = fits && (s.known < T(1.5) || T(2) * largest(misses.of) < largest(changes.of));
    s.known = select(goes_on, select(s.known < T({3}.5), s.known + T(1), s.known), T(1));
  }}
)";

// Rounds on K leave a share of the error, by which J has turned since the start of the step. Where two more of them
// would leave worst (worst / before)^2 > goal, J' M^-1 J^T with J' of the pose is exact to the size of the move.
constexpr const char* aiming = R"(      if (round == 1) {{
        aimed = goes_on && !is_slow &&{} worst * worst * worst > goal * before * before;
        if (any(aimed)) aim($ss.q, s.time, s.J, B);
      }}
      aimed = aimed && !renews;
)";

}  // namespace

// As long as the step is the same, multipliers are a smooth series. The binomial coefficients extrapolate its last k
// numbers by a polynomial: sum over j of (-1)^j (k over j + 1) past[j].
std::string foresight(bool rattle) {
  const int count = foreseen_by(rattle);
  std::string weights, sum = "weight[0] * s.past[0].of[i]";
  for (int j = 1; j < count; ++j) {
    weights += fmt::format("    weight[{0}] = T(-1.0 / {2}) * (s.known - T({0})) * weight[{1}];\n", j, j - 1, j + 1);
    sum += fmt::format(" + weight[{0}] * s.past[{0}].of[i]", j);
  }
  return solves_either + fmt::format(foresees, count, weights, sum, count - 1);
}

// In space the way of the rounds counts for large angles, which are not foreseen: they take those of the World.
std::string aims(bool spatial) { return fmt::format(aiming, spatial ? " foreseen &&" : ""); }

}  // namespace cdot::compile
