#include "runtime/tool/import/coupling.hpp"

#include <fmt/format.h>

namespace cdot {
namespace {

// The parameters f1, g1 of a hinge and u1, p1, s1 of a slider; the coordinate q1, and its number x1 in the model.
std::string declared(const CoupledCoordinate& q, int k) {
  const std::string start = q.start == 0 ? "" : fmt::format(" + {}", q.start);
  if (q.turns)
    return fmt::format(
        "  frame  f{0} on {1}\n"
        "  frame  g{0} on {2} = f{0}\n"
        "  scalar q{0}_turns [rad] = 0\n"
        "  coordinate q{0} [rad] = twist(f{0}, g{0})\n"
        "  let x{0} = (twist(f{0}, g{0}) + q{0}_turns)/(1 [rad]){3}\n",
        k, q.above, q.below, start);
  return fmt::format(
      "  unit   u{0} on {1}\n"
      "  point  p{0} on {1}\n"
      "  point  s{0} on {2}\n"
      "  coordinate q{0} [m] = dot(s{0} - p{0}, u{0})\n"
      "  let x{0} = dot(s{0} - p{0}, u{0})/(1 [m]){3}\n",
      k, q.above, q.below, start);
}

}  // namespace

std::string coupling_spec(const std::string& name, const CoupledCoordinate& first,
                          const std::optional<CoupledCoordinate>& second, const std::vector<double>& c) {
  std::string text =
      fmt::format("joint {} spatial\n  \"The coordinate of a joint {}, as an <equality> of MJCF says.\"\n\n{}", name,
                  second ? "follows that of another one" : "stays", declared(first, 1));
  if (second) text += declared(*second, 2);
  std::string sum;
  for (std::size_t k = 0; k < c.size() && (k == 0 || second); ++k) {
    if (c[k] == 0) continue;
    sum += sum.empty() ? "" : " + ";
    if (k == 0 || c[k] != 1) sum += fmt::format("{}{}", c[k], k > 0 ? "*" : "");
    if (k > 0) sum += k > 1 ? fmt::format("x2^{}", k) : "x2";
  }
  if (sum.empty()) sum = "0";
  return text + fmt::format("\n  follows: x1 = {}\n", sum);
}

}  // namespace cdot
