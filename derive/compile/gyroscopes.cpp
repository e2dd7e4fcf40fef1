#include "derive/compile/gyroscopes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

#include "derive/compile/texts.hpp"

namespace cdot::compile {
namespace {

bool is_diagonal(const Tensor& I) { return I[3] == 0 && I[4] == 0 && I[5] == 0; }

std::string text_of(const Tensor& I, double unit) {
  if (is_diagonal(I)) return fmt::format("Vector<T>{{T({}), T({}), T({})}}", unit * I[0], unit * I[1], unit * I[2]);
  return fmt::format("Tensor<T>{{T({}), T({}), T({}), T({}), T({}), T({})}}", unit * I[0], unit * I[1], unit * I[2],
                     unit * I[3], unit * I[4], unit * I[5]);
}
std::string moments(const Tensor& I) { return text_of(I, 1); }

// S of a body in the axes of the world.
std::string turned_by(const std::string& pose, const Tensor& S) {
  if (!is_diagonal(S)) return fmt::format("turned<T>({}, {})", pose, moments(S));
  const auto axis = static_cast<std::size_t>(std::min_element(S.begin(), S.begin() + 3) - S.begin());
  return fmt::format("turned<{}, T>({}, T({}), T({}), T({}))", axis, pose, S[axis], S[(axis + 1) % 3] - S[axis],
                     S[(axis + 2) % 3] - S[axis]);
}

// The axis about which the body is symmetric, as mean_spin() of the runtime finds it; -1: none.
int symmetry_axis(const Tensor& I) {
  const double slight = 8 * 2.220446049250313e-16 * (I[0] + I[1] + I[2]);
  if (std::abs(I[3]) + std::abs(I[4]) + std::abs(I[5]) > slight) return -1;
  const auto equal = [&](double a, double b) { return std::abs(a - b) <= slight; };
  return equal(I[0], I[1]) ? 2 : equal(I[1], I[2]) ? 0 : equal(I[0], I[2]) ? 1 : -1;
}

std::string spin_of(const std::string& name) {
  return fmt::format("Vector<T>{{v[{0}].wx, v[{0}].wy, v[{0}].wz}}", name);
}

// The arguments by which a body turns freely: those of a symmetric one, or of any other. Its rotation does not depend
// on the scale of the inertia: of about 1 it suits floats.
std::string turning_of(const Body& body) {
  const double unit = std::scalbn(1, -std::ilogb(std::max({body.inertia[0], body.inertia[1], body.inertia[2]})));
  const int axis = symmetry_axis(body.inertia);
  if (axis < 0) return text_of(body.inertia, unit) + ", " + text_of(body.inverse_inertia, 1 / unit);
  const Tensor& I = body.inertia;
  const double along = I[static_cast<std::size_t>(axis)];
  const std::string e = fmt::format("Vector<T>{{T({}), T({}), T({})}}", int{axis == 0}, int{axis == 1}, int{axis == 2});
  return fmt::format("{}, T({}), {}", e, 0.5 * unit * (I[0] + I[1] + I[2] - along), text_of(I, unit));
}

// Bodies of one inertia are of one kind, whose functions know it.
class Kinds {
 public:
  std::string of(const Body& body, const std::string& name) {
    const std::string functions =
        fmt::format("      static Tensor<T> I(const Pose& q) {{ return {}; }}\n", turned_by("q", body.inertia)) +
        fmt::format("      static Tensor<T> inverse(const Pose& q) {{ return {}; }}\n",
                    turned_by("q", body.inverse_inertia)) +
        fmt::format(
            "      static void drift(Pose& to, const Pose& q, const Velocity& v, const T& h) {{\n"
            "        spin(to, q, v, {}, h);\n      }}\n",
            turning_of(body));
    const auto known = std::ranges::find(kinds_, functions);
    const auto place = static_cast<std::size_t>(known - kinds_.begin());
    if (known == kinds_.end()) kinds_.push_back(functions), bodies_.emplace_back();
    bodies_[place].push_back({name, count_++});
    return fmt::format("typename Kinds::Kind_{}", place);
  }
  // Lines for the bodies of each kind; "KIND" in `four` is the kind of four numbers side by side, in `one` of one.
  std::string lines(const std::string& four, const std::string& one) const {
    std::string text;
    for (std::size_t k = 0; k < kinds_.size(); ++k) {
      const auto of_kind = [&](std::string line, const char* prefix) {
        return line.replace(line.find("KIND"), 4, fmt::format("{}Kinds::Kind_{}", prefix, k));
      };
      text += by_fours(bodies_[k], of_kind(four, "Wide::"), of_kind(one, ""));
    }
    return text;
  }

