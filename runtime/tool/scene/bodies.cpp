// The [[body]] entries of a scene. In the plane a direction has two numbers and a turn has one; in space a turn has
// three, an orientation is a quaternion or an axis and an angle, and an inertia may be a tensor.
#include <cmath>
#include <fmt/format.h>

#include "runtime/tool/scene/keys.hpp"
#include "runtime/tool/scene/read.hpp"

namespace cdot {
namespace {

// The numbers of an entry, before they become a definition.
struct Reading {
  Dimension dimension;
  std::map<std::string, Span>& names;
  SceneBody body{};
  bool fixed_rotation = false;
  double mass = 0, linear_damping = 0, angular_damping = 0;
  std::optional<Inertia> inertia{};
  Vec3 position{}, velocity{}, force{}, spin{}, torque{};  // of turns in the plane the first number
  std::optional<Vec3> axis{};
  std::optional<double> angle{};
  std::array<double, 4> e{1, 0, 0, 0};
  bool in_space() const { return dimension == Dimension::spatial; }
};

double square(double x) { return x * x; }

void read_body_name(Entry& body, const char*, Reading& to) {
  to.body.name = read_name(body, to.names, std::nullopt).value_or("");
}

// { rod = length, width = … }, { box = [along, across] } or { disc = radius }; in space as well
// { box = [x, y, z] }, { disc = radius, width = … } and { ball = radius }
void read_shape(Entry& body, const char* key, Reading& to) {
  const bool in_space = to.in_space();
  Shape& shape = to.body.shape;
  std::optional<Entry> entry =
      body.table(key, in_space ? "shape = { rod = 1.0 }, { box = [1, 0.5, 0.2] } or { ball = 0.2 }"
                               : "shape = { rod = 1.0 }, { box = [1, 0.5] } or { disc = 0.2 }");
  if (!entry) return;
  const bool rod = entry->has("rod"), box = entry->has("box"), disc = entry->has("disc"),
             ball = in_space && entry->has("ball");
  if (rod + box + disc + ball != 1) {
    entry->error(entry->header(),
                 in_space ? "a shape is one of rod, box, disc and ball" : "a shape is one of rod, box and disc",
                 "shape = { rod = 1.0 }");
  }
  const Quantity size{Sign::positive};
  if (const auto length = entry->number("rod", size)) shape = {Shape::rod, *length, 0.06 * *length, 0.06 * *length};
  if (const auto sides = entry->numbers("box", in_space ? 3 : 2, size))
    shape = {Shape::box, (*sides)[0], (*sides)[1], in_space ? (*sides)[2] : 0};
  if (const auto radius = entry->number("disc", size)) shape = {Shape::disc, 2 * *radius, 2 * *radius, 0.2 * *radius};
  if (const auto radius = ball ? entry->number("ball", size) : std::nullopt)
    shape = {Shape::ball, 2 * *radius, 2 * *radius, 2 * *radius};
  if (const auto width = entry->number("width", size)) {
    if (!rod && !(in_space && disc)) entry->error(entry->where("width"), "`width` belongs to a rod");
    (rod ? shape.width : shape.depth) = *width;
  }
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

template <Vec3 Reading::*vector>
void read_vector_of(Entry& body, const char* key, Reading& to) {
  to.*vector = read_vector(body, key, to.dimension).value_or(Vec3{});
}

// One number in the plane, three in space.
template <Vec3 Reading::*turn, bool angle>
void read_turn(Entry& body, const char* key, Reading& to) {
  const Quantity quantity{Sign::any, angle};
  if (!to.in_space()) {
    to.*turn = {body.number(key, quantity).value_or(0), 0, 0};
  } else if (const auto numbers = body.numbers(key, 3, quantity)) {
    to.*turn = {(*numbers)[0], (*numbers)[1], (*numbers)[2]};
  }
}

void read_angle(Entry& body, const char* key, Reading& to) { to.angle = body.number(key, {Sign::any, true}); }

void read_axis(Entry& body, const char* key, Reading& to) { to.axis = read_vector(body, key, to.dimension); }

void read_quaternion(Entry& body, const char* key, Reading& to) {
  const auto e = body.numbers(key, 4);
  if (!e) return;
  const double length = std::sqrt(square((*e)[0]) + square((*e)[1]) + square((*e)[2]) + square((*e)[3]));
  if (!(length > 1e-50)) body.error(body.where(key), "the quaternion has length 0", "[1, 0, 0, 0]");
  to.e = {(*e)[0], (*e)[1], (*e)[2], (*e)[3]};
}

// trace = true for the centre, [x, y] for a point of the body
void read_trace(Entry& body, const char* key, Reading& to) {
  const bool point = body.is_array(key);
  const std::optional<Vec3> at = point ? read_vector(body, key, to.dimension) : Vec3{};
  if (at && (point || body.flag(key).value_or(false))) to.body.traces.push_back(*at);
}

// clang-format off
constexpr Key<Reading> keys[] = {
    {"name", "letters, digits, _ and -; names the CSV columns: rod.x", "required", read_body_name},
    {"shape", "{ rod = length }, { box = [along x, along y] } or { disc = radius }, in space also { ball = radius } [m]", "a stick figure", read_shape},
    {"static", "never moves; needs no mass", "false", read_flag<&Reading::body, &SceneBody::is_static>},
    {"fixed_rotation", "never turns; needs no inertia", "false", read_flag<&Reading::fixed_rotation>},
    {"mass", "[kg]", "required", read_number<Sign::positive, &Reading::mass>},
    {"inertia", "about the centre of mass [kg m^2]; in space a number, three or a tensor", "of the shape, if uniform", read_inertia},
    {"position", "of the centre of mass at the start [m]", "0", read_vector_of<&Reading::position>},
    {"orientation", "of the body's frame, a quaternion of any length", "[1, 0, 0, 0]", read_quaternion, Where::in_space},
    {"axis", "with angle, the same as a rotation about an axis", "", read_axis, Where::in_space},
    {"angle", "of the body's frame at the start [rad]", "0", read_angle},
    {"velocity", "[m/s]", "0", read_vector_of<&Reading::velocity>},
    {"spin", "[rad/s]", "0", read_turn<&Reading::spin, true>},
    {"force", "constant, at the centre of mass [N]", "0", read_vector_of<&Reading::force>},
    {"torque", "constant [N m]", "0", read_turn<&Reading::torque, false>},
    {"linear_damping", "force = -mass damping velocity [1/s]", "0", read_number<Sign::not_negative, &Reading::linear_damping>},
    {"angular_damping", "the same of turns [1/s]", "0", read_number<Sign::not_negative, &Reading::angular_damping>},
    {"trace", "true or a point of the body: its path is drawn", "the last body's", read_trace},
};
// clang-format on

// About the centre, of uniform density; in the plane.
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

// The same in space: a rod is a cylinder along x, a disc one about z.
Inertia uniform_inertia(const Shape& shape, double mass) {
  const auto cylinder = [&](double radius, double height) {  // along it, across it
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

// Complains where a body that is to turn could not.
void find_inertia(Entry& body, Reading& to) {
  if (to.body.is_static) return;
  if (!body.has("mass")) body.error(body.header(), body.what() + " has no `mass`", "mass = 1.0, or static = true");
  if (body.has("inertia")) {
    if (!to.inertia || to.fixed_rotation) return;
    const char* wrong = to.in_space() ? wrong_with(*to.inertia) : nullptr;
    if (wrong) body.error(body.where("inertia"), wrong);
    if (to.inertia->xx == 0)
      body.error(body.where("inertia"), "`inertia` is 0, but the body is free to turn",
                 "a point mass on a pin needs fixed_rotation = true");
  } else if (to.body.shape.kind != Shape::none) {
    const double planar = uniform_moment(to.body.shape, to.mass);
    to.inertia = to.in_space() ? uniform_inertia(to.body.shape, to.mass) : Inertia{planar, planar, planar};
  } else if (!to.fixed_rotation) {
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
    body.error(body.where("orientation"), "`orientation` and `axis`, `angle` say the same", "keep one of them");
  else if (axis != angle)
    body.error(body.where(axis ? "axis" : "angle"), axis ? "`axis` without `angle`" : "`angle` without `axis`",
               "axis = [0, 0, 1] and angle = \"30 deg\"");
  if (!to.axis || !to.angle) return;
  const auto [x, y, z] = *to.axis;
  const double length = std::hypot(x, y, z);
  if (!(length > 0))
    return body.error(body.where("axis"), "the direction `axis` has length 0", "any other length will do: [0, 0, 1]");
  const double c = std::cos(*to.angle / 2), s = std::sin(*to.angle / 2) / length;
  to.e = {c, s * x, s * y, s * z};
}

// Refuses a velocity or spin of a body that cannot move or turn.
void check_motion(Entry& body, const Reading& read) {
  const bool moves = read.velocity != Vec3{}, turns = read.spin != Vec3{};
  if (read.body.is_static && moves)
    body.error(body.where("velocity"), "a static body cannot move: `velocity` is not 0");
  if (read.body.is_static && turns) body.error(body.where("spin"), "a static body cannot move: `spin` is not 0");
  if (read.fixed_rotation && turns)
    body.error(body.where("spin"), "a body with fixed_rotation cannot turn: `spin` is not 0");
}

// The numbers that a definition has in the plane and in space.
template <class Definition>
void define(const Reading& read, Definition& body) {
  body.is_static = read.body.is_static, body.fixed_rotation = read.fixed_rotation, body.mass = read.mass;
  body.x = read.position[0], body.y = read.position[1];
  body.vx = read.velocity[0], body.vy = read.velocity[1];
  body.force_x = read.force[0], body.force_y = read.force[1];
  body.linear_damping = read.linear_damping, body.angular_damping = read.angular_damping;
}

SceneBody defined(const Reading& read) {
  SceneBody body = read.body;
  if (!read.in_space()) {
    BodyDefinition& to = body.definition;
    define(read, to);
    to.angle = read.angle.value_or(0), to.w = read.spin[0], to.torque = read.torque[0];
    if (read.inertia && !to.is_static) to.inertia = read.inertia->zz;
    return body;
  }
  SpatialBodyDefinition& to = body.spatial;
  define(read, to);
  to.z = read.position[2], to.vz = read.velocity[2], to.force_z = read.force[2];
  to.e0 = read.e[0], to.e1 = read.e[1], to.e2 = read.e[2], to.e3 = read.e[3];
  to.wx = read.spin[0], to.wy = read.spin[1], to.wz = read.spin[2];
  to.torque_x = read.torque[0], to.torque_y = read.torque[1], to.torque_z = read.torque[2];
  if (read.inertia && !to.is_static) to.inertia = *read.inertia;
  return body;
}

}  // namespace

void read_bodies(Entry& top, Scene& scene) {
  std::map<std::string, Span> used{{"world", {}}};
  for (Entry& entry : top.list("body")) {
    Reading read{scene.dimension, used};
    read_keys(entry, keys, scene.dimension, read);
    find_inertia(entry, read);
    find_orientation(entry, read);
    check_motion(entry, read);
    entry.close();
    scene.bodies.push_back(defined(read));
  }
  if (!top.has("body")) top.error({}, "a scene needs at least one body", "start with a line [[body]]");
}

KeyTable keys_of_a_body() { return table_of("[[body]]", keys); }

}  // namespace cdot
