// The [[body]] entries of a scene in space: an orientation is a quaternion or an axis and an angle,
// an inertia a number, three principal moments or a tensor.
#include <cmath>
#include <fmt/format.h>

#include "runtime/tool/scene/read.hpp"

namespace cdot {
namespace {

// Of a body of uniform density about its centre: a rod is a cylinder along x, a disc one about z.
Inertia uniform_inertia(const Shape& shape, double mass) {
  const auto square = [](double x) { return x * x; };
  const auto box = [&](double x, double y, double z) {
    return Inertia{mass * (square(y) + square(z)) / 12, mass * (square(x) + square(z)) / 12,
                   mass * (square(x) + square(y)) / 12};
  };
  const auto cylinder = [&](double radius, double height) {  // along it, across it
    return std::pair{mass * square(radius) / 2, mass * (3 * square(radius) + square(height)) / 12};
  };
  if (shape.kind == Shape::box) return box(shape.length, shape.width, shape.depth);
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

// inertia = I, [Ixx, Iyy, Izz] or [[…], […], […]] in the frame of the body
std::optional<Inertia> read_inertia(Entry& body) {
  if (body.is_array_of_arrays("inertia")) {
    const auto m = body.rows("inertia", 3);
    if (!m) return {};
    const std::vector<double>& I = *m;
    if (I[1] != I[3] || I[2] != I[6] || I[5] != I[7])
      body.error(body.where("inertia"), "the inertia tensor is not symmetric", "row i, column j as row j, column i");
    return Inertia{I[0], I[4], I[8], I[1], I[2], I[5]};
  }
  if (body.is_array("inertia")) {
    const auto I = body.numbers("inertia", 3, {Sign::positive});
    if (!I) return {};
    return Inertia{(*I)[0], (*I)[1], (*I)[2]};
  }
  const auto I = body.number("inertia", {Sign::not_negative});
  if (!I) return {};
  return Inertia{*I, *I, *I};
}

void read_mass(Entry& body, const Shape& shape, SpatialBodyDefinition& definition) {
  definition.fixed_rotation = body.flag("fixed_rotation").value_or(false);
  const bool mass_given = body.has("mass"), inertia_given = body.has("inertia");
  definition.mass = body.number("mass", {Sign::positive}).value_or(0);
  const std::optional<Inertia> inertia = read_inertia(body);
  if (definition.is_static) return;
  if (!mass_given) body.error(body.header(), body.what() + " has no `mass`", "mass = 1.0, or static = true");
  if (inertia_given) {
    if (!inertia) return;  // said already
    definition.inertia = *inertia;
    const char* wrong = wrong_with(*inertia);
    if (wrong && !definition.fixed_rotation) body.error(body.where("inertia"), wrong);
    if (inertia->xx == 0 && !definition.fixed_rotation)
      body.error(body.where("inertia"), "`inertia` is 0, but the body is free to turn",
                 "a point mass on a pin needs fixed_rotation = true");
  } else if (shape.kind != Shape::none) {
    definition.inertia = uniform_inertia(shape, definition.mass);
  } else if (!definition.fixed_rotation) {
    body.error(body.header(), body.what() + " has no `inertia`",
               "inertia = [Ixx, Iyy, Izz], a shape to work it out from, or fixed_rotation = true");
  }
}

// orientation = [e0, e1, e2, e3], or axis = [x, y, z] and angle
void read_orientation(Entry& body, SpatialBodyDefinition& definition) {
  const bool quaternion = body.has("orientation"), axis = body.has("axis"), angle = body.has("angle");
  if (quaternion && (axis || angle))
    body.error(body.where("orientation"), "`orientation` and `axis`, `angle` say the same", "keep one of them");
  else if (axis != angle)
    body.error(body.where(axis ? "axis" : "angle"), axis ? "`axis` without `angle`" : "`angle` without `axis`",
               "axis = [0, 0, 1] and angle = \"30 deg\"");
  const auto e = body.numbers("orientation", 4);
  const auto n = read_vector(body, "axis", Dimension::spatial);
  const auto turn = body.number("angle", {Sign::any, true});
  if (e) {
    const double length = std::sqrt((*e)[0] * (*e)[0] + (*e)[1] * (*e)[1] + (*e)[2] * (*e)[2] + (*e)[3] * (*e)[3]);
    if (!(length > 1e-50)) body.error(body.where("orientation"), "the quaternion has length 0", "[1, 0, 0, 0]");
    definition.e0 = (*e)[0], definition.e1 = (*e)[1];
    definition.e2 = (*e)[2], definition.e3 = (*e)[3];
  }
  if (n && turn) {
    const double length = std::hypot((*n)[0], (*n)[1], (*n)[2]);
    if (!(length > 0)) {
      body.error(body.where("axis"), "the direction `axis` has length 0", "any other length will do: [0, 0, 1]");
      return;
    }
    const double c = std::cos(*turn / 2), s = std::sin(*turn / 2) / length;
    definition.e0 = c, definition.e1 = s * (*n)[0];
    definition.e2 = s * (*n)[1], definition.e3 = s * (*n)[2];
  }
}

void read_motion(Entry& body, SpatialBodyDefinition& definition) {
  const auto vector = [&](const char* key) { return read_vector(body, key, Dimension::spatial).value_or(Vec3{}); };
  const Vec3 position = vector("position"), velocity = vector("velocity");
  definition.x = position[0], definition.y = position[1], definition.z = position[2];
  definition.vx = velocity[0], definition.vy = velocity[1], definition.vz = velocity[2];
  const auto spin = body.numbers("spin", 3, {Sign::any, true});
  const Vec3 w = spin ? Vec3{(*spin)[0], (*spin)[1], (*spin)[2]} : Vec3{};
  definition.wx = w[0], definition.wy = w[1], definition.wz = w[2];
  check_motion(body, definition, velocity != Vec3{}, w != Vec3{});
}

void read_forces(Entry& body, SpatialBodyDefinition& definition) {
  const Vec3 force = read_vector(body, "force", Dimension::spatial).value_or(Vec3{});
  const Vec3 torque = read_vector(body, "torque", Dimension::spatial).value_or(Vec3{});
  definition.force_x = force[0], definition.force_y = force[1], definition.force_z = force[2];
  definition.torque_x = torque[0], definition.torque_y = torque[1], definition.torque_z = torque[2];
  definition.linear_damping = body.number("linear_damping", {Sign::not_negative}).value_or(0);
  definition.angular_damping = body.number("angular_damping", {Sign::not_negative}).value_or(0);
}

}  // namespace

void read_spatial_body(Entry& entry, SceneBody& body) {
  body.spatial.is_static = body.is_static;
  read_mass(entry, body.shape, body.spatial);
  read_orientation(entry, body.spatial);
  read_motion(entry, body.spatial);
  read_forces(entry, body.spatial);
}

}  // namespace cdot