  std::string text() const {
    std::string text =
        "\n  // Inertias and their inverses in the axes of the world, by kinds of bodies.\n  struct Kinds {\n";
    for (std::size_t k = 0; k < kinds_.size(); ++k)
      text += fmt::format("    struct Kind_{} {{\n{}    }};\n", k, kinds_[k]);
    return text + "  };\n";
  }

 private:
  std::vector<std::string> kinds_;
  std::vector<std::vector<Named>> bodies_;  // by kinds
  int count_ = 0;
};

// Lines of find_mean_spins() for one body.
std::string mean_of(const Body& body, const std::string& name) {
  if (!body.inertia_turns) return fmt::format("    mean[{0}] = v[{0}];\n", name);
  return fmt::format("    mean[{0}] = mean_of(q[{0}], v[{0}], {1}, h);\n", name, turning_of(body));
}

constexpr const char* mean_functions = R"(
  // A velocity with the mean spin of a motion during h, as spin() turns the pose.
  static Velocity mean_of(const Pose& q, const Velocity& v, const Vector<T>& e, const T& across, const Vector<T>& I,
                          const T& h) {
    using std::atan2;
    const Vector<T> W = to_body(q, Vector<T>{v.wx, v.wy, v.wz});
    T c;
    const Vector<T> half = free_turn(e, across, W, times(I, W), h, c);
    const T sine = root(dot(half, half)), scale = T(2) * atan2(sine, c) / (h * select(sine > T(0), sine, T(1)));
    const Vector<T> w = to_world(q, scenes::choose(sine > T(0), scale * half, W));
    return {v.x, v.y, v.z, w.x, w.y, w.z};
  }
  template <class Moments>
  static Velocity mean_of(const Pose& q, const Velocity& v, const Moments& I, const Moments& inverse, const T& h) {
    const Vector<T> w = to_world(q, mean_spin(I, inverse, to_body(q, Vector<T>{v.wx, v.wy, v.wz}), h));
    return {v.x, v.y, v.z, w.x, w.y, w.z};
  }
)";

constexpr const char* momentum_functions = R"(
  // Keeps I w of a body that moved.
  template <class Kind>
  static void follow(Pose& q, Velocity& v, Gyroscope& g) {
    g.momentum = g.momentum + g.I * (Vector<T>{v.wx, v.wy, v.wz} - g.spin);
    q.I = Kind::inverse(q), g.I = Kind::I(q), g.spin = q.I * g.momentum;
    v.wx = g.spin.x, v.wy = g.spin.y, v.wz = g.spin.z;
  }
  static void carry(const Pose& q, Velocity& v, const Tensor<T>& I) {
    const Vector<T> w = q.I * (I * Vector<T>{v.wx, v.wy, v.wz});
    v.wx = w.x, v.wy = w.y, v.wz = w.z;
  }
  template <class Kind>
  static void wind(Pose& q, const Velocity& v, Gyroscope& g) {
    g.spin = {v.wx, v.wy, v.wz};
    q.I = Kind::inverse(q), g.I = Kind::I(q), g.momentum = g.I * g.spin;
  }
  // The pose after h by the mean spin: of a body that is symmetric about e, and of any other.
  static void spin(Pose& to, const Pose& q, const Velocity& v, const Vector<T>& e, const T& across, const Vector<T>& I,
                   const T& h) {
    const Vector<T> W = to_body(q, Vector<T>{v.wx, v.wy, v.wz});
    T c;
    const Vector<T> half = free_turn(e, across, W, times(I, W), h, c);
    turn_within(to, q, c, half);
    to.x = q.x + h * v.x, to.y = q.y + h * v.y, to.z = q.z + h * v.z;
  }
  template <class Moments>
  static void spin(Pose& to, const Pose& q, const Velocity& v, const Moments& I, const Moments& inverse, const T& h) {
    T c;
    const Vector<T> half = half_turn(h * mean_spin(I, inverse, to_body(q, Vector<T>{v.wx, v.wy, v.wz}), h), c);
    turn_within(to, q, c, half);
    to.x = q.x + h * v.x, to.y = q.y + h * v.y, to.z = q.z + h * v.z;
  }
)";

