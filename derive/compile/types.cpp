#include "derive/compile/types.hpp"

#include <fmt/format.h>

#include "derive/compile/gyroscopes.hpp"
#include "derive/compile/methods/bonds.hpp"
#include "derive/compile/midpoint/tension.hpp"
#include "derive/compile/one_freedom/step.hpp"

namespace cdot::compile {
namespace {

constexpr const char* planar_types = R"(
  using Mask = decltype(T(0) < T(1));
  struct Pose {
    T x, y, angle;  // centre of mass [m], [rad]
    T c, s;         // cosine and sine of the angle
  };
  struct Velocity {  // also an acceleration or a displacement
    T x, y, w;
    friend Velocity operator+(const Velocity& a, const Velocity& b) { return {a.x + b.x, a.y + b.y, a.w + b.w}; }
    friend Velocity operator-(const Velocity& a, const Velocity& b) { return {a.x - b.x, a.y - b.y, a.w - b.w}; }
    friend Velocity operator-(const Velocity& a) { return {-a.x, -a.y, -a.w}; }
    friend Velocity operator*(const T& a, const Velocity& b) { return {a * b.x, a * b.y, a * b.w}; }
  };
  using Rate = Velocity;  // of a pose
  static Velocity still() { return {T(0), T(0), T(0)}; }
  static Pose choose(const Mask& now, const Pose& q, const Pose& p) {
    return {select(now, q.x, p.x), select(now, q.y, p.y), select(now, q.angle, p.angle), select(now, q.c, p.c),
            select(now, q.s, p.s)};
  }
  static Velocity choose(const Mask& now, const Velocity& a, const Velocity& b) {
    return {select(now, a.x, b.x), select(now, a.y, b.y), select(now, a.w, b.w)};
  }
  static const Rate& rate_of(const Pose&, const Velocity& v) { return v; }
  // turn() is to follow.
  static void move(Pose& to, const Pose& q, const Velocity& d) {
    to.x = q.x + d.x, to.y = q.y + d.y, to.angle = q.angle + d.w;
  }
)";

constexpr const char* spatial_pose = R"(
  using Mask = decltype(T(0) < T(1));
  struct Pose {
    T x, y, z;                             // centre of mass [m]
    T e0, e1, e2, e3;                      // orientation, a quaternion of length 1
    T xx, xy, xz, yx, yy, yz, zx, zy, zz;  // its rotation matrix
)";

constexpr const char* spatial_inertia =
    R"(    Tensor<T> I;  // inverse inertia in the world's axes, of bodies whose inertia turns with them
)";

constexpr const char* spatial_types = R"(  }};
  struct Velocity {{  // also an acceleration or a displacement
    T x, y, z, wx, wy, wz;
    friend Velocity operator+(const Velocity& a, const Velocity& b) {{
      return {{a.x + b.x, a.y + b.y, a.z + b.z, a.wx + b.wx, a.wy + b.wy, a.wz + b.wz}};
    }}
    friend Velocity operator-(const Velocity& a, const Velocity& b) {{
      return {{a.x - b.x, a.y - b.y, a.z - b.z, a.wx - b.wx, a.wy - b.wy, a.wz - b.wz}};
    }}
    friend Velocity operator-(const Velocity& a) {{ return {{-a.x, -a.y, -a.z, -a.wx, -a.wy, -a.wz}}; }}
    friend Velocity operator*(const T& a, const Velocity& b) {{
      return {{a * b.x, a * b.y, a * b.z, a * b.wx, a * b.wy, a * b.wz}};
    }}
  }};
  static Velocity still() {{ return {{T(0), T(0), T(0), T(0), T(0), T(0)}}; }}
  static Pose choose(const Mask& now, const Pose& q, const Pose& p) {{
    Pose one = p;
    one.x = select(now, q.x, p.x), one.y = select(now, q.y, p.y), one.z = select(now, q.z, p.z);
    one.e0 = select(now, q.e0, p.e0), one.e1 = select(now, q.e1, p.e1);
    one.e2 = select(now, q.e2, p.e2), one.e3 = select(now, q.e3, p.e3);
    one.xx = select(now, q.xx, p.xx), one.xy = select(now, q.xy, p.xy), one.xz = select(now, q.xz, p.xz);
    one.yx = select(now, q.yx, p.yx), one.yy = select(now, q.yy, p.yy), one.yz = select(now, q.yz, p.yz);
    one.zx = select(now, q.zx, p.zx), one.zy = select(now, q.zy, p.zy), one.zz = select(now, q.zz, p.zz);
{}    return one;
  }}
  static Velocity choose(const Mask& now, const Velocity& a, const Velocity& b) {{
    return {{select(now, a.x, b.x),   select(now, a.y, b.y),   select(now, a.z, b.z),
            select(now, a.wx, b.wx), select(now, a.wy, b.wy), select(now, a.wz, b.wz)}};
  }}
  // By the exact rotation about d.w. turn() is to follow.
  static void move(Pose& to, const Pose& q, const Velocity& d) {{
    T c;
    const Vector<T> half = half_turn(Vector<T>{{d.wx, d.wy, d.wz}}, c);
    turn_by(to, q, c, half);
    to.x = q.x + d.x, to.y = q.y + d.y, to.z = q.z + d.z;
  }}
)";

