// Cdot itself, in the plane where the problem is planar; and, as an engine of its own, planar problems in space,
// since the others that know only space have no choice.
#include <functional>
#include <string>

#include "runtime/spatial.hpp"
#include "runtime/world.hpp"
#include "tests/bench/peers/geometry.hpp"

namespace cdot::peers {
namespace {

BodyDefinition definition(const Planar<double>*, const Body& body) {
  const State& s = body.start;
  return {.x = s.x[0],
          .y = s.x[1],
          .angle = angle(s.q),
          .vx = s.v[0],
          .vy = s.v[1],
          .w = s.w[2],
          .mass = body.mass,
          .inertia = body.inertia[2]};
}

SpatialBodyDefinition definition(const Spatial<double>*, const Body& body) {
  const State& s = body.start;
  return {.x = s.x[0],
          .y = s.x[1],
          .z = s.x[2],
          .e0 = s.q[0],
          .e1 = s.q[1],
          .e2 = s.q[2],
          .e3 = s.q[3],
          .vx = s.v[0],
          .vy = s.v[1],
          .vz = s.v[2],
          .wx = s.w[0],
          .wy = s.w[1],
          .wz = s.w[2],
          .mass = body.mass,
          .inertia = {.xx = body.inertia[0], .yy = body.inertia[1], .zz = body.inertia[2]}};
}

NamedValue planar_value(const char* name, const Vec3& u) { return {name, {u[0], u[1]}}; }
NamedValue spatial_value(const char* name, const Vec3& u) { return {name, {u[0], u[1], u[2]}}; }

JointDefinition definition(const Planar<double>*, const Problem& problem, const Joint& joint) {
  JointDefinition d;
  d.parameters = {planar_value("pa", local_point(problem, joint.a, joint.anchor)),
                  planar_value("pb", local_point(problem, joint.b, joint.anchor))};
  d.type = joint.kind == JointKind::prismatic ? "prismatic" : "revolute";
  if (joint.kind == JointKind::prismatic) {
    const Vec3 normal{-joint.axis[1], joint.axis[0], 0};
    d.parameters.push_back(planar_value("t", local_direction(problem, joint.b, normal)));
  }
  return d;
}

JointDefinition definition(const Spatial<double>*, const Problem& problem, const Joint& joint) {
  JointDefinition d;
  d.parameters = {spatial_value("pa", local_point(problem, joint.a, joint.anchor)),
                  spatial_value("pb", local_point(problem, joint.b, joint.anchor))};
  d.type = joint.kind == JointKind::prismatic   ? "prismatic"
           : joint.kind == JointKind::spherical ? "spherical"
                                                : "revolute";
  if (joint.kind != JointKind::spherical)
    d.parameters.push_back(spatial_value("fa", local_direction(problem, joint.a, joint.axis)));
  return d;
}

State state_of(const planar::Pose<double>& q, const planar::Velocity<double>& v) {
  return {{q.x, q.y, 0}, about_z(q.angle), {v.x, v.y, 0}, {0, 0, v.w}};
}
State state_of(const spatial::Pose<double>& q, const spatial::Velocity<double>& v) {
  return {{q.x, q.y, q.z}, {q.e0, q.e1, q.e2, q.e3}, {v.x, v.y, v.z}, {v.wx, v.wy, v.wz}};
}

template <class S>
BasicWorld<S> build(const Problem& problem, Settings settings) {
  constexpr const S* space = nullptr;
  settings.gravity_x = problem.gravity[0];
  settings.gravity_y = problem.gravity[1];
  settings.gravity_z = problem.gravity[2];
  BasicWorld<S> made(settings);
  for (const Body& body : problem.bodies) made.add_body(definition(space, body));
  for (const Joint& joint : problem.joints) {
    JointDefinition d = definition(space, problem, joint);
    for (const int body : {joint.a, joint.b}) d.bodies.push_back(body == world ? made.ground() : body);
    made.add_joint(d);
  }
  made.prepare();
  return made;
}

template <class S>
class CdotRun final : public SteppedRun {
 public:
  CdotRun(const Problem& problem, const Settings& settings, double h)
      : SteppedRun(h), world_(build<S>(problem, settings)) {}
  State state(int body) const override { return state_of(world_.pose(body), world_.velocity(body)); }

 private:
  void step() override { world_.step(h()); }
  BasicWorld<S> world_;
};

// One row per way to use the runtime: what differs from a scene that says nothing.
struct Way {
  const char* name;
  const char* changed;
  std::function<void(Settings&)> set;
};

std::vector<Way> ways() {
  return {
      {"direct, Euler", "", [](Settings&) {}},
      {"direct, Euler, Baumgarte", "drift = baumgarte", [](Settings& s) { s.drift = Drift::baumgarte; }},
      {"iterative, 10 iterations", "solver = iterative", [](Settings& s) { s.solver = Solver::iterative; }},
  };
}

template <class S>
std::vector<Series> series_in(const Problem& problem) {
  std::vector<Series> all;
  for (const Way& way : ways()) {
    Settings settings;
    way.set(settings);
    all.push_back({way.name, way.changed, "h", steps(problem),
                   [&problem, settings](double h) { return std::make_unique<CdotRun<S>>(problem, settings, h); }});
  }
  return all;
}

std::vector<Series> series(const Problem& problem) {
  return problem.planar ? series_in<Planar<double>>(problem) : series_in<Spatial<double>>(problem);
}

std::vector<Series> series_in_space(const Problem& problem) {
  if (!problem.planar) return {};
  return series_in<Spatial<double>>(problem);
}

const Registration registration{{"Cdot", CDOT_VERSION, "double", "#d1242f", "", series}};
const Registration in_space{
    {"Cdot in space", CDOT_VERSION, "double", "#f0883e", "planar problems posed in space", series_in_space}};

}  // namespace
}  // namespace cdot::peers