// Four bodies of one kind side by side. 7 to 15 are the places of the rotation matrix in a Pose, 16 to 21 those of I, 3
// to 5 those of the spin in a Velocity.
constexpr const char* four_functions = R"(
  template <class Kind>
  static void drift_four(Pose (&to)[bodies], const Pose (&from)[bodies], const Velocity (&v)[bodies], const T& h,
                         int i, int j, int k, int l) {
    const Places<0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15> places;
    typename Wide::Pose q;
    typename Wide::Velocity by;
    gather(places, q, from[i], from[j], from[k], from[l]);
    gather(Places<0, 1, 2, 3, 4, 5>(), by, v[i], v[j], v[k], v[l]);
    Kind::drift(q, q, by, typename WideOf<T>::type(h));
    orient(q);
    scatter(places, q, to[i], to[j], to[k], to[l]);
  }
  template <class Kind>
  static void follow_four(Pose (&q)[bodies], Velocity (&v)[bodies], Gyroscope* g, int i, int j, int k, int l, int m,
                          int n, int o, int p) {
    const Places<0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11> places;
    const Places<3, 4, 5> spin;
    typename Wide::Pose pose;
    typename Wide::Velocity velocity;
    typename Wide::Gyroscope gyroscope;
    gather(Places<7, 8, 9, 10, 11, 12, 13, 14, 15>(), pose, q[i], q[j], q[k], q[l]);
    gather(spin, velocity, v[i], v[j], v[k], v[l]);
    gather(places, gyroscope, g[m], g[n], g[o], g[p]);
    Wide::template follow<Kind>(pose, velocity, gyroscope);
    scatter(Places<16, 17, 18, 19, 20, 21>(), pose, q[i], q[j], q[k], q[l]);
    scatter(spin, velocity, v[i], v[j], v[k], v[l]);
    scatter(places, gyroscope, g[m], g[n], g[o], g[p]);
  }
)";

constexpr const char* weighs_in_lanes = R"(  }
  static void weigh(Pose (&q)[bodies], const Mask& now) {
    Tensor<T> before[bodies];
    for (int i = 0; i < bodies; ++i) before[i] = q[i].I;
    weigh(q);
    for (int i = 0; i < bodies; ++i) q[i].I = scenes::choose(now, q[i].I, before[i]);
  }
)";

constexpr const char* follows_in_lanes = R"(  }
  static void follow(State& s, const Mask& now) {
    const State before = s;
    follow(s);
    for (int i = 0; i < bodies; ++i) s.q[i].I = scenes::choose(now, s.q[i].I, before.q[i].I);
    for (int i = 0; i < bodies; ++i) s.v[i] = choose(now, s.v[i], before.v[i]);
    for (unsigned i = 0; i < sizeof s.g / sizeof s.g[0]; ++i) {
      s.g[i].I = scenes::choose(now, s.g[i].I, before.g[i].I);
      s.g[i].momentum = scenes::choose(now, s.g[i].momentum, before.g[i].momentum);
      s.g[i].spin = scenes::choose(now, s.g[i].spin, before.g[i].spin);
    }
  }
)";

}  // namespace

bool carries_spin(const Mechanism& mechanism, bool looks) {
  const auto drags = [](const Body& body) { return body.inertia_turns && body.angular_drag != 0; };
  return mechanism.has_gyroscopes() && (looks || std::ranges::any_of(mechanism.bodies, drags));
}

std::string pose_argument(const Mechanism& mechanism) {
  return mechanism.has_gyroscopes() ? "const Pose (&q)[bodies], " : "";
}

