// The table of problems, and the way from a scene to a problem that any engine can be asked.
#include "tests/bench/peers/problem.hpp"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "runtime/scene.hpp"
#include "runtime/spatial.hpp"
#include "tests/bench/peers/geometry.hpp"

namespace cdot::peers {
namespace {

constexpr int samples = 4;

Body body_of(const SceneBody& source, const planar::Pose<double>& q) {
  const BodyDefinition& d = source.definition;
  return {source.name,
          d.mass,
          {d.inertia, d.inertia, d.inertia},
          {{q.x, q.y, 0}, about_z(q.angle), {d.vx, d.vy, 0}, {0, 0, d.w}}};
}

Body body_of(const SceneBody& source, const spatial::Pose<double>& q) {
  const SpatialBodyDefinition& d = source.spatial;
  const Inertia& I = d.inertia;
  if (I.xy != 0 || I.xz != 0 || I.yz != 0)
    throw std::runtime_error(source.name + ": the axes of the body are not principal axes");
  return {source.name,
          d.mass,
          {I.xx, I.yy, I.zz},
          {{q.x, q.y, q.z}, {q.e0, q.e1, q.e2, q.e3}, {d.vx, d.vy, d.vz}, {d.wx, d.wy, d.wz}}};
}

// The numbers of one of the joint's parameters.
template <class S>
Vec3 parameter(const BasicWorld<S>& built, int joint, std::string_view name) {
  for (const ParameterInfo& info : built.joint_type(joint).parameters) {
    if (info.name != name) continue;
    const std::vector<double> all = built.joint_parameters(joint);
    const auto at = all.begin() + info.offset;
    return {at[0], at[1], S::dimension == Dimension::spatial ? at[2] : 0};
  }
  throw std::runtime_error(fmt::format("no parameter {}", name));
}

// What is fixed in a body, in world axes.
Vec3 world_direction(const Problem& problem, int body, const Vec3& u) {
  return body == world ? u : turned(problem.bodies[std::size_t(body)].start.q, u);
}

template <class S>
Joint joint_of(const Problem& problem, const BasicWorld<S>& built, const SceneJoint& source, int index) {
  const std::string& type = source.definition.type;
  const bool planar = S::dimension == Dimension::planar;
  if (type != "revolute" && type != "prismatic" && (planar || type != "spherical"))
    throw std::runtime_error(type + ": no adapter knows this joint");
  const int a = source.definition.bodies[0], b = source.definition.bodies[1];
  Joint joint{type == "revolute"    ? JointKind::revolute
              : type == "prismatic" ? JointKind::prismatic
                                    : JointKind::spherical,
              a, b};
  joint.anchor = world_direction(problem, a, parameter(built, index, "pa"));
  if (a != world) joint.anchor = joint.anchor + problem.bodies[std::size_t(a)].start.x;
  if (planar) {
    joint.axis = {0, 0, 1};
    if (joint.kind == JointKind::prismatic) {
      const Vec3 normal = world_direction(problem, b, parameter(built, index, "t"));
      joint.axis = {normal[1], -normal[0], 0};
    }
  } else if (joint.kind != JointKind::spherical) {
    joint.axis = world_direction(problem, a, parameter(built, index, "fa"));
  }
  return joint;
}

template <class S>
void fill(Problem& problem, const Scene& scene) {
  const BasicWorld<S> built = build_world_in<S>(scene);
  for (std::size_t k = 0; k < scene.bodies.size(); ++k)
    problem.bodies.push_back(body_of(scene.bodies[k], built.pose(int(k))));
  for (std::size_t k = 0; k < scene.joints.size(); ++k)
    problem.joints.push_back(joint_of(problem, built, scene.joints[k], int(k)));
}

Vec3 vec3(const nlohmann::json& from, std::size_t at) { return {from[at], from[at + 1], from[at + 2]}; }

State state_of(const nlohmann::json& from) {
  return {vec3(from, 0), {from[3], from[4], from[5], from[6]}, vec3(from, 7), vec3(from, 10)};
}

}  // namespace

const std::vector<ProblemRow>& problem_rows() {
  static const std::vector<ProblemRow> rows = {
      {"double_pendulum", "Double pendulum", "double_pendulum", 2, Measure::place},
      {"chain_10", "Chain of ten links", "chain_10", 2, Measure::place},
      {"slider_crank", "Slider crank", "slider_crank", 0.2, Measure::place},
      {"four_bar", "Four-bar linkage", "crank_rocker", 2, Measure::place},
      {"spatial_chain", "Chain of ten links in space", "spatial/chain_10", 2, Measure::place},
      {"torque_free_body", "Torque-free body", "spatial/torque_free_body", 10, Measure::orientation},
      {"gyroscope", "Gyroscope", "spatial/gyroscope", 2, Measure::place},
  };
  return rows;
}

Problem pose(const ProblemRow& row) {
  const Scene scene = read_scene(fmt::format("{}/specs/scenes/{}.toml", CDOT_SOURCE_DIR, row.scene));
  Problem problem;
  problem.name = row.name;
  problem.title = row.title;
  problem.scene = row.scene;
  problem.planar = scene.dimension == Dimension::planar;
  problem.gravity = {scene.settings.gravity_x, scene.settings.gravity_y, scene.settings.gravity_z};
  problem.duration = row.duration;
  problem.measure = row.measure;
  for (int k = 1; k <= samples; ++k) problem.times.push_back(row.duration * k / samples);
  if (problem.planar)
    fill<Planar<double>>(problem, scene);
  else
    fill<Spatial<double>>(problem, scene);
  return problem;
}

std::string reference_file(const std::string& problem) {
  return fmt::format("{}/tests/bench/peers/references/{}.json", CDOT_SOURCE_DIR, problem);
}

Problem load(const ProblemRow& row) {
  Problem problem = pose(row);
  std::ifstream in(reference_file(problem.name));
  if (!in) throw std::runtime_error(reference_file(problem.name) + ": no such file");
  const nlohmann::json json = nlohmann::json::parse(in);
  for (const nlohmann::json& sample : json.at("samples")) {
    const std::size_t k = problem.reference.size();
    if (k >= problem.times.size() || sample.at("t") != problem.times[k])
      throw std::runtime_error(reference_file(problem.name) + ": other times");
    std::vector<State> states;
    for (const Body& body : problem.bodies) states.push_back(state_of(sample.at("bodies").at(body.name)));
    problem.reference.push_back(states);
  }
  return problem;
}

std::vector<State> starts(const Problem& problem) {
  std::vector<State> all;
  for (const Body& body : problem.bodies) all.push_back(body.start);
  return all;
}

Totals totals(const Problem& problem, const std::vector<State>& states) {
  Totals sum;
  for (std::size_t k = 0; k < states.size(); ++k) {
    const Body& body = problem.bodies[k];
    const State& s = states[k];
    const Vec3 w = turned(conjugate(s.q), s.w);
    const Vec3 spin{body.inertia[0] * w[0], body.inertia[1] * w[1], body.inertia[2] * w[2]};
    const Vec3 p = body.mass * s.v;
    sum.momentum = sum.momentum + p;
    sum.angular_momentum = sum.angular_momentum + turned(s.q, spin) + cross(s.x, p);
    sum.kinetic += 0.5 * (dot(p, s.v) + dot(spin, w));
    sum.potential -= body.mass * dot(problem.gravity, s.x);
  }
  return sum;
}

}  // namespace cdot::peers
