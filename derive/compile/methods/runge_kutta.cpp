#include "derive/compile/methods/runge_kutta.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <vector>

#include "derive/compile/methods/modes.hpp"
#include "derive/compile/methods/strides.hpp"
#include "runtime/step/runge_kutta_tables.hpp"

namespace cdot::compile {
namespace {

constexpr const char* stages_begin = R"(
  // {0}, on accelerations{2}. The end's accelerations begin the next step.
  static T {4} {{
    Slope k[{1}], now;
    Evaluated at;
    Velocity v[bodies];
{3}    for (int i = 0; i < bodies; ++i) at.q[i] = s.q[i];
{5}    for (int i = 0; i < bodies; ++i) k[0].set(i, rate_of(s.q[i], s.v[i]), s.a[i]);
)";

constexpr const char* moves_at_stage = R"(    for (int i = 0; i < bodies; ++i) move(at.q[i], s.q[i], h * now.rate(i));
    for (int i = 0; i < bodies; ++i) v[i] = s.v[i] + h * now.acceleration(i);
)";
constexpr const char* turns_at_stage =
    "    for (int i = 0; i < bodies; ++i) now.turn(i, h, s.q[i], s.v[i], at.q[i], v[i]);\n";

constexpr const char* stages_end = R"({0}    for (int i = 0; i < bodies; ++i) move(s.q[i], s.q[i], h * now.rate(i{2}));
    for (int i = 0; i < bodies; ++i) s.v[i] = s.v[i] + h * now.acceleration(i);
{1}  }}
)";

constexpr const char* end_begins = R"(    turn(s.q);
    s.time = s.time + h;
)";

constexpr const char* ends_on_joints = R"(    Velocity moves[bodies];
    close(s, at, T(0.5), moves);
$W$C    evaluate($ss.q, s.time, s.J);
    project(s);
    accelerate($ss.q, s.time, s.v, s.J, s.lambda, s.a);
{}    return s.residual;
)";

constexpr const char* ends_in_modes = R"(    Velocity moves[bodies];
    close(s, at, T(0.5), moves);
$W$C{0}    project(s);
    pull($ss.q, s.time, s.v, {1});
    return larger(s.residual, find_margins(s));
)";

constexpr const char* ends_freely = R"($W$C    fall($ss.q, s.time, s.v, s.a);
{}    return T(0);
)";

// A list of the slopes that is summed, into one of the sum.
struct Summed {
  const char *size, *to, *of;
};

// Of few numbers, the last slope joins number by number: wide loads would wait for what has just been stored.
std::string combined(const std::vector<double>& weights, const Summed& list, bool few) {
  std::string sum, last;
  int count = 0;
  for (std::size_t j = 0; j < weights.size(); ++j) {
    const double weight = weights[j];
    if (weight == 0) continue;
    if (count++ > 0) sum += last;
    const char* sign = count == 1 ? (weight < 0 ? "-" : "") : weight < 0 ? " - " : " + ";
    last = fmt::format("{}T({}) * k[{}].{}[i]", sign, std::abs(weight), j, list.of);
  }
  const auto all = [&](const char* until, const std::string& terms) {
    return fmt::format("    for (int i = 0; i {} Slope::{}; ++i) now.{}[i] = {};\n", until, list.size, list.to, terms);
  };
  if (count < 3 || !few) return all("<", sum + last);
  return all("!=", sum) + all("<", fmt::format("now.{}[i]{}", list.to, last));
}

template <class Method>
std::vector<double> weights_of(const Method& method, int stage) {
  return {method.a[stage], method.a[stage] + std::min(stage, method.stages)};
}

// Centres of mass at the end: their velocities, and their way without that of the velocity at the start.
template <class Method>
std::string centres(const Method& method, bool few) {
  std::vector<double> b = weights_of(method, method.stages);
  const std::string of_velocity = combined(b, {"centres", "linear", "linear"}, few);
  for (std::size_t j = 0; j < b.size(); ++j) b[j] *= 1 - method.c[j];
  return of_velocity + combined(b, {"centres", "way", "linear"}, few);
}

template <class Method>
std::string explicit_stages(const Method& method, const char* title, const Contents& has, bool few) {
  std::string text = fmt::format(stages_begin, title, method.stages, has.rows ? "; then C = 0 and J v = -dC/dt" : "",
                                 has.rows ? "    T forces[rows];\n" : "", head_on_accelerations(has),
                                 has.apart ? "    for (int i = 0; i < bodies; ++i) v[i] = s.v[i];\n" : "");
  const char* const centre = has.apart ? ", s.v[i], h" : "";
  const auto sums = [&](int stage) { return combined(weights_of(method, stage), {"size", "of", "of"}, few); };
  for (int stage = 1; stage < method.stages; ++stage) {
    text += sums(stage);
    text += has.apart ? turns_at_stage : moves_at_stage;
    text += fmt::format("    at.time = s.time + T({}) * h;\n", double(method.c[stage]));
    text += has.spatial ? "    turn(at.q);\n" : "    turn(at.q, s.q);\n";
    text += fmt::format("    slope($sat, v, {}k[{}]);\n", arguments_of_slope(has), stage);
  }
  const std::string last = sums(method.stages) + (has.apart ? centres(method, few) : "");
  return text + fmt::format(stages_end, last, end_on_accelerations(has), centre) +
         (has.strides() ? step_by_events(has) : "");
}

}  // namespace

int stages_of(Method method) { return method == Method::rk4 ? rk4<double>.stages : dop853<double>.stages; }

std::string runge_kutta(Method method, const Contents& has, bool few) {
  if (method == Method::rk4) return explicit_stages(rk4<double>, "The Runge-Kutta method of order 4", has, few);
  return explicit_stages(dop853<double>, "Dormand and Prince's method of order 8", has, few);
}

std::string arguments_of_slope(const Contents& has) {
  const std::string held = !has.modes  ? ""
                           : has.cones ? "s.hold, s.share, s.modes.step, s.modes.force, s.modes.load, "
                           : has.loads ? "s.hold, s.modes.load, "
                                       : "s.hold, ";
  return (has.rows ? "s.J, forces, " : "") + held;
}

std::string end_on_accelerations(const Contents& has) {
  const std::string inertias =
      has.gyroscopes ? "    for (int i = 0; i < bodies; ++i) s.q[i].I = at.q[i].I;  // as J, of the last stage\n" : "";
  const char* const finds = has.snaps ? "    find_margins(s);\n" : "";
  const std::string end = has.modes  ? fmt::format(ends_in_modes, has.rows ? evaluates : "", arguments_of_pull(has))
                          : has.rows ? fmt::format(ends_on_joints, finds)
                                     : fmt::format(ends_freely, finds);
  return inertias + end_begins + end;
}

std::string head_on_accelerations(const Contents& has) {
  return has.strides() ? "stride(State& s, const T& h)" : std::string(step_head);
}

}  // namespace cdot::compile
