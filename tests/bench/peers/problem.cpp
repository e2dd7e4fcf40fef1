// The table of problems, and the way from a scene to a problem that any engine can be asked.
#include "tests/bench/peers/problem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "runtime/scene.hpp"
#include "runtime/spatial.hpp"
#include "tests/bench/peers/geometry.hpp"

namespace cdot::peers {
namespace {

constexpr int samples = 4;

Body body_of(const SceneBody& source, const planar::Place& q, const planar::Velocity<double>& v) {
  const BodyDefinition& d = source.definition;
  return {source.name,
          d.mass,
          {d.inertia, d.inertia, d.inertia},
          {{q.x, q.y, 0}, about_z(q.angle), {v.x, v.y, 0}, {0, 0, v.w}}};
}

Body body_of(const SceneBody& source, const spatial::Place& q, const spatial::Velocity<double>& v) {
  const SpatialBodyDefinition& d = source.spatial;
  const Inertia& I = d.inertia;
  if (I.xy != 0 || I.xz != 0 || I.yz != 0)
    throw std::runtime_error(source.name + ": the axes of the body are not principal axes");
  return {source.name,
          d.mass,
          {I.xx, I.yy, I.zz},
          {{q.x, q.y, q.z}, {q.e0, q.e1, q.e2, q.e3}, {v.x, v.y, v.z}, {v.wx, v.wy, v.wz}}};
}

// The numbers of one of the joint's parameters.
template <class S>
Vec3 parameter(const BasicWorld<S>& built, int joint, std::string_view name) {
  for (const ParameterInfo& info : built.joint_type(joint).parameters) {
    if (info.name != name) continue;
    const std::vector<double> all = built.joint_parameters(joint);
    const auto at = all.begin() + info.offset, end = all.end();
    Vec3 numbers{};  // up to three; those of the next parameter do no harm
    std::copy_n(at, std::min<std::ptrdiff_t>(end - at, S::dimension == Dimension::spatial ? 3 : 2), numbers.begin());
    return numbers;
  }
  throw std::runtime_error(fmt::format("no parameter {}", name));
}

// What is fixed in a body, in world axes.
Vec3 world_direction(const Problem& problem, int body, const Vec3& u) {
  return body == world ? u : turned(problem.bodies[std::size_t(body)].start.q, u);
}

template <class S>
Vec3 anchor_of(const Problem& problem, const BasicWorld<S>& built, int joint, int body, const char* name) {
  const Vec3 p = world_direction(problem, body, parameter(built, joint, name));
  return body == world ? p : p + problem.bodies[std::size_t(body)].start.x;
}

JointKind kind_of(const SceneJoint& source, Dimension dimension) {
  static const std::map<std::string, JointKind> kinds{
      {"revolute", JointKind::revolute},   {"hinge", JointKind::revolute},
      {"prismatic", JointKind::prismatic}, {"spherical", JointKind::spherical},
      {"weld", JointKind::fixed},          {"fixed", JointKind::fixed},
      {"distance", JointKind::distance},   {"max_distance", JointKind::max_distance}};
  const auto found = kinds.find(source.definition.type);
  if (found == kinds.end() || (found->second == JointKind::spherical && dimension == Dimension::planar))
    throw CannotSay(source.definition.type + ": no adapter knows this joint");
  if (source.breaking || source.definition.soft)
    throw CannotSay(source.name + ": no adapter knows soft or breaking joints");
  return found->second;
}

// Of a hinge; motors of any strength are not comparable.
void take_effects(const SceneJoint& source, Joint& joint) {
  for (const SceneEffects& effects : source.effects) {
    const bool strong = effects.motor && !std::isfinite(effects.motor->max_force);
    if (joint.kind != JointKind::revolute || !effects.springs.empty() || effects.friction || strong)
      throw CannotSay(source.name + ": no adapter knows its spring, friction, or motor of any strength");
    if (effects.motor) joint.motor = {effects.motor->speed, effects.motor->max_force};
    if (effects.limit) joint.stops = {effects.limit->lower.value(), effects.limit->upper.value()};
  }
}

template <class S>
Joint joint_of(const Problem& problem, const BasicWorld<S>& built, const SceneJoint& source, int index) {
  const bool planar = S::dimension == Dimension::planar;
  const int a = source.definition.bodies[0], b = source.definition.bodies[1];
  Joint joint;
  joint.kind = kind_of(source, S::dimension);
  joint.a = a;
  joint.b = b;
  joint.anchor = anchor_of(problem, built, index, a, "pa");
  joint.anchor_b = anchor_of(problem, built, index, b, "pb");
  if (joint.kind == JointKind::prismatic) joint.anchor_b = joint.anchor;  // apart by what it has slid
  take_effects(source, joint);
  if (joint.kind == JointKind::distance || joint.kind == JointKind::max_distance)
    joint.length = parameter(built, index, "l")[0];
  if (planar) {
    joint.axis = {0, 0, 1};
    if (joint.kind == JointKind::prismatic) {
      const Vec3 normal = world_direction(problem, b, parameter(built, index, "t"));
      joint.axis = {normal[1], -normal[0], 0};
    }
  } else if (joint.kind == JointKind::revolute || joint.kind == JointKind::prismatic) {
    joint.axis = world_direction(problem, a, parameter(built, index, "fa"));
  }
  return joint;
}

bool pushed(const BodyDefinition& d) { return d.force_x != 0 || d.force_y != 0 || d.torque != 0; }
bool pushed(const SpatialBodyDefinition& d) {
  return norm({d.force_x, d.force_y, d.force_z}) + norm({d.torque_x, d.torque_y, d.torque_z}) > 0;
}

// Whether all that holds it goes through its centre, so that nothing turns it.
bool held_at_centre(const Problem& problem, int body) {
  return std::all_of(problem.joints.begin(), problem.joints.end(), [&](const Joint& joint) {
    if (joint.a != body && joint.b != body) return true;
    const Vec3 at = (joint.a == body ? joint.anchor : joint.anchor_b) - problem.bodies[std::size_t(body)].start.x;
    return (joint.kind == JointKind::revolute || joint.kind == JointKind::spherical) && norm(at) == 0;
  });
}

// A body that cannot turn: where nothing turns it, one with any inertia moves the same.
template <class Definition>
void check(const SceneBody& source, const Definition& d, Problem& problem, int body) {
  if (source.is_static) throw CannotSay(source.name + ": no adapter knows a body that is static");
  if (pushed(d)) throw CannotSay(source.name + ": no adapter knows a force on a body");
  if (!d.fixed_rotation) return;
  Body& made = problem.bodies[std::size_t(body)];
  made.turns = held_at_centre(problem, body);
  made.inertia = {d.mass, d.mass, d.mass};
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

template <class S>
Problem problem_of(const Scene& scene, const BasicWorld<S>& built) {
  Problem problem;
  problem.planar = S::dimension == Dimension::planar;
  problem.gravity = {scene.settings.gravity_x, scene.settings.gravity_y, scene.settings.gravity_z};
  for (std::size_t k = 0; k < scene.bodies.size(); ++k)
    problem.bodies.push_back(body_of(scene.bodies[k], built.place(int(k)), built.velocity(int(k))));
  if (!scene.springs.empty()) throw CannotSay("no adapter knows springs");
  for (std::size_t k = 0; k < scene.joints.size(); ++k)
    problem.joints.push_back(joint_of(problem, built, scene.joints[k], int(k)));
  for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
    if constexpr (S::dimension == Dimension::planar)
      check(scene.bodies[k], scene.bodies[k].definition, problem, int(k));
    else
      check(scene.bodies[k], scene.bodies[k].spatial, problem, int(k));
  }
  return problem;
}
template Problem problem_of(const Scene&, const BasicWorld<Planar<double>>&);
template Problem problem_of(const Scene&, const BasicWorld<Spatial<double>>&);

Problem pose(const ProblemRow& row) {
  const Scene scene = read_scene(fmt::format("{}/specs/scenes/{}.toml", CDOT_SOURCE_DIR, row.scene));
  Problem problem = scene.dimension == Dimension::planar ? problem_of(scene, build_world_in<Planar<double>>(scene))
                                                         : problem_of(scene, build_world_in<Spatial<double>>(scene));
  problem.name = row.name;
  problem.title = row.title;
  problem.scene = row.scene;
  problem.duration = row.duration;
  problem.measure = row.measure;
  for (int k = 1; k <= samples; ++k) problem.times.push_back(row.duration * k / samples);
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
