// The [[joint]] and [[spring]] entries of a scene -> definitions. The table of joint types lists parameters and
// coordinates; no joint is known by name here.
#include <cmath>
#include <fmt/format.h>
#include <map>

#include "runtime/rows/parameters.hpp"
#include "runtime/tool/scene/keys.hpp"
#include "runtime/tool/scene/profile.hpp"
#include "runtime/tool/scene/read.hpp"
#include "runtime/tool/scene/start.hpp"

namespace cdot {
namespace {

// "the point pa on body a", "the direction t on the world", "the scalar l [m]"
std::string described(const ParameterInfo& parameter) {
  if (parameter.kind == ParameterKind::scalar)
    return fmt::format("the scalar {} [{}]{}", parameter.name, parameter.unit, range_of(parameter));
  const bool on_world = parameter.body < 0;
  return fmt::format("the {} {} on {}", parameter.kind == ParameterKind::point ? "point" : "direction", parameter.name,
                     on_world ? "the world" : fmt::format("body {}", static_cast<char>('a' + parameter.body)));
}

std::string number_named(std::size_t count) { return fmt::format("{} {}", count, count == 1 ? "is" : "are"); }

struct JointReading {
  const BodyNames& names;
  Scene& scene;
  std::map<std::string, Span>& used;
  std::string unnamed;
  SceneJoint joint{};
  const JointType* type = nullptr;
};

void read_joint_name(Entry& joint, const char*, JointReading& to) {
  to.joint.name = read_name(joint, to.used, to.unnamed).value_or("");
}

const JointType* type_named(Entry& joint, Dimension dimension) {
  joint.required("type", "type = \"revolute\"");
  const std::optional<std::string> name = joint.text("type");
  if (!name) return nullptr;
  const JointType* type = find_joint_type(dimension, *name);
  if (type) return type;
  if (const std::string spec = spec_beside(joint, *name, {".joint", ".effect"}); !spec.empty())
    return own_joint_type(joint, dimension, spec);
  std::vector<std::string> known;
  for (const JointType& other : joint_types(dimension)) known.emplace_back(other.name);
  const bool in_space = dimension == Dimension::spatial;
  const bool elsewhere = find_joint_type(in_space ? Dimension::planar : Dimension::spatial, *name) != nullptr;
  const std::string here = called_here(*name, known);
  joint.error(joint.where("type"),
              elsewhere ? fmt::format("\"{}\" is a joint {}, and this scene is {}", *name,
                                      in_space ? "of the plane" : "in space", in_space ? "in space" : "planar")
                        : fmt::format("no joint is called \"{}\"", *name),
              elsewhere && here.empty() ? "`cdot-run list` shows the joints of both" : did_you_mean(*name, known));
  return nullptr;
}

// The bodies in the order of the spec. A wrong number is a mistake, and gives nothing.
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
    joint.error(joint.where("bodies"), fmt::format("the joint connects \"{}\" with itself", names.name((*bodies)[0])));
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

// { world = [[x, y, z], [x, y, z]] }: the same axes in the world at the start.
bool has_two_axes_in_world(Entry& joint, const std::string& key) {
  return joint.is_table(key) && joint.table(key)->is_array_of_arrays("world");
}

std::optional<std::vector<double>> read_two_axes_in_world(Entry& joint, const std::string& key, int body,
                                                          const BodyNames& names) {
  Entry table = *joint.table(key);
  std::optional<std::vector<double>> axes = read_two_axes(table, "world");
  table.close();
  for (std::size_t k = 0; axes && k < axes->size(); k += 3) {
    const Vec3 turned = names.turned_to_body(body, {(*axes)[k], (*axes)[k + 1], (*axes)[k + 2]});
    std::copy(turned.begin(), turned.end(), axes->begin() + static_cast<std::ptrdiff_t>(k));
  }
  return axes;
}

// A type may have a number of its own that is called `start`, as rolling has: a table then gives the coordinates, a
// number or a function of time the parameter.
bool means_coordinates(Entry& joint, const JointType& type, const std::string& key) {
  if (key != start_key && key != start_rate_key) return false;
  const auto own = std::ranges::find(type.parameters, key, &ParameterInfo::name);
  return own == type.parameters.end() ||
         (own->kind == ParameterKind::scalar && joint.is_table(key) && !joint.is_function(key));
}

// The numbers of one parameter in the frame of its body. Nothing if it is wrong or takes its default.
std::optional<NamedValue> read_parameter(Entry& joint, const ParameterInfo& parameter, int body, std::optional<Vec3> at,
                                         const BodyNames& names, Scene& scene) {
  const std::string key(parameter.name);
  const bool in_space = names.dimension() == Dimension::spatial, scalar = parameter.kind == ParameterKind::scalar;
  const bool vector = parameter.kind == ParameterKind::point || parameter.kind == ParameterKind::vector;
  if (scalar || (vector && joint.is_array(key))) {
    const NumberNeed need{parameter.unit, open_end(parameter), parameter.below, &scene};
    const auto size = scalar ? std::nullopt : std::optional<std::size_t>(in_space ? 3 : 2);
    const auto numbers = read_numbers_in_time(joint, key, size, {Sign::any, parameter.unit == "rad"}, need);
    return numbers ? std::optional(named_value(key, *numbers)) : std::nullopt;
  }
  if (in_space && parameter.kind == ParameterKind::frame && joint.is_array_of_arrays(key)) {
    const auto axes = read_two_axes(joint, key);
    return axes ? std::optional(NamedValue{key, *axes}) : std::nullopt;
  }
  if (in_space && parameter.kind == ParameterKind::frame && has_two_axes_in_world(joint, key)) {
    const auto axes = read_two_axes_in_world(joint, key, body, names);
    return axes ? std::optional(NamedValue{key, *axes}) : std::nullopt;
  }
  std::optional<Vec3> place;
  if (parameter.kind == ParameterKind::point) {
    place = read_of_body(joint, key, body, names, &BodyNames::to_body);
    if (!joint.has(key) && at) place = names.to_body(body, *at);
  } else {
    place = read_of_body(joint, key, body, names, &BodyNames::turned_to_body);
    const bool direction = parameter.kind != ParameterKind::vector;
    if (direction && place && std::hypot((*place)[0], (*place)[1], (*place)[2]) == 0) {
      joint.error(joint.where(key), fmt::format("the direction `{}` has length 0", key),
                  in_space ? "any other length works: [1, 0, 0]" : "any other length works: [1, 0]");
    }
  }
  if (!place) return {};
  return NamedValue{key, {place->begin(), place->begin() + (in_space ? 3 : 2)}};
}

// Many engines take an axis. The direction of a spec may be another one, as the normal of a line in the plane.
void refuse_axis(Entry& joint, const JointType& type) {
  const auto is_axis = [](const ParameterInfo& info) { return info.name == "axis"; };
  const auto is_direction = [](const ParameterInfo& info) {
    return info.kind == ParameterKind::unit || info.kind == ParameterKind::frame;
  };
  const auto direction = std::ranges::find_if(type.parameters, is_direction);
  if (direction == type.parameters.end() || std::ranges::any_of(type.parameters, is_axis) || !joint.has("axis")) return;
  joint.error(joint.where("axis"), fmt::format("unknown key `axis` in {}", joint.what()),
              fmt::format("{} takes {}: \"{}\"", type.name, described(*direction), type.title));
}

// `at` and the parameters of the type. `at` gives the points that have no key of their own.
void read_parameters(Entry& joint, const char* key, JointReading& to) {
  const BodyNames& names = to.names;
  const JointType& type = *to.type;
  JointDefinition& definition = to.joint.definition;
  const std::optional<Vec3> at = read_vector(joint, key, names.dimension());
  const bool in_space = names.dimension() == Dimension::spatial;
  bool has_point = false;
  refuse_axis(joint, type);
  for (const ParameterInfo& parameter : type.parameters) {
    const bool on_body = parameter.body >= 0;
    const int body = on_body ? definition.bodies[static_cast<std::size_t>(parameter.body)] : world_body;
    const bool point = parameter.kind == ParameterKind::point;
    const bool scalar = parameter.kind == ParameterKind::scalar;
    const bool own = !means_coordinates(joint, type, std::string(parameter.name));
    const bool given = (own && joint.has(std::string(parameter.name))) || (point && joint.has("at"));
    has_point = has_point || point;
    const auto value = own ? read_parameter(joint, parameter, body, at, names, to.scene) : std::nullopt;
    if (value) {
      definition.parameters.push_back(*value);
    } else if (!given && !parameter.has_default) {
      joint.error(joint.header(),
                  fmt::format("{} has no `{}`: {}. {}: \"{}\"", joint.what(), parameter.name, described(parameter),
                              type.name, type.title),
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

// Refuses an effect on a coordinate of another joint type: the scene says revolute and means hinge.
void refuse_other_coordinates(Entry& joint, const JointType& type, Dimension dimension) {
  std::map<std::string, std::vector<std::string>> owners;  // by coordinate: the joints of as many bodies
  for (const JointType& other : joint_types(dimension))
    for (const CoordinateInfo& coordinate : other.coordinates)
      if (other.bodies == type.bodies) owners[std::string(coordinate.name)].push_back(fmt::format("`{}`", other.name));
  for (const auto& [coordinate, names] : owners) {
    if (!joint.leaves_table_unread(coordinate)) continue;
    std::string own;
    for (const CoordinateInfo& c : type.coordinates)
      own += fmt::format("{}`{}`", own.empty() ? "it has " : ", ", c.name);
    joint.error(joint.where(coordinate), fmt::format("`{}` has no coordinate `{}`", type.name, coordinate),
                fmt::format("{}{}joints that have it: {}", own, own.empty() ? "" : "; ", fmt::join(names, ", ")));
    joint.has(coordinate);  // read now, so that close() does not report it again
  }
}

void read_type(Entry& joint, const char*, JointReading& to) {
  to.type = type_named(joint, to.names.dimension());
  if (to.type) to.joint.definition.type = to.type->name;
}

void read_bodies_of_joint(Entry& joint, const char*, JointReading& to) {
  const std::vector<int> unknown(static_cast<std::size_t>(to.type->bodies), world_body);
  to.joint.definition.bodies = read_joint_bodies(joint, *to.type, to.names).value_or(unknown);
}

void read_soft(Entry& joint, const char* key, JointReading& to) {
  to.joint.definition.soft = read_softness(joint, key);
}

void read_start(Entry& joint, const char* key, JointReading& to) {
  if (means_coordinates(joint, *to.type, key)) read_starts(joint, key, *to.type, to.joint);
}

struct SpringReading {
  const BodyNames& names;
  std::map<std::string, Span>& used;
  SpringDefinition spring{};
  Vec3 from{}, to{};  // its points, in the world
};

void read_spring_name(Entry& spring, const char*, SpringReading& to) { read_name(spring, to.used, ""); }

void read_bodies_of_spring(Entry& spring, const char* key, SpringReading& to) {
  spring.required(key, "bodies = [\"world\", \"mass\"]");
  const std::optional<std::vector<int>> bodies = to.names.find(spring, key);
  const bool two = bodies && bodies->size() == 2;
  if (bodies && !two)
    spring.error(spring.where(key), fmt::format("a spring has 2 bodies, but {} named", number_named(bodies->size())));
  to.spring.body_a = two ? (*bodies)[0] : world_body;
  to.spring.body_b = two ? (*bodies)[1] : world_body;
}

using Number = double SpringDefinition::*;
template <int SpringDefinition::*of, Number x, Number y, Number z, Vec3 SpringReading::*in_world>
void read_end(Entry& spring, const char* key, SpringReading& to) {
  const int body = to.spring.*of;
  const Vec3 p = read_of_body(spring, key, body, to.names, &BodyNames::to_body).value_or(Vec3{});
  to.spring.*x = p[0], to.spring.*y = p[1], to.spring.*z = p[2];
  to.*in_world = to.names.to_world(body, p);
}

void read_rest(Entry& spring, const char* key, SpringReading& to) {
  const double x = to.to[0] - to.from[0], y = to.to[1] - to.from[1], z = to.to[2] - to.from[2];
  const double length = to.names.dimension() == Dimension::spatial ? std::hypot(x, y, z) : std::hypot(x, y);
  to.spring.rest_length = spring.number(key, {Sign::not_negative}).value_or(length);
}

void read_stiffness(Entry& spring, const char* key, SpringReading& to) {
  spring.required(key, "stiffness = 100");
  to.spring.stiffness = spring.number(key, {Sign::not_negative}).value_or(0);
}

constexpr auto spring = &SpringReading::spring;
using Spring = SpringDefinition;
constexpr auto read_pa = read_end<&Spring::body_a, &Spring::ax, &Spring::ay, &Spring::az, &SpringReading::from>;
constexpr auto read_pb = read_end<&Spring::body_b, &Spring::bx, &Spring::by, &Spring::bz, &SpringReading::to>;

// clang-format off
constexpr Key<JointReading> named[] = {
    {"name", "of messages and summaries", "joint1, joint2, …", read_joint_name},
    {"type", "a spec of specs/planar/ or specs/spatial/, or a .joint file beside the scene", "required", read_type},
};
// The meaning of these depends on the type.
constexpr Key<JointReading> joint_keys[] = {
    {"bodies", "the spec's a, b, … in this order; \"world\" never moves", "required", read_bodies_of_joint},
    {"at", "place in the world at the start of all points without a key of their own [m]", "", read_parameters},
    {"soft", "{ frequency, damping_ratio } or { stiffness, damping }: the joint is a spring", "exact", read_soft},
    {start_key, "{ angle = \"30 deg\" }: coordinates at the start; the bodies follow from their written poses", "as written", read_start},
    {start_rate_key, "{ angle = 2 }: rates of coordinates at the start; the velocities follow", "by the written velocities", read_start},
};
constexpr Key<SpringReading> spring_keys[] = {
    {"name", "of messages", "", read_spring_name},
    {"bodies", "two", "required", read_bodies_of_spring},
    {"pa", "its point of the first body [m]", "the centre", read_pa},
    {"pb", "its point of the second body [m]", "the centre", read_pb},
    {"rest", "[m]", "the length at the start", read_rest},
    {"stiffness", "[N/m]", "required", read_stiffness},
    {"damping", "[N s/m]", "0", read_number<Sign::not_negative, spring, &SpringDefinition::damping>},
};
// clang-format on

}  // namespace

void read_joints(Entry& top, const BodyNames& names, Scene& scene) {
  std::map<std::string, Span> used;
  for (Entry& entry : top.list("joint")) {
    JointReading read{names, scene, used, fmt::format("joint{}", scene.joints.size() + 1)};
    read.joint.where = entry.header();
    read_keys(entry, named, scene.dimension, read);
    if (!read.type) continue;
    read_keys(entry, joint_keys, scene.dimension, read);
    read_effects(entry, *read.type, scene, read.joint.effects);
    read_bonds(entry, scene, read.joint.bonds);
    refuse_other_coordinates(entry, *read.type, scene.dimension);
    entry.close();
    scene.joints.push_back(std::move(read.joint));
  }
}

void read_springs(Entry& top, const BodyNames& names, Scene& scene) {
  std::map<std::string, Span> used;
  for (Entry& entry : top.list("spring")) {
    SpringReading read{names, used};
    read_keys(entry, spring_keys, scene.dimension, read);
    entry.close();
    scene.springs.push_back({read.spring, entry.header()});
  }
}

KeyTable keys_of_a_joint() {
  return table_of("[[joint]], beside the parameters and coordinates of its type", named, joint_keys);
}

KeyTable keys_of_a_spring() { return table_of("[[spring]]", spring_keys); }

}  // namespace cdot
