// The table of problems; a scene -> a problem for every engine.
#include "tests/bench/peers/problem.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include <cdot/spatial.hpp>

#include "runtime/tool/scene/scene.hpp"
#include "tests/bench/peers/geometry.hpp"

namespace cdot::peers {
namespace {

constexpr int samples = 4;

State state_of(const planar::Place& q, const planar::Velocity<double>& v) {
  return {{q.x, q.y, 0}, about_z(q.angle), {v.x, v.y, 0}, {0, 0, v.w}};
}
State state_of(const spatial::Place& q, const spatial::Velocity<double>& v) {
  return {{q.x, q.y, q.z}, {q.e0, q.e1, q.e2, q.e3}, {v.x, v.y, v.z}, {v.wx, v.wy, v.wz}};
}

void take(const BodyDefinition& d, Body& body) {
  body.mass = d.mass;
  body.inertia = {d.inertia, d.inertia, d.inertia};
  body.torque = {0, 0, d.torque};
}
void take(const SpatialBodyDefinition& d, Body& body) {
  const Inertia& I = d.inertia;
  if (I.xy != 0 || I.xz != 0 || I.yz != 0)
    throw std::runtime_error(body.name + ": the axes of the body are not principal axes");
  body.mass = d.mass;
  body.inertia = {I.xx, I.yy, I.zz};
  body.torque = {d.torque_x, d.torque_y, d.torque_z};
}

const BodyDefinition& definition(const SceneBody& source, const Planar<double>*) { return source.definition; }
const SpatialBodyDefinition& definition(const SceneBody& source, const Spatial<double>*) { return source.spatial; }

double force_on(const BodyDefinition& d) { return std::hypot(d.force_x, d.force_y); }
double force_on(const SpatialBodyDefinition& d) { return std::hypot(d.force_x, d.force_y, d.force_z); }

template <class S>
Body body_of(const BasicWorld<S>& built, const SceneBody& source, int number) {
  const auto& d = definition(source, static_cast<const S*>(nullptr));
  Body body;
  body.name = source.name;
  body.number = number;
  body.start = state_of(built.place(number), built.velocity(number));
  take(d, body);
  if (force_on(d) != 0) throw CannotSay(source.name + ": no adapter knows a force on a body");
  if (d.linear_damping != d.angular_damping) throw CannotSay(source.name + ": no adapter knows two dampings of a body");
  body.damping = d.linear_damping;
  return body;
}

// Up to three numbers of one of the joint's parameters.
template <class S>
Vec3 parameter(const BasicWorld<S>& built, int joint, std::string_view name, int from = 0) {
  for (const ParameterInfo& info : built.joint_type(joint).parameters) {
    if (info.name != name) continue;
    const std::vector<double> all = built.joint_parameters(joint);
    const auto at = all.begin() + info.offset + from, end = all.end();
    Vec3 numbers{};  // may include numbers of the next parameter, which are not used
    std::copy_n(at, std::min<std::ptrdiff_t>(end - at, S::dimension == Dimension::spatial ? 3 : 2), numbers.begin());
    return numbers;
  }
  throw std::runtime_error(fmt::format("no parameter {}", name));
}

// A vector fixed in a body of the World, in world axes.
template <class S>
Vec3 world_direction(const BasicWorld<S>& built, int body, const Vec3& u) {
  return turned(state_of(built.place(body), built.velocity(body)).q, u);
}

template <class S>
Vec3 anchor_of(const BasicWorld<S>& built, int joint, int body, const char* name) {
  const State s = state_of(built.place(body), built.velocity(body));
  return s.x + turned(s.q, parameter(built, joint, name));
}

JointKind kind_of(std::string_view type, Dimension dimension) {
  static const std::map<std::string_view, JointKind> kinds{{"revolute", JointKind::revolute},
                                                           {"hinge", JointKind::revolute},
                                                           {"prismatic", JointKind::prismatic},
                                                           {"slider", JointKind::prismatic},
                                                           {"spherical", JointKind::spherical},
                                                           {"weld", JointKind::fixed},
                                                           {"fixed", JointKind::fixed},
                                                           {"distance", JointKind::distance},
                                                           {"max_distance", JointKind::max_distance},
                                                           {"angle", JointKind::orientation},
                                                           {"relative_orientation", JointKind::orientation},
                                                           {"universal", JointKind::universal},
                                                           {"six_dof", JointKind::six_dof},
                                                           {"pulley", JointKind::pulley},
                                                           {"bushing", JointKind::mount},
                                                           {"rough_line", JointKind::contact},
                                                           {"rough_plane", JointKind::contact}};
  const auto found = kinds.find(type);
  if (found == kinds.end() || (found->second == JointKind::spherical && dimension == Dimension::planar))
    throw CannotSay(fmt::format("{}: no adapter knows this joint", type));
  return found->second;
}

// An immovable body is the world.
int index_of(const Problem& problem, int number) {
  const auto at = std::lower_bound(problem.bodies.begin(), problem.bodies.end(), number,
                                   [](const Body& body, int wanted) { return body.number < wanted; });
  return at != problem.bodies.end() && at->number == number ? int(at - problem.bodies.begin()) : world;
}

// The axes of a joint with several rotations, perpendicular at the start.
template <class S>
std::vector<Turn> turns_of(const BasicWorld<S>& built, int number, JointKind kind) {
  const std::vector<int> bodies = built.joint_bodies(number);
  const auto axis = [&](int body, const char* frame, int k) {
    return Turn{world_direction(built, body, parameter(built, number, frame, 3 * k)), false, {}};
  };
  const int a = bodies.at(0), b = bodies.at(1);
  if (kind == JointKind::universal) return {axis(a, "fa", 1), axis(b, "fb", 2)};
  for (int k = 0; k < 3; ++k)
    if (norm(axis(a, "fa", k).axis - axis(b, "fb", k).axis) > 1e-12)
      throw CannotSay("adapters know joints of six degrees that start unturned");
  return {axis(a, "fa", 0), axis(a, "fa", 1), axis(a, "fa", 2)};
}

template <class S>
void take_rope(const BasicWorld<S>& built, int number, Joint& joint) {
  joint.wheel = parameter(built, number, "ga");
  joint.wheel_b = parameter(built, number, "gb");
  if (S::dimension == Dimension::planar) joint.wheel[2] = joint.wheel_b[2] = 0;
  joint.ratio = parameter(built, number, "ratio")[0];
  joint.length = parameter(built, number, "length")[0];
}

template <class S>
Joint joint_of(const Problem& problem, const BasicWorld<S>& built, int number) {
  const bool planar = S::dimension == Dimension::planar;
  const std::vector<int> bodies = built.joint_bodies(number);
  const int a = bodies.at(0), b = bodies.at(1);
  Joint joint;
  joint.number = number;
  joint.kind = kind_of(built.joint_type(number).name, S::dimension);
  joint.a = index_of(problem, a);
  joint.b = index_of(problem, b);
  if (joint.kind == JointKind::orientation) return joint;
  joint.anchor = anchor_of(built, number, a, "pa");
  joint.anchor_b = anchor_of(built, number, b, "pb");
  if (joint.kind == JointKind::prismatic) joint.anchor_b = joint.anchor;  // differ by the slide
  if (joint.kind == JointKind::distance || joint.kind == JointKind::max_distance)
    joint.length = parameter(built, number, "l")[0];
  if (joint.kind == JointKind::pulley) take_rope(built, number, joint);
  if (joint.kind == JointKind::universal || joint.kind == JointKind::six_dof)
    joint.turns = turns_of(built, number, joint.kind);
  if (joint.kind == JointKind::contact) {
    joint.friction = parameter(built, number, "mu")[0];
    joint.axis = parameter(built, number, planar ? "n" : "f");
    if (planar) joint.axis[2] = 0;
    if (joint.b != world) throw CannotSay("no adapter knows a contact of two bodies");
  } else if (joint.kind == JointKind::mount) {
    const auto of = [&](const char* name) { return parameter(built, number, name)[0]; };
    joint.mount = planar ? Mount{of("kx"), of("ky"), of("k_turn"), of("k_turn")}
                         : Mount{of("k_along"), of("k_across"), of("k_twist"), of("k_bend")};
    Vec3 axis = parameter(built, number, "fa");
    if (planar) axis[2] = 0;
    joint.axis = world_direction(built, a, axis);
  } else if (planar) {
    joint.axis = {0, 0, 1};
    if (joint.kind == JointKind::prismatic) {
      const Vec3 normal = world_direction(built, b, parameter(built, number, "t"));
      joint.axis = {-normal[1], normal[0], 0};  // of b from a, against which the slide of a counts
    }
  } else if (joint.kind == JointKind::revolute || joint.kind == JointKind::prismatic) {
    joint.axis = world_direction(built, a, parameter(built, number, "fa"));
  }
  return joint;
}

// True if all joints of the body act at its centre, so its torque is 0.
bool held_at_centre(const Problem& problem, int body) {
  return std::all_of(problem.joints.begin(), problem.joints.end(), [&](const Joint& joint) {
    if (joint.a != body && joint.b != body) return true;
    const Vec3 at = (joint.a == body ? joint.anchor : joint.anchor_b) - problem.bodies[std::size_t(body)].start.x;
    return (joint.kind == JointKind::revolute || joint.kind == JointKind::spherical) && norm(at) == 0;
  });
}

// Without torque the inertia of the body is irrelevant.
void hold_orientation(Problem& problem, int body) {
  Body& made = problem.bodies[std::size_t(body)];
  made.turns = held_at_centre(problem, body);
  made.inertia = {made.mass, made.mass, made.mass};
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
  problem.sleep_after = scene.settings.sleep_after;
  for (std::size_t k = 0; k < scene.bodies.size(); ++k)
    if (!scene.bodies[k].is_static) problem.bodies.push_back(body_of(built, scene.bodies[k], int(k)));
  if (!scene.springs.empty()) throw CannotSay("no adapter knows springs between points");
  for (int k = 0; k < built.joint_count(); ++k) {
    if (built.broken(k)) continue;
    const Joint joint = joint_of(problem, built, k);
    if (joint.a == world && joint.b == world) continue;  // without influence
    problem.joints.push_back(joint);
    if (k < int(scene.joints.size())) take_given(scene.joints[std::size_t(k)], problem, problem.joints.back());
  }
  for (std::size_t k = 0; k < problem.bodies.size(); ++k) {
    const SceneBody& source = scene.bodies[std::size_t(problem.bodies[k].number)];
    if (definition(source, static_cast<const S*>(nullptr)).fixed_rotation) hold_orientation(problem, int(k));
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
