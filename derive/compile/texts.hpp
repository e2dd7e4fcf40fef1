// The head of a header, and members of its struct that do not depend on the scene.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "derive/compile/scene/mechanism.hpp"

namespace cdot::compile {

// The head of the header: comments, includes, and the parts that are the same in all of them.
std::string head_of(const Mechanism& mechanism, const std::string& command, bool with_cmath);

struct Counts {
  std::size_t bodies, rows, rates, centres, angles;  // rates and centres: of a slope, SlopeSize
};
// Loops over the numbers of a slope of a Runge-Kutta method are lines up to so many.
constexpr std::size_t few_rates = 24;
// Solves of up to so many operations are inlined.
constexpr int few_operations = 300;
// The text with a line for each body, row or rate in place of a line "for (int i = 0; i < bodies; ++i) …;", where there
// are few. The wide loads of a compiler's vector loop would wait for the stores of single numbers before them.
std::string unrolled(const std::string& text, const Counts& counts);

// Lines for things of one kind, four at a time where numbers have wide ones: in `four`, {0} to {3} are their names and
// {4} lists them; {5} lists their numbers. In `one`, {0} is a name and {1} its number. Three stand for four, if one of
// them is named twice.
struct Named {
  std::string name;
  int number;
};
std::string by_fours(const std::vector<Named>& things, const std::string& four, const std::string& one);

// Functions take the inputs, the angles, events and bonds: "$d" declares them, "$s" passes those of a State, "$p" those
// of the caller; "$C" counts the turns of the angles. Functions that weigh take poses where inertias turn: "$g"
// declares them, "$q" passes those of a State, "$t" those of the caller. Poses get their inertias by "$w" at a stage,
// by "$W" at the end of a step.
struct Arguments {
  bool inputs, angles, events, bonds, turns;
  std::string poses;  // a declaration
};
std::string with_arguments(std::string text, const Arguments& given);
// True if a function has the argument, as a constant if it is an array: "const T (&C)[rows]", "const T& h".
bool reads(const std::string& arguments, const std::string& argument);

inline constexpr const char* guards = R"(
  static constexpr bool single = sizeof(typename NumberOf<T>::type) == 4;
  static constexpr bool is_pack = sizeof(T) != sizeof(typename NumberOf<T>::type);
  static constexpr double epsilon = single ? 1.1920929e-07 : 2.220446049250313e-16;
  template <class>
  static T smallest() {
    return T(single ? 1.17549435e-38 : 2.2250738585072014e-308);
  }
  // 1/x, and 0 at x = 0.
  static T inverse(const T& x) { return select(magnitude(x) >= smallest<T>(), T(1) / x, T(0)); }
  static T sign(const T& x) { return select(x > T(0), T(1), select(x < T(0), T(-1), T(0))); }
  // 1/d, and 0 where d is round-off beside the diagonal entry k: the row depends on others.
  static T pivot(const T& d, const T& k) { return select(d > T(64 * epsilon) * k, T(1) / d, T(0)); }
)";

inline constexpr const char* slope = R"(
  // The rates of change at a stage of a Runge-Kutta method, whose poses are turned.
  static void slope($dEvaluated& at, const Velocity (&v)[bodies], Jacobian& J, T (&forces)[rows], Slope& k) {
$w    evaluate($pat.q, at.time, J);
    Velocity a[bodies];
    accelerate($pat.q, at.time, v, J, forces, a);
    for (int i = 0; i < bodies; ++i) k.set(i, rate_of(at.q[i], v[i]), a[i]);
  }
)";

// Without joints.
inline constexpr const char* free_slope = R"(
  // The rates of change at a stage of a Runge-Kutta method, whose poses are turned.
  static void slope($dEvaluated& at, const Velocity (&v)[bodies], Slope& k) {
$w    Velocity a[bodies];
    fall($pat.q, at.time, v, a);
    for (int i = 0; i < bodies; ++i) k.set(i, rate_of(at.q[i], v[i]), a[i]);
  }
)";

}  // namespace cdot::compile
