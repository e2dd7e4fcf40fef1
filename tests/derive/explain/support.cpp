#include "support.hpp"

using namespace cdot::derive;

std::vector<std::pair<std::string, std::string>> unusual_specs() {
  return {{"hinge_angle",
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
           "  point pa on a\n  point pb on b\n  unit t on b\n  unit(pa - pb) = t\n"},
          {"hinge",
           "joint hinge spatial\n  \"A ball joint and parallel axes.\"\n"
           "  point pa on a\n  point pb on b = pa\n  frame fa on a\n  frame fb on b = fa\n"
           "  pin: pa = pb\n  parallel: cross(fa.x, fb.x) = 0 keep 2\n"
           "  coordinate angle = twist(fa, fb)\n"},
          {"angles",
           "joint angles spatial\n  \"A ball joint and further angles.\"\n"
           "  point pa on a\n  point pb on b = pa\n  frame fa on a\n  frame fb on b = fa\n"
           "  pin: pa = pb\n  coordinate tilt = swing(fa, fb)\n"
           "  coordinate bend = angle(fa.z, fb.y, fa.x)\n"},
          {"turned",
           "joint turned spatial\n  \"The same orientation.\"\n"
           "  frame fa on a\n  frame fb on b\n  rotation(fa, fb) = 0\n"},
          {"guided",
           "joint guided spatial\n  \"A rod, a guide and a ratio.\"\n"
           "  point pa on a\n  point pb on b\n  frame f on a\n  unit n on b\n  scalar l [m]\n"
           "  scalar ratio [1]\n  let d = pb - pa\n  norm(d) <= l\n  ratio * dot(d, f.x) = l\n"
           "  dot(unit(d), n) = 0\n  velocity dot(v(pa) - v(pb), cross(n, f.y)) = 0\n"
           "  coordinate height = local(d, f).z\n"},
          {"ring",
           "joint ring spatial\n  \"A point on a torus.\"\n"
           "  point pa on a\n  point pb on b\n  frame f on b\n  scalar R [m]\n  scalar r [m]\n"
           "  let s = local(pa - pb, f)\n  (sqrt(s.x^2 + s.y^2) - R)^2 + s.z^2 = r^2\n"},
          {"curve",
           "joint curve planar\n  \"A point on an ellipse, and a slope.\"\n"
           "  point pa on a\n  point pb on b\n  frame f on b\n  scalar p [m]\n"
           "  let u = pa - pb\n  let s = local(u, f)\n  (s.x / p)^2 + 2 * (s.y / p)^2 = 1\n"
           "  coordinate height [m] = s.y + s.x^2 / p\n"},
          {"outer",
           "joint outer spatial\n  \"A vector row with numbers that move.\"\n"
           "  point pa on a\n  point pb on b\n  unit n on a\n  let d = pb - pa\n"
           "  d = dot(n, d) * n\n"}};
}

Derivation read_text(const std::string& name, const std::string& text) {
  const auto file = std::make_shared<SourceFile>(name + ".joint", text);
  const ReadResult read = read_joint(file, {});
  if (!read.joint) throw std::runtime_error(render(*read.file, read.diagnostics));
  return derive(*read.joint);
}
