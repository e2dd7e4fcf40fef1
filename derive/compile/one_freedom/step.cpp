#include "derive/compile/one_freedom/step.hpp"

#include <fmt/format.h>

#include "derive/compile/foresight/foresight.hpp"

namespace cdot::compile {
namespace {

constexpr int series = foreseen_by(false);

constexpr const char* step_begins = R"(
  // By d itself: after many turns an angle has a coarse last place.
  static void turn_exactly(Pose& q, const T& d) {{
    const T s_0 = q.s, c_0 = q.c;
    q.angle = q.angle + d;
    sin_cos_beside<true>(s_0, c_0, d, q.angle, q.s, q.c);
  }}

  // Symplectic Euler of a mechanism of one freedom, in the angles at which its loops close: velocities with the joints'
  // impulses, then poses, then C = 0 and J v = 0. Where J turned so far that rounds on K renew it: on the rows.
  static T step(State& s, T h = T(default_step)) {{
    const T goal = T(single ? 1e7 * {0} : {0});
    Pose q[bodies];
    Velocity v[bodies], next[bodies], d[bodies], free[bodies], moves[bodies];
    for (int i = 0; i < bodies; ++i) v[i] = s.v[i];
    push(v, h);
    go_along($ss.F, v, next);
    for (int i = 0; i < bodies; ++i) d[i] = next[i] - v[i];
    T lambda[rows], foreseen[angles_kept], found[angles_kept], missed[angles_kept];
    find_impulses($ss.q, s.F, d, lambda);
    for (int i = 0; i < bodies; ++i) q[i] = s.q[i];
    for (int i = 0; i < bodies; ++i) move(q[i], q[i], h * next[i]);
    for (int i = 0; i < bodies; ++i) free[i] = {{q[i].x, q[i].y, q[i].angle}};
    foresee(s, h * h, foreseen);
{1}    turn(q);
    Mask goes_on = T(0) < T(1);
    T off, share = T(0), of_loops = T(0), first = T(0);
    for (int round = 0;; ++round) {{
      place($ss.F, free, found, q, moves, missed, off);
      of_loops = {2};
      if (round == 0) first = of_loops;
      else goes_on = goes_on && (of_loops > goal || off > goal * goal);
      if (!any(goes_on) || round == 8) break;
      T turns[angles_kept], left;
      aim_angles($sq, s.F, missed, turns, left);
      share = select(goes_on, left, share);
{3}    }}
    // Where the last step ended at C = 0, Newton has found both, and rounds on K would not renew J: from 1/5 on.
    const Mask fits = s.residual <= T(10) * goal && !goes_on && of_loops <= goal && share <= T(0.0361);
    State other;
    if (any(!fits)) {{
      other = s;
      step_by_rows(other, h);
      other.known = T(0);
      find_tangent($sother.q, other.F);
    }}
    remember(s, fits, first <= T(1e3) * goal, h * h, found, foreseen);
    // A displacement beyond the motion of the step would add energy.
    const auto keep = T(4) * weighed(q, moves) <= h * h * weighed(q, next);
    for (int i = 0; i < bodies; ++i) v[i] = next[i] + select(keep, T(1) / h, T(0)) * moves[i];
    s.time = s.time + h;
    s.residual = of_loops;
    for (int i = 0; i < rows; ++i) s.lambda[i] = lambda[i];
    for (int i = 0; i < bodies; ++i) s.q[i] = q[i];
    find_tangent($ss.q, s.F);
    go_along($ss.F, v, s.v);
    if (any(!fits)) replace(s, other, !fits);
    return s.residual;
  }}
)";

}  // namespace

std::vector<FunctionText> functions_of_freedom(const FreedomPrograms& f) {
  if (!f.exists()) return {};
  const std::string poses = "$dconst Pose (&q)[bodies], ", of_freedom = "const Freedom& F, ";
  return {
      {"t of the velocities that the joints allow, w = 1 / (t^T M t), and A^-1",
       "find_tangent(" + poses + "Freedom& F)", &f.find_tangent},
      {"t w t^T M v", "go_along($d" + of_freedom + "const Velocity (&v)[bodies], Velocity (&next)[bodies])",
       &f.go_along},
      {"M d = J^T lambda", "find_impulses(" + poses + of_freedom + "const Velocity (&d)[bodies], T (&lambda)[rows])",
       &f.find_impulses},
      {"The poses at the angles, how far they are from the free ones, and how far they miss c = 0 and "
       "w t^T M (q - q_free) = 0",
       "place($d" + of_freedom +
           "const Velocity (&free)[bodies], const T (&found)[angles_kept], Pose (&q)[bodies], Velocity "
           "(&moves)[bodies], T (&missed)[angles_kept], "
           "T& off)",
       &f.place},
      {"A step of Newton's method, and the square of the share of an error that one with A of the start would leave",
       "aim_angles(" + poses + of_freedom + "const T (&missed)[angles_kept], T (&turn)[angles_kept], T& share)",
       &f.aim_angles}};
}

long operations_of_freedom(const FreedomPrograms& f) {
  long sum = 0;
  for (const auto& [times, program] :
       {std::pair{1, &f.find_tangent}, {2, &f.go_along}, {1, &f.find_impulses}, {2, &f.place}, {1, &f.aim_angles}})
    sum += times * derive::count(*program).total();
  return sum;
}

long numbers_of_freedom(const FreedomPrograms& f) {
  return f.exists() ? long(f.stored.size()) + series * long(f.angles.size()) + 1 : 0;
}

std::string state_of_freedom() {
  return fmt::format(
      "    Excess past[{}];  // of the last corrections, by the step's square, and their differences\n"
      "    T known;         // so many of them form a series\n"
      "    Freedom F;       // of the poses q\n",
      series);
}

std::string types_of_freedom(const FreedomPrograms& freedom) {
  std::string text =
      fmt::format("  static constexpr int angles_kept = {};  // in which the mechanism steps\n", freedom.angles.size());
  text +=
      "  // The direction t of all velocities, w = 1 / (t^T M t), and the inverse of A = (c'; w t^T M E).\n"
      "  struct Freedom {\n";
  for (const std::string& member : freedom.stored) text += "    T " + member + ";\n";
  return text + "  };\n  struct Excess {  // of angles, over their free motion\n    T of[angles_kept];\n  };\n";
}

std::string step_of_freedom(const FreedomPrograms& freedom, double tolerance) {
  std::string foreseen, errors = "T(0)", turns;
  for (std::size_t k = 0; k < freedom.angles.size(); ++k) {
    const std::string& body = freedom.angles[k];
    foreseen += fmt::format("    found[{1}] = foreseen[{1}], q[{0}].angle = q[{0}].angle + found[{1}];\n", body, k);
    if (k + 1 < freedom.angles.size())
      errors = k == 0 ? "magnitude(missed[0])" : fmt::format("larger({}, magnitude(missed[{}]))", errors, k);
    turns += fmt::format("      d[{0}].w = select(goes_on, turns[{1}], T(0)), found[{1}] = found[{1}] + d[{0}].w;\n",
                         body, k);
  }
  for (const std::string& body : freedom.angles) turns += fmt::format("      turn_exactly(q[{0}], d[{0}].w);\n", body);
  return foresight_of("angles_kept", series) + fmt::format(step_begins, tolerance, foreseen, errors, turns);
}

}  // namespace cdot::compile