constexpr const char* spatial_rates = R"(  struct Rate {  // of a pose
    T x, y, z, e0, e1, e2, e3;
    friend Rate operator*(const T& a, const Rate& b) {
      return {a * b.x, a * b.y, a * b.z, a * b.e0, a * b.e1, a * b.e2, a * b.e3};
    }
  };
  // de/dt = (0, w) e / 2
  static Rate rate_of(const Pose& q, const Velocity& v) {
    const T x = T(0.5) * v.wx, y = T(0.5) * v.wy, z = T(0.5) * v.wz;
    return {v.x, v.y, v.z, -x * q.e1 - y * q.e2 - z * q.e3, x * q.e0 + y * q.e3 - z * q.e2,
            y * q.e0 + z * q.e1 - x * q.e3, z * q.e0 + x * q.e2 - y * q.e1};
  }
  static void move(Pose& to, const Pose& q, const Rate& d) {
    to.x = q.x + d.x, to.y = q.y + d.y, to.z = q.z + d.z;
    to.e0 = q.e0 + d.e0, to.e1 = q.e1 + d.e1, to.e2 = q.e2 + d.e2, to.e3 = q.e3 + d.e3;
  }
)";

constexpr const char* gyroscope =
    R"(  // A body whose inertia turns with it keeps its angular momentum, as of the last move.
  struct Gyroscope {
    Tensor<T> I;              // inertia in the world's axes
    Vector<T> momentum, spin;
  };
)";

constexpr const char* slope_type =
    R"(  // Rates of the poses and of the velocities, as one list: sums of lists are loops that a compiler makes wide.
  struct Slope {{
    static constexpr int of_body = {0}, size = bodies * of_body;
    T of[size];
    void set(int i, const Rate& q, const Velocity& v) {{
      T* const to = of + of_body * i;
      {1}
    }}
    Rate rate(int i) const {{
      const T* const to = of + of_body * i;
      return {{{2}}};
    }}
    Velocity acceleration(int i) const {{
      const T* const to = of + of_body * i;
      return {{{3}}};
    }}
  }};
)";

constexpr const char* slope_type_apart =
    R"(  // Rates of angles and of spins, as one list: sums of lists are loops that a compiler makes wide. No stage reads a
  // centre of mass, so accelerations of these are summed at the end alone: `way` with weights b (1 - c), since
  // sum b_j a_jl = b_l (1 - c_l).
  struct Slope {{
    static constexpr int of_body = {0}, size = bodies * of_body, along = {1}, centres = bodies * along;
    T of[size], linear[centres], way[centres];
    void set(int i, const Rate& q, const Velocity& v) {{
      T* const to = of + of_body * i;
      T* const centre = linear + along * i;
      {2}
    }}
    // Angles and spins of a body at a stage, after h.
    void turn(int i, const T& h, const Pose& q, const Velocity& v, Pose& q_then, Velocity& v_then) const {{
      const T* const to = of + of_body * i;
      {5}
    }}
    Rate rate(int i, const Velocity& v, const T& h) const {{
      const T* const to = of + of_body * i;
      const T* const centre = way + along * i;
      return {{{3}}};
    }}
    Velocity acceleration(int i) const {{
      const T* const to = of + of_body * i;
      const T* const centre = linear + along * i;
      return {{{4}}};
    }}
  }};
)";

std::string slope_apart(bool spatial) {
  const std::vector<std::string> turns =
      spatial ? std::vector<std::string>{"q.e0", "q.e1", "q.e2", "q.e3", "v.wx", "v.wy", "v.wz"}
              : std::vector<std::string>{"q.w", "v.w"};
  const std::size_t along = spatial ? 3 : 2, of_pose = spatial ? 4 : 1;
  std::string sets, turned, of_rate, of_velocity;
  for (std::size_t k = 0; k < turns.size(); ++k) {
    sets += fmt::format("to[{}] = {}, ", k, turns[k]);
    const std::string name = turns[k] == "q.w" ? "angle" : turns[k].substr(2);
    turned += fmt::format("{0}{1}_then.{2} = {1}.{2} + h * to[{3}]", k == 0 ? "" : ", ", turns[k][0], name, k);
    (k < of_pose ? of_rate : of_velocity) += fmt::format(", to[{}]", k);
  }
  std::string centre_rate, centre_velocity;
  for (std::size_t k = 0; k < along; ++k) {
    const char axis = "xyz"[k];
    sets += fmt::format("centre[{}] = v.{}{}", k, axis, k + 1 == along ? ";" : ", ");
    centre_rate += fmt::format("{}v.{} + h * centre[{}]", k == 0 ? "" : ", ", axis, k);
    centre_velocity += fmt::format("{}centre[{}]", k == 0 ? "" : ", ", k);
  }
  return fmt::format(slope_type_apart, turns.size(), along, sets, centre_rate + of_rate, centre_velocity + of_velocity,
                     turned + ";");
}

