// The [[body]] entries of a scene -> definitions of bodies. In the plane a direction has two numbers and a rotation
// one. In space a rotation has three, and an inertia may be a tensor.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "runtime/tool/scene/keys.hpp"
#include "runtime/tool/scene/profile.hpp"
#include "runtime/tool/scene/read.hpp"

namespace cdot {
namespace {

// Also in the plane the numbers go into the definition in space; a rotation uses the first of three.
struct Reading {
  Dimension dimension;
  std::map<std::string, Span>& names;
  Scene& scene;
  SceneBody body{};
  std::optional<Inertia> inertia{};
  std::optional<Vec3> axis{};
  std::optional<double> angle{};
  bool in_space() const { return dimension == Dimension::spatial; }
};
using Definition = SpatialBodyDefinition;
using Member = double Definition::*;
constexpr auto spatial_part = &SceneBody::spatial;
constexpr auto body_part = &Reading::body;

double square(double x) { return x * x; }

void read_body_name(Entry& body, const char*, Reading& to) {
  to.body.name = read_name(body, to.names, std::nullopt).value_or("");
}

struct ShapeReading {
  bool in_space, takes_width;
  Shape shape{};
};

void read_rod(Entry& entry, const char* key, ShapeReading& to) {
  if (const auto length = entry.number(key, {Sign::positive}))
    to.shape = {Shape::rod, *length, 0.06 * *length, 0.06 * *length};
}

void read_box(Entry& entry, const char* key, ShapeReading& to) {
  if (const auto sides = entry.numbers(key, to.in_space ? 3 : 2, {Sign::positive}))
    to.shape = {Shape::box, (*sides)[0], (*sides)[1], to.in_space ? (*sides)[2] : 0};
}

void read_disc(Entry& entry, const char* key, ShapeReading& to) {
  if (const auto radius = entry.number(key, {Sign::positive}))
    to.shape = {Shape::disc, 2 * *radius, 2 * *radius, 0.2 * *radius};
}

void read_ball(Entry& entry, const char* key, ShapeReading& to) {
  if (const auto radius = entry.number(key, {Sign::positive}))
    to.shape = {Shape::ball, 2 * *radius, 2 * *radius, 2 * *radius};
}

void read_width(Entry& entry, const char* key, ShapeReading& to) {
  const auto width = entry.number(key, {Sign::positive});
  if (!width) return;
  if (!to.takes_width) entry.error(entry.where(key), "`width` belongs to a rod");
  (entry.has("rod") ? to.shape.width : to.shape.depth) = *width;
}

// clang-format off
constexpr Key<ShapeReading> shape_keys[] = {
    {"rod", "its length along x [m]", "", read_rod},
    {"box", "its sides along x and y, in space x, y and z [m]", "", read_box},
    {"disc", "its radius; in space about z [m]", "", read_disc},
    {"ball", "its radius [m]", "", read_ball, Where::in_space},
    {"width", "of a rod across x; in space also a disc's thickness [m]", "0.06 of a rod's length, 0.1 of a disc's", read_width},
};
// clang-format on

void read_shape(Entry& body, const char* key, Reading& to) {
  const bool in_space = to.in_space();
  std::optional<Entry> entry =
      body.table(key, in_space ? "shape = { rod = 1.0 }, { box = [1, 0.5, 0.2] } or { ball = 0.2 }"
                               : "shape = { rod = 1.0 }, { box = [1, 0.5] } or { disc = 0.2 }");
  if (!entry) return;
  const bool rod = entry->has("rod"), disc = entry->has("disc");
  if (rod + entry->has("box") + disc + (in_space && entry->has("ball")) != 1)
    entry->error(entry->header(),
                 in_space ? "a shape is one of rod, box, disc and ball" : "a shape is one of rod, box and disc",
                 "shape = { rod = 1.0 }");
  ShapeReading read{in_space, rod || (in_space && disc)};
  read_keys(*entry, shape_keys, to.dimension, read);
  to.body.shape = read.shape;
  entry->close();
}

// inertia = I, in space also [Ixx, Iyy, Izz] or [[…], […], […]] in the frame of the body
void read_inertia(Entry& body, const char* key, Reading& to) {
  if (to.in_space() && body.is_array_of_arrays(key)) {
    const auto m = body.rows(key, 3);
    if (!m) return;
    const std::vector<double>& I = *m;
    if (I[1] != I[3] || I[2] != I[6] || I[5] != I[7])
      body.error(body.where(key), "the inertia tensor is not symmetric", "row i, column j as row j, column i");
    to.inertia = {I[0], I[4], I[8], I[1], I[2], I[5]};
  } else if (to.in_space() && body.is_array(key)) {
    if (const auto I = body.numbers(key, 3, {Sign::positive})) to.inertia = {(*I)[0], (*I)[1], (*I)[2]};
  } else if (const auto I = body.number(key, {Sign::not_negative})) {
    to.inertia = {*I, *I, *I};
  }
}

template <Member x, Member y, Member z>
void read_vector_of(Entry& body, const char* key, Reading& to) {
  const Vec3 vector = read_vector(body, key, to.dimension).value_or(Vec3{});
  Definition& numbers = to.body.spatial;
  numbers.*x = vector[0], numbers.*y = vector[1], numbers.*z = vector[2];
}

// The origin moves among the bodies, by a shift that floats have to hold as well.
constexpr double furthest = 1e30;  // [m]

void read_position(Entry& body, const char* key, Reading& to) {
  read_vector_of<&Definition::x, &Definition::y, &Definition::z>(body, key, to);
  const Definition& at = to.body.spatial;
  const double most = std::max({std::abs(at.x), std::abs(at.y), std::abs(at.z)});
  if (most > furthest)
    body.error(body.where(key), fmt::format("`{}` is {:.3g} m from the origin, beyond {:.0e} m", key, most, furthest),
               "numbers are metres: check the exponent");
}

// One number in the plane, three in space.
template <Member x, Member y, Member z, bool angle>
void read_turn(Entry& body, const char* key, Reading& to) {
  const Quantity quantity{Sign::any, angle};
  Definition& numbers = to.body.spatial;
  if (!to.in_space()) {
    numbers.*x = body.number(key, quantity).value_or(0);
  } else if (const auto read = body.numbers(key, 3, quantity)) {
    numbers.*x = (*read)[0], numbers.*y = (*read)[1], numbers.*z = (*read)[2];
  }
}

// Numbers go into the members, functions of time into the value of an effect: F of `push`, M of `couple`.
template <Member x, Member y, Member z>
void read_load(Entry& body, const char* key, const char* unit, const char* parameter, bool one,
               std::optional<NamedValue>& in_time, Reading& to) {
  const auto size = one ? std::nullopt : std::optional<std::size_t>(to.in_space() ? 3 : 2);
  NumberNeed need{unit};
  need.scene = &to.scene;
  const auto read = read_numbers_in_time(body, key, size, {}, need);
  if (!read) return;
  if (NamedValue value = named_value(parameter, *read); !value.in_time.empty()) {
    in_time = std::move(value);
    return;
  }
  constexpr Member members[] = {x, y, z};
  for (std::size_t k = 0; k < read->size(); ++k) to.body.spatial.*members[k] = (*read)[k].value;
}
void read_force(Entry& body, const char* key, Reading& to) {
  read_load<&Definition::force_x, &Definition::force_y, &Definition::force_z>(body, key, "N", "F", false,
                                                                              to.body.force_in_time, to);
}
void read_torque(Entry& body, const char* key, Reading& to) {
  read_load<&Definition::torque_x, &Definition::torque_y, &Definition::torque_z>(body, key, "N*m", "M", !to.in_space(),
                                                                                 to.body.torque_in_time, to);
}

void read_angle(Entry& body, const char* key, Reading& to) { to.angle = body.number(key, {Sign::any, true}); }

void read_axis(Entry& body, const char* key, Reading& to) { to.axis = read_vector(body, key, to.dimension); }

void read_quaternion(Entry& body, const char* key, Reading& to) {
  const auto e = body.numbers(key, 4);
  if (!e) return;
  const double length = std::sqrt(square((*e)[0]) + square((*e)[1]) + square((*e)[2]) + square((*e)[3]));
  if (!(length > 1e-50)) body.error(body.where(key), "the quaternion has length 0", "[1, 0, 0, 0]");
  Definition& numbers = to.body.spatial;
  numbers.e0 = (*e)[0], numbers.e1 = (*e)[1], numbers.e2 = (*e)[2], numbers.e3 = (*e)[3];
}

// trace = true for the centre, [x, y] for a point of the body
void read_trace(Entry& body, const char* key, Reading& to) {
  const bool point = body.is_array(key);
  const std::optional<Vec3> at = point ? read_vector(body, key, to.dimension) : Vec3{};
  if (at && (point || body.flag(key).value_or(false))) to.body.traces.push_back(*at);
}

// clang-format off
constexpr Key<Reading> body_keys[] = {
    {"name", "letters, digits, _ and -; names the CSV columns: rod.x", "required", read_body_name},
    {"shape", "{ rod = length }, { box = [along x, along y] } or { disc = radius }, in space also { ball = radius } [m]", "a stick figure", read_shape},
    {"static", "never moves; needs no mass", "false", read_flag<body_part, spatial_part, &Definition::is_static>},
    {"fixed_rotation", "never turns; needs no inertia", "false", read_flag<body_part, spatial_part, &Definition::fixed_rotation>},
    {"mass", "[kg]", "required", read_number<Sign::positive, body_part, spatial_part, &Definition::mass>},
    {"inertia", "about the centre of mass [kg m^2]; in space a number, three or a tensor", "of the shape, if uniform", read_inertia},
    {"position", "of the centre of mass at the start [m]", "0", read_position},
    {"orientation", "of the body's frame, a quaternion of any length", "[1, 0, 0, 0]", read_quaternion, Where::in_space},
    {"axis", "with angle: the orientation as a rotation about this axis", "", read_axis, Where::in_space},
    {"angle", "of the body's frame at the start [rad]", "0", read_angle},
    {"velocity", "[m/s]", "0", read_vector_of<&Definition::vx, &Definition::vy, &Definition::vz>},
    {"spin", "[rad/s]", "0", read_turn<&Definition::wx, &Definition::wy, &Definition::wz, true>},
    {"force", "at the centre of mass [N]; its numbers may follow functions of time", "0", read_force},
    {"torque", "[N m]; likewise", "0", read_torque},
    {"linear_damping", "force = -mass damping velocity [1/s]", "0", read_number<Sign::not_negative, body_part, spatial_part, &Definition::linear_damping>},
    {"angular_damping", "torque = -inertia damping spin [1/s]", "0", read_number<Sign::not_negative, body_part, spatial_part, &Definition::angular_damping>},
    {"trace", "true for the centre, or a point of the body: the viewer draws its path", "the last body's", read_trace},
};
// clang-format on

// Planar moment of inertia about the centre, of uniform density.
double uniform_moment(const Shape& shape, double mass) {
  switch (shape.kind) {
    case Shape::rod: return mass * shape.length * shape.length / 12;
    case Shape::box: return mass * (shape.length * shape.length + shape.width * shape.width) / 12;
    case Shape::disc: return mass * shape.length * shape.length / 8;
    case Shape::ball:
    case Shape::none: return 0;
  }
  return 0;
}

// The same in space: a rod is a cylinder along x, a disc a cylinder about z.
Inertia uniform_inertia(const Shape& shape, double mass) {
  const auto cylinder = [&](double radius, double height) {  // along and across its axis
    return std::pair{mass * square(radius) / 2, mass * (3 * square(radius) + square(height)) / 12};
  };
  if (shape.kind == Shape::box)
    return {mass * (square(shape.width) + square(shape.depth)) / 12,
            mass * (square(shape.length) + square(shape.depth)) / 12,
            mass * (square(shape.length) + square(shape.width)) / 12};
  if (shape.kind == Shape::ball) {
    const double I = 0.1 * mass * square(shape.length);
    return {I, I, I};
  }
  if (shape.kind == Shape::rod) {
    const auto [along, across] = cylinder(shape.width / 2, shape.length);
    return {along, across, across};
  }
  const auto [along, across] = cylinder(shape.length / 2, shape.depth);
  return {across, across, along};
}

// Needs an inertia of every body that may turn.
void find_inertia(Entry& body, Reading& to) {
  Definition& numbers = to.body.spatial;
  if (numbers.is_static) return;
  if (!body.has("mass")) body.error(body.header(), body.what() + " has no `mass`", "mass = 1.0, or static = true");
  if (body.has("inertia")) {
    if (!to.inertia || numbers.fixed_rotation) return;
    const char* wrong = to.in_space() ? mistake_in(*to.inertia) : nullptr;
    if (wrong) body.error(body.where("inertia"), wrong);
    if (to.inertia->xx == 0)
      body.error(body.where("inertia"), "`inertia` is 0, but the body is free to turn",
                 "a point mass on a pin needs fixed_rotation = true");
  } else if (to.body.shape.kind != Shape::none) {
    const double planar = uniform_moment(to.body.shape, numbers.mass);
    to.inertia = to.in_space() ? uniform_inertia(to.body.shape, numbers.mass) : Inertia{planar, planar, planar};
  } else if (!numbers.fixed_rotation && !body.has("shape")) {  // a shape without a kind has a mistake of its own
    body.error(body.header(), body.what() + " has no `inertia`",
               fmt::format("inertia = {}, a shape to work it out from, or fixed_rotation = true",
                           to.in_space() ? "[Ixx, Iyy, Izz]" : "…"));
  }
}

// In space: from orientation = [e0, e1, e2, e3], or from axis = [x, y, z] and angle
void find_orientation(Entry& body, Reading& to) {
  if (!to.in_space()) return;
  const bool quaternion = body.has("orientation"), axis = body.has("axis"), angle = body.has("angle");
  if (quaternion && (axis || angle))
    body.error(body.where("orientation"), "both `orientation` and `axis`, `angle` set the orientation",
               "keep one of them");
  else if (axis != angle)
    body.error(body.where(axis ? "axis" : "angle"), axis ? "`axis` without `angle`" : "`angle` without `axis`",
               "axis = [0, 0, 1] and angle = \"30 deg\"");
  if (!to.axis || !to.angle) return;
  const auto [x, y, z] = *to.axis;
  const double length = std::hypot(x, y, z);
  if (!(length > 0))
    return body.error(body.where("axis"), "the direction `axis` has length 0", "any other length works: [0, 0, 1]");
  const double c = std::cos(*to.angle / 2), s = std::sin(*to.angle / 2) / length;
  Definition& numbers = to.body.spatial;
  numbers.e0 = c, numbers.e1 = s * x, numbers.e2 = s * y, numbers.e3 = s * z;
}

// Refuses a velocity or spin of a body that cannot move or turn.
void check_motion(Entry& body, const Definition& read) {
  const bool moves = read.vx != 0 || read.vy != 0 || read.vz != 0, turns = read.wx != 0 || read.wy != 0 || read.wz != 0;
  if (read.is_static && moves) body.error(body.where("velocity"), "a static body cannot move: `velocity` is not 0");
  if (read.is_static && turns) body.error(body.where("spin"), "a static body cannot move: `spin` is not 0");
  if (read.fixed_rotation && turns)
    body.error(body.where("spin"), "a body with fixed_rotation cannot turn: `spin` is not 0");
}

SceneBody defined(const Reading& read) {
  SceneBody body = read.body;
  Definition& all = body.spatial;
  body.is_static = all.is_static;
  if (read.inertia && !all.is_static) all.inertia = *read.inertia;
  if (read.in_space()) return body;
  body.definition = {all.x,
                     all.y,
                     read.angle.value_or(0),
                     all.vx,
                     all.vy,
                     all.wx,
                     all.mass,
                     all.inertia.zz,
                     all.is_static,
                     all.fixed_rotation,
                     all.force_x,
                     all.force_y,
                     all.torque_x,
                     all.linear_damping,
                     all.angular_damping};
  body.spatial = {};
  return body;
}

}  // namespace

void read_bodies(Entry& top, Scene& scene) {
  std::map<std::string, Span> used{{"world", {}}};
  for (Entry& entry : top.list("body")) {
    Reading read{scene.dimension, used, scene};
    read_keys(entry, body_keys, scene.dimension, read);
    find_inertia(entry, read);
    find_orientation(entry, read);
    check_motion(entry, read.body.spatial);
    entry.close();
    scene.bodies.push_back(defined(read));
  }
  if (!top.has("body")) top.error({}, "a scene needs at least one body", "start with a line [[body]]");
}

void find_forces_in_time(Scene& scene) {
  const std::vector<double> centre(scene.dimension == Dimension::planar ? 2 : 3, 0.0);
  for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
    const SceneBody& body = scene.bodies[k];
    const auto add = [&](const char* type, const char* what, std::vector<NamedValue> values) {
      SceneJoint effect;
      effect.name = fmt::format("{}-{}", body.name, what);
      effect.definition = {type, {static_cast<int>(k)}, std::move(values), {}};
      scene.joints.push_back(std::move(effect));
    };
    if (body.force_in_time) add("push", "force", {{"pa", centre}, *body.force_in_time});
    if (body.torque_in_time) add("couple", "torque", {*body.torque_in_time});
  }
}

KeyTable keys_of_a_body() { return table_of("[[body]]", body_keys); }
KeyTable keys_of_a_shape() { return table_of("`shape` of a body, one of", shape_keys); }

}  // namespace cdot
