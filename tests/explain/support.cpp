#include "support.hpp"

using namespace cdot::derive;

std::vector<std::pair<std::string, std::string>> unusual_specs() {
  return {
      {"hinge_angle",
       "joint hinge_angle planar\n  \"The angle between two directions.\"\n"
       "  unit s on a\n  unit t on b\n  scalar phi [rad]\n  angle(s, t) = phi\n"},
      {"aim",
       "joint aim planar\n  \"A direction of a points at pb.\"\n"
       "  point pa on a\n  point pb on b\n  unit s on a\n  let u = pb - pa\n  angle(s, u) = 0\n"},
      {"functions",
       "joint functions planar\n  \"Every function once.\"\n"
       "  point pa on a\n  point pb on b\n  scalar l [m]\n  let u = pa - pb\n  let q = norm(u) / "
       "l\n"
       "  sqrt(q) + exp(q) - log(q) + tan(q / 4) + abs(cos(q)) + atan2(u.y, l) * q ^ 3 = 1\n"
       "  let half = unit(u) / 2\n  dot(half, x(a) - pb) + dot(perp(u), arm(pa)) / norm(u) = 0\n"},
      {"knife",
       "joint knife planar\n  \"A knife edge: no sideways velocity.\"\n"
       "  point pa on a\n  unit n on a\n  velocity dot(v(pa), n) = 0\n"},
      {"driven_slide",
       "joint driven_slide planar\n  \"A slide that swings in time.\"\n"
       "  point pa on a\n  point pb on b\n  unit t on b\n  scalar amplitude [m]\n  scalar rate "
       "[rad/s]\n"
       "  dot(t, pa - pb) = amplitude * sin(rate * time)\n"},
      {"towed",
       "joint towed planar\n  \"A point of a moves through the world at a given velocity.\"\n"
       "  point pa on a\n  point start on world\n  vector speed [m/s] on world\n"
       "  pa = start + time * speed\n"},
      {"direction_row",
       "joint direction_row planar\n  \"A vector row that no number multiplies: K in "
       "components.\"\n"
       "  point pa on a\n  point pb on b\n  unit t on b\n  unit(pa - pb) = t\n"}};
}

Joint read_text(const std::string& name, const std::string& text) {
  const auto file = std::make_shared<SourceFile>(name + ".joint", text);
  const ReadResult read = read_joint(file, {});
  if (!read.joint) throw std::runtime_error(render(*read.file, read.diagnostics));
  return *read.joint;
}
