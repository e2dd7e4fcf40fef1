#include "derive/compile/steps.hpp"

#include <fmt/format.h>

#include "runtime/step/runge_kutta_tables.hpp"

namespace cdot::compile {
namespace {

constexpr const char* euler = R"(
  // Symplectic Euler: velocities with the joints' impulses, then poses, then C = 0 and J v = -dC/dt.
  static T step(State& s, T h = T(default_step)) {
    push(s.v, h);
    T b[rows];
    rates(s.J, s.v, b);
    for (T& of_row : b) of_row = -of_row;
    Velocity d[bodies];
    solve(s.J, b, s.lambda, d);
    const T left = s.residual;
    Evaluated at;
    at.time = s.time;
    for (int i = 0; i < bodies; ++i) {
      at.q[i] = s.q[i];
      s.v[i] = s.v[i] + d[i];
      s.q[i] = moved(s.q[i], h * s.v[i]);
    }
    turn(s.q);
    s.time = s.time + h;
    Velocity moves[bodies];
    const T error = close(s, at, T(0.2), moves);
    // A displacement beyond the motion of the step, or of an error older than it, would add energy.
    const auto keep = left <= T(0.1) * error && T(4) * weighed(moves) <= h * h * weighed(s.v);
    for (int i = 0; i < bodies; ++i) s.v[i] = s.v[i] + select(keep, T(1) / h, T(0)) * moves[i];
    evaluate(s.q, s.time, s.J);
    project(s);
    return s.residual;
  }
)";

constexpr const char* stages_begin = R"(
  // {0}, on accelerations; then C = 0 and J v = -dC/dt. The end's accelerations begin the next step.
  static T step(State& s, T h = T(default_step)) {{
    Slope k[{1}][bodies];
    Evaluated at;
    Velocity v[bodies];
    T forces[rows];
    for (int i = 0; i < bodies; ++i) k[0][i] = {{s.v[i], s.a[i]}};
)";

constexpr const char* stages_end = R"(    for (int i = 0; i < bodies; ++i) {{
      const Slope k_end = {0};
      s.q[i] = moved(s.q[i], h * k_end.v);
      s.v[i] = s.v[i] + h * k_end.a;
    }}
    turn(s.q);
    s.time = s.time + h;
    Velocity moves[bodies];
    close(s, at, T(0.5), moves);
    evaluate(s.q, s.time, s.J);
    project(s);
    accelerate(s.q, s.v, s.time, s.J, s.lambda, s.a);
    return s.residual;
  }}
)";

template <class Method>
std::string combined(const Method& method, int stage) {
  std::string sum;
  for (int j = 0; j < std::min(stage, method.stages); ++j) {
    const double weight = method.a[stage][j];
    if (weight == 0) continue;
    const char* sign = sum.empty() ? (weight < 0 ? "-" : "") : weight < 0 ? " - " : " + ";
    sum += fmt::format("{}T({}) * k[{}][i]", sign, std::abs(weight), j);
  }
  return sum;
}

template <class Method>
std::string runge_kutta(const Method& method, const char* title) {
  std::string text = fmt::format(stages_begin, title, method.stages);
  for (int stage = 1; stage < method.stages; ++stage) {
    text += "    for (int i = 0; i < bodies; ++i) {\n";
    text += fmt::format("      const Slope now = {};\n", combined(method, stage));
    text += "      at.q[i] = moved(s.q[i], h * now.v);\n      v[i] = s.v[i] + h * now.a;\n    }\n";
    text += fmt::format("    at.time = s.time + T({}) * h;\n", double(method.c[stage]));
    text += fmt::format("    slope(at, v, s.J, forces, k[{}]);\n", stage);
  }
  return text + fmt::format(stages_end, combined(method, method.stages));
}

}  // namespace

std::string step_of(Method method) {
  if (method == Method::euler) return euler;
  if (method == Method::rk4) return runge_kutta(rk4<double>, "The Runge-Kutta method of order 4");
  return runge_kutta(dop853<double>, "Dormand and Prince's method of order 8");
}

}  // namespace cdot::compile
