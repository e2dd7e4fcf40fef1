// The [[joint]] and [[spring]] entries of a scene. Which parameters and coordinates a joint has is
// asked of the table of joint types; nothing here knows a joint by name.
#include <cmath>
#include <fmt/format.h>
#include <map>

#include "runtime/tool/scene/read.hpp"

namespace cdot {
namespace {

constexpr const char* soft_example = "{ frequency = 2, damping_ratio = 0.5 }";

// "the point pa on body a", "the direction t on the world", "the scalar l [m]"
std::string described(const ParameterInfo& parameter) {
  if (parameter.kind == ParameterKind::scalar) return fmt::format("the scalar {} [{}]", parameter.name, parameter.unit);
  const bool on_world = parameter.body < 0;
  return fmt::format("the {} {} on {}", parameter.kind == ParameterKind::point ? "point" : "direction", parameter.name,
                     on_world ? "the world" : fmt::format("body {}", static_cast<char>('a' + parameter.body)));
}

std::string number_named(std::size_t count) { return fmt::format("{} {}", count, count == 1 ? "is" : "are"); }

const JointType* read_type(Entry& joint, Dimension dimension) {
  joint.required("type", "type = \"revolute\"");
  const std::optional<std::string> name = joint.text("type");
  if (!name) return nullptr;
  const JointType* type = find_joint_type(dimension, *name);
  if (type) return type;
  std::vector<std::string> known;
  for (const JointType& other : joint_types(dimension)) known.emplace_back(other.name);
  const bool in_space = dimension == Dimension::spatial;
  const bool elsewhere = find_joint_type(in_space ? Dimension::planar : Dimension::spatial, *name) != nullptr;
  joint.error(joint.where("type"),
              elsewhere ? fmt::format("\"{}\" is a joint {}, and this scene is {}", *name,
                                      in_space ? "of the plane" : "in space", in_space ? "in space" : "planar")
                        : fmt::format("no joint is called \"{}\"", *name),
              elsewhere ? "`cdot-run list` shows the joints of both" : did_you_mean(*name, known));
  return nullptr;
}

// The bodies in the order of the spec; nothing if their number is wrong.
std::optional<std::vector<int>> read_joint_bodies(Entry& joint, const JointType& type, const BodyNames& names) {
  const bool one = type.bodies == 1;
  joint.required("bodies", one ? "bodies = [\"rod\"]" : "bodies = [\"world\", \"rod\"]");
  const std::optional<std::vector<int>> bodies = names.find(joint, "bodies");
  if (!bodies) return {};
  if (static_cast<int>(bodies->size()) != type.bodies) {
    joint.error(joint.where("bodies"), fmt::format("a joint of type {} has {} {}, but {} named", type.name, type.bodies,
                                                   one ? "body" : "bodies", number_named(bodies->size())));
    return {};
  }
  if (type.bodies == 2 && (*bodies)[0] == (*bodies)[1]) {
    joint.error(joint.where("bodies"), fmt::format("a joint between \"{}\" and itself", names.name((*bodies)[0])));
    return {};
  }
  return bodies;
}

// [[x, y, z], [x, y, z]]: the x axis of a triad, and where its y axis roughly points.
std::optional<std::vector<double>> read_two_axes(Entry& joint, const std::string& key) {
  const auto numbers = joint.rows(key, 2);
  if (!numbers) return {};
  const std::vector<double>& n = *numbers;
  const double x = n[1] * n[5] - n[2] * n[4], y = n[2] * n[3] - n[0] * n[5], z = n[0] * n[4] - n[1] * n[3];
  if (std::hypot(x, y, z) == 0)
    joint.error(joint.where(key), fmt::format("the two axes of `{}` are parallel", key), "[[1, 0, 0], [0, 1, 0]]");
  return numbers;
}

// The numbers of one parameter in the frame of its body; nothing if it is left to its default, or
// wrong.
std::optional<std::vector<double>> read_parameter(Entry& joint, const ParameterInfo& parameter, int body,
                                                  std::optional<Vec3> at, const BodyNames& names) {
  const std::string key(parameter.name);
  if (parameter.kind == ParameterKind::scalar) {
    const std::optional<double> value = joint.number(key, {Sign::any, parameter.unit == "rad"});
    return value ? std::optional(std::vector<double>{*value}) : std::nullopt;
  }
  const bool in_space = names.dimension() == Dimension::spatial;
  if (in_space && parameter.kind == ParameterKind::frame && joint.is_array_of_arrays(key))
    return read_two_axes(joint, key);
  std::optional<Vec3> vector;
  if (parameter.kind == ParameterKind::point) {
    vector = read_point(joint, key, body, names);
    if (!joint.has(key) && at) vector = names.to_body(body, *at);
  } else {
    vector = read_direction(joint, key, body, names);
    const bool direction = parameter.kind != ParameterKind::vector;
    if (direction && vector && std::hypot((*vector)[0], (*vector)[1], (*vector)[2]) == 0) {
      joint.error(joint.where(key), fmt::format("the direction `{}` has length 0", key),
                  in_space ? "any other length will do: [1, 0, 0]" : "any other length will do: [1, 0]");
    }
  }
  if (!vector) return {};
  return std::vector<double>(vector->begin(), vector->begin() + (in_space ? 3 : 2));
}

void read_parameters(Entry& joint, const JointType& type, const BodyNames& names, JointDefinition& definition) {
  const std::optional<Vec3> at = read_vector(joint, "at", names.dimension());
  const bool in_space = names.dimension() == Dimension::spatial;
  bool has_point = false;
  for (const ParameterInfo& parameter : type.parameters) {
    const bool on_body = parameter.body >= 0;
    const int body = on_body ? definition.bodies[static_cast<std::size_t>(parameter.body)] : world_body;
    const bool point = parameter.kind == ParameterKind::point;
    const bool scalar = parameter.kind == ParameterKind::scalar;
    const bool given = joint.has(std::string(parameter.name)) || (point && joint.has("at"));
    has_point = has_point || point;
    if (const auto numbers = read_parameter(joint, parameter, body, at, names)) {
      definition.parameters.push_back({std::string(parameter.name), *numbers});
    } else if (!given && !parameter.has_default) {
      joint.error(joint.header(), fmt::format("{} has no `{}`: {}", joint.what(), parameter.name, described(parameter)),
                  point    ? fmt::format("{0} = [{1}] in the frame of its body, {0} = {{ world = [{1}] }}, "
                                            "or at = [{1}]",
                                         parameter.name, in_space ? "x, y, z" : "x, y")
                  : scalar ? fmt::format("{} = 1", parameter.name)
                           : fmt::format("{} = [{}]", parameter.name, in_space ? "1, 0, 0" : "1, 0"));
    }
  }
  if (joint.has("at") && !has_point) {
    joint.error(joint.where("at"), fmt::format("a joint of type {} has no points that `at` could place", type.name));
  }
}

// [lower, upper] or { lower = …, upper = … }
std::optional<Limit> read_limit(Entry& effects, Quantity quantity) {
  Limit limit;
  if (std::optional<Entry> table = effects.table("limit")) {
    limit.lower = table->number("lower", quantity);
    limit.upper = table->number("upper", quantity);
    if (!table->has("lower") && !table->has("upper"))
      table->error(table->header(), "a limit without `lower` or `upper`");
    table->close();
  } else if (effects.has("limit") && !effects.is_array("limit")) {
    effects.error(effects.where("limit"), "`limit` needs two ends", "[lower, upper], { lower = 0 } or { upper = 1 }");
  } else if (const auto both = effects.numbers("limit", 2, quantity)) {
    limit = {(*both)[0], (*both)[1]};
  }
  if (limit.lower && limit.upper && *limit.lower > *limit.upper) {
    effects.error(effects.where("limit"),
                  fmt::format("the lower limit {:.6g} is above the upper limit {:.6g}", *limit.lower, *limit.upper));
  }
  if (!limit.lower && !limit.upper) return {};
  return limit;
}

std::optional<Motor> read_motor(Entry& effects, Quantity quantity) {
  std::optional<Entry> table = effects.table("motor", "{ speed = 2, max = 10 }");
  if (!table) return {};
  Motor motor;
  table->required("speed", "speed = 2.0");
  motor.speed = table->number("speed", quantity).value_or(0);
  motor.max_force = table->number("max", {Sign::not_negative}).value_or(unlimited);
  table->close();
  return motor;
}

std::vector<SceneSpring> read_coordinate_springs(Entry& effects, Quantity quantity) {
  std::vector<SceneSpring> springs;
  if (std::optional<Entry> table = effects.table("spring", soft_example)) {
    const std::optional<double> rest = table->number("rest", quantity);
    if (const auto softness = read_softness(*table)) springs.push_back({*softness, rest});
    table->close();
  }
  if (const auto damping = effects.number("damper", {Sign::not_negative})) {
    Softness softness;
    softness.by_frequency = false;
    softness.damping = *damping;
    springs.push_back({softness, 0});
  }
  return springs;
}

void read_effects(Entry& joint, const JointType& type, std::vector<SceneEffects>& all) {
  for (const CoordinateInfo& coordinate : type.coordinates) {
    const std::string key(coordinate.name);
    std::optional<Entry> entry = joint.table(key);
    if (!entry) {
      if (joint.has(key)) {
        joint.error(joint.where(key), fmt::format("`{}` is a coordinate: it takes effects", key),
                    fmt::format("{}.limit = [0, 1], {}.motor = {{ speed = 2 }}, …", key, key));
      }
      continue;
    }
    const Quantity quantity{Sign::any, coordinate.unit == "rad"};
    SceneEffects effects;
    effects.coordinate = key;
    effects.limit = read_limit(*entry, quantity);
    effects.motor = read_motor(*entry, quantity);
    effects.springs = read_coordinate_springs(*entry, quantity);
    if (const auto force = entry->number("friction", {Sign::not_negative})) effects.friction = DryFriction{*force};
    entry->close();
    all.push_back(std::move(effects));
  }
}

// An effect on a coordinate that other joints have, but not this one: revolute, where hinge was
// meant.
void refuse_other_coordinates(Entry& joint, const JointType& type, Dimension dimension) {
  std::map<std::string, std::string> owners;  // by coordinate: the joints of as many bodies
  for (const JointType& other : joint_types(dimension)) {
    if (other.bodies != type.bodies) continue;
    for (const CoordinateInfo& coordinate : other.coordinates) {
      std::string& names = owners[std::string(coordinate.name)];
      names += fmt::format("{}`{}`", names.empty() ? "" : ", ", other.name);
    }
  }
  for (const auto& [coordinate, names] : owners) {
    if (!joint.leaves_table_unread(coordinate)) continue;
    std::string own;
    for (const CoordinateInfo& c : type.coordinates)
      own += fmt::format("{}`{}`", own.empty() ? "it has " : ", ", c.name);
    joint.error(joint.where(coordinate), fmt::format("`{}` has no coordinate `{}`", type.name, coordinate),
                fmt::format("{}{}joints that have it: {}", own, own.empty() ? "" : "; ", names));
    joint.has(coordinate);  // read now: one complaint is enough
  }
}

std::optional<Softness> read_soft(Entry& joint) {
  std::optional<Entry> table = joint.table("soft", soft_example);
  if (!table) return {};
  const std::optional<Softness> softness = read_softness(*table);
  table->close();
  return softness;
}

}  // namespace

void read_joints(Entry& top, const BodyNames& names, Scene& scene) {
  std::map<std::string, Span> used;
  for (Entry& entry : top.list("joint")) {
    SceneJoint joint;
    joint.where = entry.header();
    const std::string unnamed = fmt::format("joint{}", scene.joints.size() + 1);
    joint.name = read_name(entry, used, unnamed).value_or("");
    const JointType* type = read_type(entry, scene.dimension);
    if (!type) continue;  // what else it may say depends on the type
    joint.definition.type = type->name;
    const std::optional<std::vector<int>> bodies = read_joint_bodies(entry, *type, names);
    joint.definition.bodies = bodies.value_or(std::vector<int>(static_cast<std::size_t>(type->bodies), world_body));
    read_parameters(entry, *type, names, joint.definition);
    read_effects(entry, *type, joint.effects);
    joint.definition.soft = read_soft(entry);
    joint.breaking = entry.number("breaking", {Sign::positive});
    refuse_other_coordinates(entry, *type, scene.dimension);
    entry.close();
    scene.joints.push_back(std::move(joint));
  }
}

void read_springs(Entry& top, const BodyNames& names, Scene& scene) {
  const bool in_space = scene.dimension == Dimension::spatial;
  std::map<std::string, Span> used;
  for (Entry& entry : top.list("spring")) {
    read_name(entry, used, "");
    entry.required("bodies", "bodies = [\"world\", \"mass\"]");
    entry.required("stiffness", "stiffness = 100");
    const std::optional<std::vector<int>> bodies = names.find(entry, "bodies");
    const bool two = bodies && bodies->size() == 2;
    if (bodies && !two)
      entry.error(entry.where("bodies"),
                  fmt::format("a spring has 2 bodies, but {} named", number_named(bodies->size())));
    SpringDefinition spring;
    spring.body_a = two ? (*bodies)[0] : world_body;
    spring.body_b = two ? (*bodies)[1] : world_body;
    const Vec3 pa = read_point(entry, "pa", spring.body_a, names).value_or(Vec3{});
    const Vec3 pb = read_point(entry, "pb", spring.body_b, names).value_or(Vec3{});
    spring.ax = pa[0], spring.ay = pa[1], spring.az = pa[2];
    spring.bx = pb[0], spring.by = pb[1], spring.bz = pb[2];
    const Vec3 from = names.to_world(spring.body_a, pa), to = names.to_world(spring.body_b, pb);
    const double length = in_space ? std::hypot(to[0] - from[0], to[1] - from[1], to[2] - from[2])
                                   : std::hypot(to[0] - from[0], to[1] - from[1]);
    spring.rest_length = entry.number("rest", {Sign::not_negative}).value_or(length);
    spring.stiffness = entry.number("stiffness", {Sign::not_negative}).value_or(0);
    spring.damping = entry.number("damping", {Sign::not_negative}).value_or(0);
    entry.close();
    scene.springs.push_back(spring);
  }
}

}  // namespace cdot
