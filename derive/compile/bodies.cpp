#include "derive/compile/bodies.hpp"

#include <fmt/format.h>

#include "derive/compile/gyroscopes.hpp"
#include "derive/compile/texts.hpp"
#include "derive/program/print.hpp"

namespace cdot::compile {
namespace {

// Drag, then an acceleration: a number, or the text of one.
std::string pushed(const std::string& v, double drag, const std::string& a) {
  std::string text;
  if (drag != 0) text += fmt::format("    {0} = {0} * (T(1) / (T(1) + h * T({1})));\n", v, drag);
  if (!a.empty()) text += fmt::format("    {0} = {0} + h * {1};\n", v, a);
  return text;
}

constexpr const char* begin_shift = R"(  // Moves poses by displacements, and turns them.
  static void shift(Pose (&q)[bodies], const Velocity (&d)[bodies]) {
)";

std::string number(double x) { return x == 0 ? "" : fmt::format("T({})", x); }

}  // namespace

std::string BodyTexts::start() const {
  const char* const plane[] = {"x", "y", "angle"};
  const char* const space[] = {"x", "y", "z", "e0", "e1", "e2", "e3"};
  std::string text;
  const auto add = [&](const std::string& line) {
    for (const std::string& wrapped : derive::wrapped(line)) text += wrapped + "\n";
  };
  each([&](const Body& b, const std::string& name) {
    std::string pose, velocity;
    for (std::size_t k = 0; k < b.pose.size(); ++k)
      pose += fmt::format("{}s.q[{}].{} = T({})", k == 0 ? "" : ", ", name, (mechanism.spatial() ? space : plane)[k],
                          b.pose[k]);
    for (const double number : b.velocity) velocity += fmt::format("{}T({})", velocity.empty() ? "" : ", ", number);
    add("    " + pose + ";");
    add("    s.v[" + name + "] = {" + velocity + "};");
  });
  return text;
}

std::string BodyTexts::turn(const std::set<std::string>& turning) const {
  std::vector<Named> all, of_them;
  std::string text = "\n  static void turn(Pose (&q)[bodies]) {\n";
  each([&](const Body&, const std::string& name) {
    all.push_back({name, 0});
    if (turning.contains(name)) of_them.push_back({name, 0});
    else if (!mechanism.spatial())
      text += fmt::format("    q[{0}].c = T(1), q[{0}].s = T(0);  // read by no joint\n", name);
  });
  if (mechanism.spatial())
    return text + by_fours(all, "orient_four<Wide>(q, {4})", "orient(q[{0}])") + "  }\n" + begin_shift +
           by_fours(all, "shift_four<Wide>(q, d, {4})", "move(q[{0}], q[{0}], d[{0}]), orient(q[{0}])") + "  }\n";
  text +=
      by_fours(of_them, "sin_cos_of(q, {4})", "sin_cos(q[{0}].angle, q[{0}].s, q[{0}].c)") + "  }\n" +
      turn_beside(of_them) + begin_shift +
      by_fours(of_them,
               "sin_cos_near<true>(q, q, typename WideOf<T>::type{{q[{0}].angle + d[{0}].w, q[{1}].angle + d[{1}].w, "
               "q[{2}].angle + d[{2}].w, q[{3}].angle + d[{3}].w}}, {4})",
               "sin_cos_after(q[{0}], d[{0}])");
  for (const Named& body : all) text += fmt::format("    move(q[{0}], q[{0}], d[{0}]);\n", body.name);
  return text + "  }\n";
}

std::string BodyTexts::turn_beside(const std::vector<Named>& turning) const {
  const std::string slight = mechanism.method == Method::rattle ? "true" : "false";
  return "  // Those of poses beside others.\n  static void turn(Pose (&q)[bodies], const Pose (&from)[bodies]) {\n" +
         by_fours(turning,
                  "sin_cos_near<" + slight +
                      ">(q, from, typename WideOf<T>::type{{q[{0}].angle, q[{1}].angle, q[{2}].angle, q[{3}].angle}}, "
                      "{4})",
                  "sin_cos_beside<" + slight +
                      ">(from[{0}].s, from[{0}].c, q[{0}].angle - from[{0}].angle, q[{0}].angle, q[{0}].s, q[{0}].c)") +
         "    (void)q, (void)from;\n  }\n";
}

std::string BodyTexts::push() const {
  std::string text = fmt::format(R"(
  // Forces other than the joints' act for h. Drag is implicit: v / (1 + h d).
  static void push({}Velocity (&v)[bodies], const T& h) {{
)",
                                 pose_argument(mechanism));
  each([&](const Body& b, const std::string& name) {
    const std::string torque = torque_of(b, name);
    if (!torque.empty()) text += torque;
    for (std::size_t c = 0; c < mechanism.columns(); ++c) {
      const bool turns = c >= mechanism.linear();
      const std::string a = turns && !torque.empty() ? fmt::format("{}_rate.{}", name, "xyz"[c - mechanism.linear()])
                                                     : number(mechanism.push(b, c));
      text += pushed(fmt::format("v[{}].{}", name, mechanism.column(c)), turns ? b.angular_drag : b.linear_drag, a);
    }
  });
  return text + (pose_argument(mechanism).empty() ? "" : "    (void)q;\n") + "    (void)v, (void)h;\n  }\n";
}

std::string BodyTexts::weighed(bool with_bounds) const {
  std::string text = R"(
  // Twice the kinetic energy.
  static T weighed(const Pose (&q)[bodies], const Velocity (&v)[bodies]) {
    (void)q;
    T sum = T(0);
)";
  each([&](const Body& b, const std::string& name) {
    const auto squares = [&](std::size_t begin, std::size_t end) {
      std::string sum;
      for (std::size_t c = begin; c < end; ++c)
        sum += fmt::format("{0}v[{1}].{2} * v[{1}].{2}", c == begin ? "" : " + ", name, mechanism.column(c));
      return sum;
    };
    if (b.inv_m > 0)
      text += fmt::format("    sum = sum + T({}) * ({});\n", 1 / b.inv_m, squares(0, mechanism.linear()));
    if (b.inertia_turns) text += spin_energy_of(b, name);
    else if (b.inv_I > 0)
      text +=
          fmt::format("    sum = sum + T({}) * ({});\n", 1 / b.inv_I, squares(mechanism.linear(), mechanism.columns()));
  });
  return text + "    return sum;\n  }\n" + (with_bounds ? bounds_of_weighed() : "");
}

// Bounds of it that turn no spin to a body's axes.
std::string BodyTexts::bounds_of_weighed() const {
  std::string most, least;
  each([&](const Body& b, const std::string& name) {
    const std::string moving = fmt::format("(v[{0}].x * v[{0}].x + v[{0}].y * v[{0}].y + v[{0}].z * v[{0}].z)", name);
    const std::string turning =
        fmt::format("(v[{0}].wx * v[{0}].wx + v[{0}].wy * v[{0}].wy + v[{0}].wz * v[{0}].wz)", name);
    const double trace = b.inertia_turns ? b.inertia[0] + b.inertia[1] + b.inertia[2] : b.inv_I > 0 ? 1 / b.inv_I : 0;
    if (b.inv_m > 0) least += fmt::format("    sum = sum + T({}) * {};\n", 1 / b.inv_m, moving);
    if (trace > 0) most += fmt::format("    sum = sum + T({}) * {};\n", trace, turning);
  });
  const char* const function =
      "  static T {}(const Velocity (&v)[bodies]) {{\n    T sum = T(0);\n{}    return sum;\n  }}\n";
  return "  // At least that, and at most.\n" + fmt::format(fmt::runtime(function), "weighed_at_least", least) +
         fmt::format(fmt::runtime(function), "weighed_at_most", least + most);
}

// A constant torque has a potential in the plane only. In space its work counts along the shortest rotation.
std::string BodyTexts::energy(bool has_effects) const {
  std::string text = R"(
  // Kinetic energy, that of effects, and the potential of gravity and constant forces, which is 0 at the start [J].
  static T energy(const State& s) {
    T sum = T(0.5) * weighed(s.q, s.v);
)";
  if (has_effects) text += "    T E;  // of the effects\n    potential($ss.q, s.time, E);\n    sum = sum + E;\n";
  each([&](const Body& b, const std::string& name) {
    const auto add = [&](double force, const std::string& member, double start) {
      if (force == 0) return;
      text += fmt::format("    sum = sum - T({}) * (s.q[{}].{} - T({}));\n", force, name, member, start);
    };
    for (std::size_t c = 0; b.inv_m > 0 && c < mechanism.linear(); ++c)
      add(mechanism.push(b, c) / b.inv_m, mechanism.column(c), b.pose[c]);
    if (b.inv_I > 0 && !mechanism.spatial()) add(b.acceleration[2] / b.inv_I, "angle", b.pose[2]);
    if (mechanism.spatial()) text += work_of_torque(b, name);
  });
  return text + "    return sum;\n  }\n";
}

// As the World does it: runtime/step/midpoint.cpp.
std::string BodyTexts::judged() const {
  std::string ways, energies, speeds;
  each([&](const Body& b, const std::string& name) {
    for (const bool turns : {false, true}) {
      const std::size_t begin = turns ? mechanism.linear() : 0, end = turns ? mechanism.columns() : mechanism.linear();
      std::string change, size, square;
      for (std::size_t c = begin; c < end; ++c) {
        const std::string column = fmt::format("[{}].{}", name, mechanism.column(c)), plus = c == begin ? "" : " + ";
        ways += fmt::format("    most = larger(magnitude(d{}){}, most);\n", column,
                            turns ? "" : fmt::format(" * T({})", 1 / mechanism.size));
        change += fmt::format("{0}magnitude(v{1} - from{1})", plus, column);
        size += fmt::format("{}magnitude(v{})", plus, column), square += fmt::format("{0}v{1} * v{1}", plus, column);
      }
      speeds += fmt::format("    most = larger({}, most);\n", square);
      const double mass = turns ? b.inv_I : b.inv_m;
      const std::string share =  // as the World has it: runtime/step/work_in_part.hpp
          fmt::format("select({} > T({}) * ({}), T(1), T({}))", change, "single ? 1e-4 : 1e-9", size,
                      "single ? 9.5367431640625e-05 : 1.7763568394002505e-11");
      if (turns && b.inertia_turns)
        energies += fmt::format("    before = sum;\n{}    sum = before + {} * (sum - before);\n",
                                spin_energy_of(b, name), share);
      else if (mass > 0) energies += fmt::format("    sum = sum + {} * T({}) * ({});\n", share, 1 / mass, square);
    }
  });
  return fmt::format(R"(
  // The largest change of a pose in h, in units of the mechanism's size and in [rad].
  static T farthest(const Velocity (&d)[bodies], const T& h) {{
    T most = T(0);
{}    return h * most;
  }}
  // Too slow for a judgement of its energy.
  static Mask hardly_moves(const Velocity (&v)[bodies], const T& h) {{
    T most = T(0);
{}    return most * h * h < T(single ? {} : {});
  }}
  // Twice the kinetic energy of the motions that changed from others: others count by round-off.
  static T moved_energy(const Pose (&q)[bodies], const Velocity (&v)[bodies], const Velocity (&from)[bodies]) {{
    T sum = T(0), before = sum;
    (void)q, (void)before;
{}    return sum;
  }}
)",
                     ways, speeds, 1e-8 * mechanism.size * mechanism.size, 1e-12 * mechanism.size * mechanism.size,
                     energies);
}

// v exp(-h d): exact for drag alone.
std::string BodyTexts::dragged() const {
  std::string text = "\n  static void drag(Velocity (&v)[bodies], const T& h) {\n    using std::exp;\n";
  each([&](const Body& b, const std::string& name) {
    for (std::size_t c = 0; c < mechanism.columns(); ++c)
      if (const double d = c < mechanism.linear() ? b.linear_drag : b.angular_drag; d != 0)
        text += fmt::format("    v[{0}].{1} = exp(-h * T({2})) * v[{0}].{1};\n", name, mechanism.column(c), d);
  });
  return text + "  }\n";
}

}  // namespace cdot::compile
