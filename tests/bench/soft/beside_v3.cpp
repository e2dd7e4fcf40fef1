// bench_beside_v3 ENGINE MECHANISM STEPS: steps of 1/60 s in four substeps, by one sweep under Drift::soft ("cdot",
// "cdot_float") or by Box2D v3 ("v3"), and the largest gap of a joint [m]. Of `callgrind` counts at two numbers of
// steps the difference is the price; see README.md.
#include <algorithm>
#include <box2d/box2d.h>
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>
#include <map>
#include <string>
#include <vector>

#include <cdot/world.hpp>

namespace cdot::beside_v3 {
namespace {

constexpr double pi = 3.14159265358979323846, step = 1.0 / 60;
constexpr int substeps = 4;

enum class Kind { revolute, weld, slide, rod };  // a slide goes along x, a rod has the length 1
struct Joint {
  Kind kind;
  int a, b;
  double ax, ay, bx, by;  // in the frames of the bodies
};
struct Mechanism {
  std::vector<BodyDefinition> bodies;
  std::vector<Joint> joints;
};

// Body 0 is the ground.
Mechanism line(int links, Kind kind, double inertia) {
  Mechanism made{{{.is_static = true}}, {}};
  for (int k = 0; k < links; ++k) {
    made.bodies.push_back({.x = k + 0.5, .mass = 1, .inertia = inertia});
    made.joints.push_back({kind, k, k + 1, k ? 0.5 : 0.0, 0, -0.5, 0});
  }
  return made;
}

Mechanism heavy_chain() {
  Mechanism made = line(50, Kind::revolute, 1.0 / 12);
  made.bodies.push_back({.x = 50.5, .mass = 1000, .inertia = 125});
  made.joints.push_back({Kind::revolute, 50, 51, 0.5, 0, -0.5, 0});
  return made;
}

Mechanism grid(int side, Kind kind, double mass, double inertia, bool (*held)(int column, int side)) {
  const double arm = kind == Kind::rod ? 0 : 0.5;
  Mechanism made;
  for (int k = 0; k < side * side; ++k) {
    const int row = k / side, column = k % side;
    made.bodies.push_back({.x = 1.0 * column,
                           .y = -1.0 * row,
                           .mass = mass,
                           .inertia = inertia,
                           .is_static = row == 0 && held(column, side)});
    if (row > 0) made.joints.push_back({kind, k - side, k, 0, -arm, 0, arm});
    if (column > 0) made.joints.push_back({kind, k - 1, k, arm, 0, -arm, 0});
  }
  return made;
}

// A crank of 0.5 m at 1 rad and 10 rad/s, a rod of 1.5 m, a slider.
Mechanism crank() {
  const double speed = 10, x = 0.5 * std::cos(1), y = 0.5 * std::sin(1), slope = std::asin(-y / 1.5);
  const double dx = 1.5 * std::cos(slope), spin = -x * speed / dx;
  Mechanism made{{{.is_static = true}}, {}};
  made.bodies.push_back({.x = x / 2, .y = y / 2, .angle = 1, .vx = -y / 2 * speed, .vy = x / 2 * speed, .w = speed});
  made.bodies.push_back({.x = x + dx / 2, .y = y / 2, .angle = slope, .vx = y / 2 * spin - y * speed});
  made.bodies.back().vy = x * speed + dx / 2 * spin, made.bodies.back().w = spin;
  made.bodies.push_back({.x = x + dx, .vx = y * (spin - speed), .mass = 2, .inertia = 0.04 / 12});
  made.bodies[1].mass = made.bodies[2].mass = 1;
  made.bodies[1].inertia = 0.25 / 12, made.bodies[2].inertia = 2.25 / 12;
  made.joints = {{Kind::revolute, 0, 1, 0, 0, -0.25, 0},
                 {Kind::revolute, 1, 2, 0.25, 0, -0.75, 0},
                 {Kind::revolute, 2, 3, 0.75, 0, 0, 0},
                 {Kind::slide, 0, 3, x + dx, 0, 0, 0}};
  return made;
}

Mechanism mechanism(const std::string& name) {
  if (name == "chain") return line(10, Kind::revolute, 1.0 / 12);
  if (name == "beam") return line(30, Kind::weld, 1.04 / 12);
  if (name == "heavy") return heavy_chain();
  if (name == "crank") return crank();
  if (name == "grid") {
    const double mass = pi * 0.16;
    return grid(25, Kind::revolute, mass, 0.08 * mass,
                [](int column, int side) { return std::abs(column - side / 2) <= 3; });
  }
  return grid(60, Kind::rod, 1, 0, [](int column, int side) { return column % 10 == 0 || column == side - 1; });
}

double gap_between(const Joint& joint, double px, double py, double qx, double qy) {
  if (joint.kind == Kind::rod) return std::abs(std::hypot(px - qx, py - qy) - 1);
  return std::max(joint.kind == Kind::slide ? 0 : std::abs(px - qx), std::abs(py - qy));
}

template <class T>
double gap_of_cdot(const Mechanism& made, int steps) {
  World<T> world(
      {.solver = Solver::iterative, .drift = Drift::soft, .iterations = 1, .substeps = substeps, .gravity_y = -10});
  for (const BodyDefinition& body : made.bodies) world.add_body(body);
  for (const auto& [kind, a, b, ax, ay, bx, by] : made.joints) {
    const NamedValue pa{"pa", {ax, ay}}, pb{"pb", {bx, by}};
    if (kind == Kind::revolute) world.add_joint({"revolute", {a, b}, {pa, pb}, {}});
    if (kind == Kind::weld) world.add_joint({"weld", {a, b}, {pa, pb}, {}});
    if (kind == Kind::rod) world.add_joint({"distance", {a, b}, {pa, pb, {"l", {1}}}, {}});
    if (kind == Kind::slide)
      world.add_joint({"prismatic", {b, a}, {{"pa", {bx, by}}, {"pb", {ax, ay}}, {"t", {0, 1}}}, {}});
  }
  double gap = 0;
  for (int k = 0; k < steps; ++k) {
    if (!world.step(step)) return std::numeric_limits<double>::infinity();
    for (const Joint& joint : made.joints) {
      const auto at = [&](int body, double x, double y) {
        const auto q = world.place(body);
        const double c = std::cos(q.angle), s = std::sin(q.angle);
        return std::pair{q.x + c * x - s * y, q.y + s * x + c * y};
      };
      const auto p = at(joint.a, joint.ax, joint.ay), q = at(joint.b, joint.bx, joint.by);
      gap = std::max(gap, gap_between(joint, p.first, p.second, q.first, q.second));
    }
  }
  return gap;
}

b2BodyId add_body(b2WorldId world, const BodyDefinition& of) {
  b2BodyDef body = b2DefaultBodyDef();
  body.type = of.is_static ? b2_staticBody : b2_dynamicBody;
  body.position = {float(of.x), float(of.y)}, body.rotation = b2MakeRot(float(of.angle));
  body.linearVelocity = {float(of.vx), float(of.vy)}, body.angularVelocity = float(of.w), body.enableSleep = false;
  const b2BodyId id = b2CreateBody(world, &body);
  if (!of.is_static) b2Body_SetMassData(id, {float(of.mass), {0, 0}, float(of.inertia)});
  return id;
}

template <class Definition>
Definition connecting(Definition joint, const std::vector<b2BodyId>& bodies, const Joint& of) {
  joint.base.bodyIdA = bodies[static_cast<std::size_t>(of.a)],
  joint.base.bodyIdB = bodies[static_cast<std::size_t>(of.b)];
  joint.base.localFrameA.p = {float(of.ax), float(of.ay)}, joint.base.localFrameB.p = {float(of.bx), float(of.by)};
  return joint;
}

double gap_of_v3(const Mechanism& made, int steps) {
  b2WorldDef definition = b2DefaultWorldDef();
  definition.gravity = {0, -10};
  const b2WorldId world = b2CreateWorld(&definition);
  std::vector<b2BodyId> bodies;
  for (const BodyDefinition& body : made.bodies) bodies.push_back(add_body(world, body));
  for (const Joint& of : made.joints) {
    const auto revolute = connecting(b2DefaultRevoluteJointDef(), bodies, of);
    const auto weld = connecting(b2DefaultWeldJointDef(), bodies, of);
    const auto slide = connecting(b2DefaultPrismaticJointDef(), bodies, of);
    auto rod = connecting(b2DefaultDistanceJointDef(), bodies, of);
    rod.length = 1;
    if (of.kind == Kind::revolute) b2CreateRevoluteJoint(world, &revolute);
    if (of.kind == Kind::weld) b2CreateWeldJoint(world, &weld);
    if (of.kind == Kind::slide) b2CreatePrismaticJoint(world, &slide);
    if (of.kind == Kind::rod) b2CreateDistanceJoint(world, &rod);
  }
  double gap = 0;
  for (int k = 0; k < steps; ++k) {
    b2World_Step(world, float(step), substeps);
    for (const Joint& of : made.joints) {
      const auto p = b2Body_GetWorldPoint(bodies[static_cast<std::size_t>(of.a)], {float(of.ax), float(of.ay)}),
                 q = b2Body_GetWorldPoint(bodies[static_cast<std::size_t>(of.b)], {float(of.bx), float(of.by)});
      gap = std::max(gap, gap_between(of, p.x, p.y, q.x, q.y));
    }
  }
  b2DestroyWorld(world);
  return gap;
}

}  // namespace
}  // namespace cdot::beside_v3

int main(int count, char** arguments) {
  using namespace cdot::beside_v3;
  if (count != 4)
    return fmt::print(stderr, "bench_beside_v3 cdot|cdot_float|v3 chain|crank|beam|heavy|grid|net STEPS\n"), 2;
  const std::string engine = arguments[1];
  const Mechanism made = mechanism(arguments[2]);
  const int steps = std::atoi(arguments[3]);
  const double gap = engine == "v3"           ? gap_of_v3(made, steps)
                     : engine == "cdot_float" ? gap_of_cdot<float>(made, steps)
                                              : gap_of_cdot<double>(made, steps);
  fmt::print("{} {}: {:.4g} m\n", engine, arguments[2], gap);
}
