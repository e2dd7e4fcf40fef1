#include "derive/compile/bodies.hpp"

#include <fmt/format.h>

namespace cdot::compile {
namespace {

std::string pushed(const std::string& name, const std::string& member, double a, double drag) {
  const std::string v = fmt::format("v[{}].{}", name, member);
  std::string text;
  if (drag != 0) text += fmt::format("    {0} = {0} * (T(1) / (T(1) + h * T({1})));\n", v, drag);
  if (a != 0) text += fmt::format("    {0} = {0} + h * T({1});\n", v, a);
  return text;
}

}  // namespace

std::string BodyTexts::turn(const std::set<std::string>& turning) const {
  std::string text = R"(
  static Pose moved(const Pose& q, const Velocity& d) { return {q.x + d.x, q.y + d.y, q.angle + d.w, q.c, q.s}; }

  static void turn(Pose (&q)[bodies]) {
)";
  each([&](const Body&, const std::string& name) {
    text += turning.contains(name) ? fmt::format("    sin_cos(q[{0}].angle, q[{0}].s, q[{0}].c);\n", name)
                                   : fmt::format("    q[{0}].c = T(1), q[{0}].s = T(0);  // read by no joint\n", name);
  });
  return text + "  }\n";
}

std::string BodyTexts::push() const {
  std::string text = R"(
  // Forces other than the joints' act for h. Drag is implicit: v / (1 + h d).
  static void push(Velocity (&v)[bodies], const T& h) {
)";
  each([&](const Body& b, const std::string& name) {
    text += pushed(name, "x", mechanism.gravity_x + b.ax, b.linear_drag);
    text += pushed(name, "y", mechanism.gravity_y + b.ay, b.linear_drag);
    text += pushed(name, "w", b.aw, b.angular_drag);
  });
  return text + "    (void)v, (void)h;\n  }\n";
}

std::string BodyTexts::weighed() const {
  std::string text = R"(
  // Twice the kinetic energy.
  static T weighed(const Velocity (&v)[bodies]) {
    T sum = T(0);
)";
  each([&](const Body& b, const std::string& name) {
    const auto square = [&](const std::string& member) { return fmt::format("v[{0}].{1} * v[{0}].{1}", name, member); };
    if (b.inv_m > 0) text += fmt::format("    sum = sum + T({}) * ({} + {});\n", 1 / b.inv_m, square("x"), square("y"));
    if (b.inv_I > 0) text += fmt::format("    sum = sum + T({}) * ({});\n", 1 / b.inv_I, square("w"));
  });
  return text + "    return sum;\n  }\n";
}

std::string BodyTexts::energy(bool has_effects) const {
  std::string text = R"(
  // Kinetic energy, that of effects, and the potential of gravity and constant forces, which is 0 at the start [J].
  static T energy(const State& s) {
    T sum = T(0.5) * weighed(s.v);
)";
  if (has_effects) text += "    T E;  // of the effects\n    potential($ss.q, s.time, E);\n    sum = sum + E;\n";
  each([&](const Body& b, const std::string& name) {
    const auto add = [&](double force, const std::string& member, double start) {
      if (force == 0) return;
      text += fmt::format("    sum = sum - T({}) * (s.q[{}].{} - T({}));\n", force, name, member, start);
    };
    if (b.inv_m > 0) add((mechanism.gravity_x + b.ax) / b.inv_m, "x", b.x);
    if (b.inv_m > 0) add((mechanism.gravity_y + b.ay) / b.inv_m, "y", b.y);
    if (b.inv_I > 0) add(b.aw / b.inv_I, "angle", b.angle);
  });
  return text + "    return sum;\n  }\n";
}

}  // namespace cdot::compile