std::string slope_of(bool spatial) {
  const std::vector<std::string> rates = spatial ? std::vector<std::string>{"x", "y", "z", "e0", "e1", "e2", "e3"}
                                                 : std::vector<std::string>{"x", "y", "w"};
  const std::vector<std::string> velocities =
      spatial ? std::vector<std::string>{"x", "y", "z", "wx", "wy", "wz"} : rates;
  std::string sets, of_rate, of_velocity;
  int number = 0;
  for (const std::string& name : rates) {
    sets += fmt::format("to[{}] = q.{}, ", number, name);
    of_rate += fmt::format("{}to[{}]", number == 0 ? "" : ", ", number), ++number;
  }
  for (const std::string& name : velocities) {
    const bool last = &name == &velocities.back(), first = &name == &velocities.front();
    sets += fmt::format("to[{}] = v.{}{}", number, name, last ? ";" : ", ");
    of_velocity += fmt::format("{}to[{}]", first ? "" : ", ", number), ++number;
  }
  return fmt::format(slope_type, number, sets, of_rate, of_velocity);
}

}  // namespace

std::string number_types_of(const Mechanism& mechanism, const Equations& equations, const Contents& has) {
  std::string text;
  const auto add = [&](const std::string& comment, const std::string& name, const std::vector<std::string>& members) {
    text += fmt::format("  // {}\n  struct {} {{\n", comment, name);
    for (const std::string& member : members) text += "    T " + member + ";\n";
    text += "  };\n";
  };
  if (has.rows)
    add("The numbers of J, and K = J M^-1 J^T = L D L^T with the rows numbered in the order of elimination.",
        "Jacobian", equations.stored);
  if (has.foresees) add("J' M^-1 J^T = L D U, J' of the end of a step, numbered as K.", "Aim", equations.aimed);
  if (!equations.constants.inputs.empty()) {
    std::vector<std::string> inputs;
    for (const auto& [name, value] : equations.constants.inputs_read) inputs.push_back(name);
    add("Numbers that may be set before any step.", "Inputs", inputs);
  }
  if (has.angles)
    add("Angles of effects, with their whole turns, at the end of the last step.", "Angles",
        {fmt::format("angle[{0}], turns[{0}]", mechanism.angles)});
  if (has.midpoint)
    text += fmt::format("  using Inertia = {};  // its inverse\n", mechanism.spatial() ? "Tensor<T>" : "T");
  if (has.taut) text += taut_type(equations.taut, equations.taut_numbers);
  if (has.one_freedom) text += types_of_freedom(equations.freedom);
  if (has.foresees) text += "  struct Multipliers {\n    T of[rows];\n  };\n";
  if (has.events)
    add("Of rows with bounds: 1 if they have begun, if they have ended, if they act.", "Events",
        {"began[bounded], ended[bounded], acts[bounded]"});
  if (has.bonds) text += bonds_type(mechanism, equations.first_borne.back(), has);
  return text;
}

SlopeSize slope_size(const Mechanism& mechanism, bool apart) {
  const auto moving = static_cast<std::size_t>(std::ranges::count_if(mechanism.bodies, &Body::moves));
  if (!apart) return {moving, moving * (mechanism.spatial() ? 13 : 6), 0};
  return {moving, moving * (mechanism.spatial() ? 7 : 2), moving * mechanism.linear()};
}

std::string types_of(const Mechanism& mechanism, const std::string& name, bool apart) {
  const std::string slope = !mechanism.on_accelerations() ? ""
                            : apart                       ? slope_apart(mechanism.spatial())
                                                          : slope_of(mechanism.spatial());
  if (!mechanism.spatial()) return planar_types + slope;
  const bool gyroscopes = mechanism.has_gyroscopes();
  std::string text = fmt::format("  using Wide = {}<typename WideOf<T>::type>;\n", name) + spatial_pose;
  if (gyroscopes) text += spatial_inertia;
  text += fmt::format(spatial_types, gyroscopes ? "    one.I = scenes::choose(now, q.I, p.I);\n" : "");
  if (mechanism.on_accelerations()) text += spatial_rates + slope;
  else if (gyroscopes) text += gyroscope;
  return text;
}

long numbers_of(const Mechanism& mechanism, const Body& body, bool pulls) {
  if (!body.moves) return 0;
  const bool accelerates = mechanism.on_accelerations();
  const long columns = static_cast<long>(mechanism.columns());
  const long pose = mechanism.spatial() ? 16 + (mechanism.has_gyroscopes() ? 6 : 0) : 5;
  return pose + columns * (accelerates || pulls ? 2 : 1) + (body.inertia_turns && !accelerates ? 12 : 0);
}

}  // namespace cdot::compile
