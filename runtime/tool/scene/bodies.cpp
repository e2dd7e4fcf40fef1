// The [[body]] entries of a scene: what is drawn, and in the plane mass, pose and motion. Those of
// a body in space are in tool/scene/bodies_spatial.cpp.
#include <cmath>
#include <fmt/format.h>

#include "runtime/tool/scene/read.hpp"

namespace cdot {
namespace {

// { rod = length, width = … }, { box = [along, across] } or { disc = radius }; in space as well
// { box = [x, y, z] }, { disc = radius, width = … } and { ball = radius }
Shape read_shape(Entry& body, Dimension dimension) {
  const bool in_space = dimension == Dimension::spatial;
  Shape shape;
  std::optional<Entry> entry =
      body.table("shape", in_space ? "shape = { rod = 1.0 }, { box = [1, 0.5, 0.2] } or { ball = 0.2 }"
                                   : "shape = { rod = 1.0 }, { box = [1, 0.5] } or { disc = 0.2 }");
  if (!entry) return shape;
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
  return shape;
}

// Moment of inertia about the centre of a body of uniform density.
double uniform_inertia(const Shape& shape, double mass) {
  switch (shape.kind) {
    case Shape::rod: return mass * shape.length * shape.length / 12;
    case Shape::box: return mass * (shape.length * shape.length + shape.width * shape.width) / 12;
    case Shape::disc: return mass * shape.length * shape.length / 8;
    case Shape::ball:
    case Shape::none: return 0;
  }
  return 0;
}

void read_planar_mass(Entry& body, const Shape& shape, BodyDefinition& definition) {
  definition.fixed_rotation = body.flag("fixed_rotation").value_or(false);
  const bool mass_given = body.has("mass"), inertia_given = body.has("inertia");
  definition.mass = body.number("mass", {Sign::positive}).value_or(0);
  const std::optional<double> inertia = body.number("inertia", {Sign::not_negative});
  if (definition.is_static) return;
  if (!mass_given) body.error(body.header(), body.what() + " has no `mass`", "mass = 1.0, or static = true");
  definition.inertia = inertia_given ? inertia.value_or(1) : uniform_inertia(shape, definition.mass);
  if (definition.fixed_rotation || definition.inertia > 0) return;
  if (inertia_given) {
    body.error(body.where("inertia"), "`inertia` is 0, but the body is free to turn",
               "a point mass on a pin needs fixed_rotation = true");
  } else if (shape.kind == Shape::none) {
    body.error(body.header(), body.what() + " has no `inertia`",
               "inertia = …, a shape to work it out from, or fixed_rotation = true");
  }
}

void read_motion(Entry& body, BodyDefinition& definition) {
  const Vec3 position = read_vector(body, "position", Dimension::planar).value_or(Vec3{});
  definition.x = position[0];
  definition.y = position[1];
  definition.angle = body.number("angle", {Sign::any, true}).value_or(0);
  const Vec3 velocity = read_vector(body, "velocity", Dimension::planar).value_or(Vec3{});
  definition.vx = velocity[0];
  definition.vy = velocity[1];
  definition.w = body.number("spin", {Sign::any, true}).value_or(0);
  check_motion(body, definition, velocity != Vec3{}, definition.w != 0);
}

void read_forces(Entry& body, BodyDefinition& definition) {
  const Vec3 force = read_vector(body, "force", Dimension::planar).value_or(Vec3{});
  definition.force_x = force[0];
  definition.force_y = force[1];
  definition.torque = body.number("torque").value_or(0);
  definition.linear_damping = body.number("linear_damping", {Sign::not_negative}).value_or(0);
  definition.angular_damping = body.number("angular_damping", {Sign::not_negative}).value_or(0);
}

// trace = true for the centre, [x, y] for a point of the body
std::vector<Vec3> read_trace(Entry& body, Dimension dimension) {
  if (body.is_array("trace")) {
    const std::optional<Vec3> point = read_vector(body, "trace", dimension);
    return point ? std::vector<Vec3>{*point} : std::vector<Vec3>{};
  }
  return body.flag("trace").value_or(false) ? std::vector<Vec3>{Vec3{}} : std::vector<Vec3>{};
}

void read_planar_body(Entry& entry, SceneBody& body) {
  body.definition.is_static = body.is_static;
  read_planar_mass(entry, body.shape, body.definition);
  read_motion(entry, body.definition);
  read_forces(entry, body.definition);
}

}  // namespace

void read_bodies(Entry& top, Scene& scene) {
  std::map<std::string, Span> used{{"world", {}}};
  for (Entry& entry : top.list("body")) {
    SceneBody body;
    body.name = read_name(entry, used, std::nullopt).value_or("");
    body.shape = read_shape(entry, scene.dimension);
    body.is_static = entry.flag("static").value_or(false);
    if (scene.dimension == Dimension::planar) read_planar_body(entry, body);
    else read_spatial_body(entry, body);
    body.traces = read_trace(entry, scene.dimension);
    entry.close();
    scene.bodies.push_back(std::move(body));
  }
  if (!top.has("body")) top.error({}, "a scene needs at least one body", "start with a line [[body]]");
}

}  // namespace cdot
