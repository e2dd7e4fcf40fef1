#include "derive/compile/midpoint/tension.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace cdot::compile {

std::string impulses_of(const Contents& has) {
  return std::string(has.rows ? "const T (&lambda)[rows], " : "") + (has.bounded ? "const T (&mu)[bounded], " : "");
}

std::string taut_type(std::size_t rows, std::size_t numbers) {
  return fmt::format(
      "  // Rows of the stiffness of tension between bodies, and this stiffness along each.\n"
      "  struct Taut {{\n    T w[{}], d[{}];\n  }};\n",
      numbers, rows);
}

std::string stiffen_of(const Mechanism& mechanism, const std::vector<std::string>& names, const Contents& has) {
  const bool turning = std::ranges::any_of(mechanism.bodies, &Body::inertia_turns);
  std::string text =
      fmt::format(R"(
  // Inverse inertias with the stiffness of tension in a step of h.
  static void stiffen($dconst Pose (&q)[bodies], const T& time, {}const T& h, {}Tensor<T> (&W)[bodies]{}) {{
    tension($pq, time, {}W{});
    (void)h;
)",
                  turning ? "const Gyroscope* g, " : "", impulses_of(has), has.taut ? ", Taut& N" : "",
                  std::string(has.rows ? "lambda, " : "") + (has.bounded ? "mu, " : ""), has.taut ? ", N" : "");
  int count = 0;
  for (std::size_t b = 0; b < names.size(); ++b) {
    const Body& body = mechanism.bodies[b];
    if (!body.turns()) continue;
    const double I = body.inv_I > 0 ? 1 / body.inv_I : 0;
    const std::string own = body.inertia_turns
                                ? fmt::format("g[{}].I", count++)
                                : fmt::format("Tensor<T>{{T({0}), T({0}), T({0}), T(0), T(0), T(0)}}", I);
    text += fmt::format("    W[{0}] = stiffened({1}, T(0.25) * h, W[{0}]);\n", names[b], own);
  }
  return text + "  }\n";
}

}  // namespace cdot::compile