std::string gyroscopes_of(const Mechanism& mechanism, const std::vector<std::string>& names) {
  if (!mechanism.has_gyroscopes()) return {};
  std::string weigh, wind, drift, carry;
  Kinds kinds;
  int count = 0;
  for (std::size_t b = 0; b < names.size(); ++b) {
    const Body& body = mechanism.bodies[b];
    if (!body.moves) continue;
    if (!body.inertia_turns) {
      drift += fmt::format("    move(s.q[{0}], q[{0}], h * s.v[{0}]), orient(s.q[{0}]);\n", names[b]);
      continue;
    }
    const std::string kind = kinds.of(body, names[b]);
    weigh += fmt::format("    q[{0}].I = {1};\n", names[b], turned_by("q[" + names[b] + "]", body.inverse_inertia));
    wind += fmt::format("    wind<{2}>(s.q[{0}], s.v[{0}], s.g[{1}]);\n", names[b], count++, kind);
    carry += fmt::format("    carry(to[{0}], v[{0}], turned<T>(from[{0}], {1}));\n", names[b], moments(body.inertia));
  }
  if (mechanism.on_accelerations())
    return "\n  // Inverse inertias at the poses.\n  static void weigh(Pose (&q)[bodies]) {\n" + weigh +
           weighs_in_lanes;
  return kinds.text() + momentum_functions + four_functions + ("  static void wind(State& s) {\n" + wind + "  }\n") +
         "  static void follow(State& s) {\n" +
         kinds.lines("follow_four<typename KIND>(s.q, s.v, s.g, {4}, {5})",
                     "follow<typename KIND>(s.q[{0}], s.v[{0}], s.g[{1}])") +
         follows_in_lanes +
         "  // Velocities at one pose as those of the same angular momentum at another.\n"
         "  static void carry(const Pose (&from)[bodies], const Pose (&to)[bodies], Velocity (&v)[bodies]) {\n" +
         carry + "  }\n  static void drift(State& s, const Pose (&q)[bodies], const T& h) {\n" + drift +
         kinds.lines("drift_four<typename KIND>(s.q, q, s.v, h, {4})",
                     "KIND::drift(s.q[{0}], q[{0}], s.v[{0}], h), orient(s.q[{0}])") +
         "  }\n";
}

std::string mean_spins_of(const Mechanism& mechanism, const std::vector<std::string>& names) {
  std::string lines;
  for (std::size_t b = 0; b < names.size(); ++b)
    if (mechanism.bodies[b].moves) lines += mean_of(mechanism.bodies[b], names[b]);
  return mean_functions +
         ("  static void find_mean_spins(const Pose (&q)[bodies], const Velocity (&v)[bodies], const T& h, "
          "Velocity (&mean)[bodies]) {\n" +
          lines + "  }\n");
}

std::string torque_of(const Body& body, const std::string& name) {
  if (body.torque == std::array<double, 3>{}) return {};
  return fmt::format("    const Vector<T> {0}_rate = q[{0}].I * Vector<T>{{T({1}), T({2}), T({3})}};\n", name,
                     body.torque[0], body.torque[1], body.torque[2]);
}

std::string work_of_torque(const Body& body, const std::string& name) {
  std::array<double, 3> torque = body.torque;
  for (std::size_t i = 0; i < 3 && body.inv_I > 0; ++i) torque[i] = body.acceleration[3 + i] / body.inv_I;
  if (torque == std::array<double, 3>{}) return {};
  return fmt::format(R"(    {{  // along the shortest rotation from the start
      using std::atan2;
      const Pose& q = s.q[{}];
      const T e0 = T({}), e1 = T({}), e2 = T({}), e3 = T({}), c = q.e0 * e0 + q.e1 * e1 + q.e2 * e2 + q.e3 * e3;
      const T side = select(c < T(0), T(-1), T(1));
      const Vector<T> v = side * Vector<T>{{q.e1 * e0 - q.e0 * e1 - q.e2 * e3 + q.e3 * e2,
                                           q.e2 * e0 - q.e0 * e2 - q.e3 * e1 + q.e1 * e3,
                                           q.e3 * e0 - q.e0 * e3 - q.e1 * e2 + q.e2 * e1}};
      const T sine = root(dot(v, v)), angle = T(2) * atan2(sine, side * c);
      sum = sum - angle / select(sine > T(0), sine, T(1)) * dot(Vector<T>{{T({}), T({}), T({})}}, v);
    }}
)",
                     name, body.pose[3], body.pose[4], body.pose[5], body.pose[6], torque[0], torque[1], torque[2]);
}

std::string spin_energy_of(const Body& body, const std::string& name) {
  return fmt::format(
      "    {{\n      const Vector<T> W = to_body(q[{}], {});\n      sum = sum + dot(W, times({}, W));\n    }}\n", name,
      spin_of(name), moments(body.inertia));
}

}  // namespace cdot::compile
