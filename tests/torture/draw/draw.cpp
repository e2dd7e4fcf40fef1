#include "tests/torture/draw/draw.hpp"

#include <algorithm>
#include <cmath>

#include "tests/torture/observer.hpp"

namespace cdot::torture {
namespace {

constexpr double pi = 3.14159265358979323846;

// The inertia of a few points of equal mass in the box: all tensors of rigid bodies, and no others.
Inertia random_inertia(Random& random, double mass, double size) {
  Inertia I;
  constexpr int points = 4;
  for (int k = 0; k < points; ++k) {
    const auto p = random.in_cube(size, true);
    const double m = mass / points;
    I.xx += m * (p[1] * p[1] + p[2] * p[2]), I.yy += m * (p[0] * p[0] + p[2] * p[2]);
    I.zz += m * (p[0] * p[0] + p[1] * p[1]);
    I.xy -= m * p[0] * p[1], I.xz -= m * p[0] * p[2], I.yz -= m * p[1] * p[2];
  }
  return I;
}

void orient(Random& random, SpatialBodyDefinition& d) {
  const auto axis = random.in_cube(1, true);
  d.e0 = random.between(-1, 1), d.e1 = axis[0], d.e2 = axis[1], d.e3 = axis[2];
  const double length = std::sqrt(d.e0 * d.e0 + d.e1 * d.e1 + d.e2 * d.e2 + d.e3 * d.e3);
  if (!(length > 1e-3)) d.e0 = 1, d.e1 = d.e2 = d.e3 = 0;
  else d.e0 /= length, d.e1 /= length, d.e2 /= length, d.e3 /= length;
}

std::vector<double> cut(const std::array<double, 3>& v, Dimension dimension) {
  return {v.begin(), v.begin() + (dimension == Dimension::planar ? 2 : 3)};
}

// In a body's frame: within the body's size. In the world: near another body of the joint.
std::vector<double> random_point(Random& random, const Scales& scales, const Scene& scene,
                                 const std::vector<int>& bodies, int body) {
  const bool in_space = scene.dimension == Dimension::spatial;
  auto p = random.in_cube(0.5 * scales.length, in_space);
  if (body != world_body) return cut(p, scene.dimension);
  for (const int other : bodies) {
    if (other == world_body) continue;
    const SceneBody& near = scene.bodies[static_cast<std::size_t>(other)];
    const std::array<double, 3> x = in_space ? std::array{near.spatial.x, near.spatial.y, near.spatial.z}
                                             : std::array{near.definition.x, near.definition.y, 0.0};
    for (std::size_t k = 0; k < 3; ++k) p[k] += x[k];
    break;
  }
  return cut(p, scene.dimension);
}

double random_scalar(Random& random, const Scales& scales, std::string_view unit) {
  if (unit == "m") return random.between(0.2, 1) * scales.length;
  if (unit == "rad") return random.between(0.2, 1.5);
  if (unit == "rad/s") return random.either_sign(random.between(0.1, 1) * scales.rate);
  if (unit == "rad/m") return random.between(0.3, 3) / scales.length;
  if (unit == "m/rad") return random.either_sign(random.between(0.1, 1) * scales.length);
  return random.either_sign(random.between(0.3, 3));
}

std::vector<double> random_direction(Random& random, const ParameterInfo& info, Dimension dimension) {
  auto d = random.in_cube(1, dimension == Dimension::spatial);
  if (std::hypot(d[0], d[1], d[2]) < 0.05) d[0] = 1;
  (void)info;
  return cut(d, dimension);
}

}  // namespace

SceneBody random_body(Random& random, const Scales& scales, Dimension dimension) {
  SceneBody body;
  const bool in_space = dimension == Dimension::spatial;
  const double mass = scales.mass * random.log_between(1 / scales.spread, scales.spread);
  const double size = scales.length * random.between(0.1, 1);
  const auto x = random.in_cube(2 * scales.length, in_space);
  const bool turns = !random.chance(0.05);
  BodyDefinition& p = body.definition;
  SpatialBodyDefinition& s = body.spatial;
  if (in_space) {
    s.mass = mass, s.x = x[0], s.y = x[1], s.z = x[2], s.fixed_rotation = !turns;
    if (turns) s.inertia = random_inertia(random, mass, size);
    if (turns && random.chance(0.3)) s.inertia = {s.inertia.xx, s.inertia.xx, s.inertia.xx};
    orient(random, s);
  } else {
    p.mass = mass, p.x = x[0], p.y = x[1], p.fixed_rotation = !turns;
    if (turns) p.inertia = mass * size * size / 3;
    p.angle = random.between(-pi, pi);
  }
  return body;
}

void make_static(SceneBody& body) {
  body.is_static = body.definition.is_static = body.spatial.is_static = true;
  body.definition.mass = body.definition.inertia = body.spatial.mass = 0;
  body.spatial.inertia = {};
  body.definition.fixed_rotation = body.spatial.fixed_rotation = false;
}

void disturb(Random& random, const Scales& scales, Dimension dimension, SceneBody& body) {
  if (body.is_static) return;
  const auto dx = random.in_cube(0.1 * scales.length, dimension == Dimension::spatial);
  BodyDefinition& p = body.definition;
  SpatialBodyDefinition& s = body.spatial;
  if (dimension == Dimension::planar) {
    p.x += dx[0], p.y += dx[1], p.angle += random.between(-0.2, 0.2);
    return;
  }
  const auto turn = random.in_cube(0.1, true);
  s.x += dx[0], s.y += dx[1], s.z += dx[2];
  s.e0 += turn[0], s.e1 += turn[1], s.e2 += turn[2], s.e3 -= turn[0];
}

void set_in_motion(Random& random, const Scales& scales, Dimension dimension, SceneBody& body) {
  if (body.is_static) return;
  const bool in_space = dimension == Dimension::spatial;
  const auto v = random.in_cube(scales.length * scales.rate, in_space), w = random.in_cube(scales.rate, true);
  BodyDefinition& p = body.definition;
  SpatialBodyDefinition& s = body.spatial;
  if (in_space) {
    s.vx = v[0], s.vy = v[1], s.vz = v[2];
    if (!s.fixed_rotation) s.wx = w[0], s.wy = w[1], s.wz = w[2];
  } else {
    p.vx = v[0], p.vy = v[1];
    if (!p.fixed_rotation) p.w = w[2];
  }
}

std::vector<NamedValue> random_parameters(Random& random, const Scales& scales, const JointType& type,
                                          const Scene& scene, const std::vector<int>& bodies) {
  std::vector<NamedValue> values;
  for (const ParameterInfo& info : type.parameters) {
    const bool point = info.kind == ParameterKind::point;
    if (info.has_default && !(info.kind != ParameterKind::scalar && random.chance(0.15))) continue;
    const int body = info.body < 0 ? world_body : bodies[static_cast<std::size_t>(info.body)];
    std::vector<double> numbers;
    if (info.kind == ParameterKind::scalar) numbers = {random_scalar(random, scales, info.unit)};
    else if (point || info.kind == ParameterKind::vector) numbers = random_point(random, scales, scene, bodies, body);
    else numbers = random_direction(random, info, scene.dimension);
    values.push_back({std::string(info.name), numbers});
  }
  return values;
}

std::vector<NamedValue> all_parameters(const JointType& type, const std::vector<double>& numbers) {
  std::vector<NamedValue> values;
  for (const ParameterInfo& info : type.parameters) {
    const auto first = numbers.begin() + info.offset;
    values.push_back({std::string(info.name), {first, first + (info.size == 9 ? 6 : info.size)}});
  }
  return values;
}

void loosen(Random& random, const JointType& type, std::vector<NamedValue>& parameters) {
  const bool one_sided = std::count(type.row_kinds.begin(), type.row_kinds.end(), RowKind::inequality) > 0;
  if (!one_sided || !random.chance(0.5)) return;
  for (NamedValue& value : parameters)
    if (value.numbers.size() == 1) value.numbers[0] *= random.between(1, 1.5);
}

template <class S>
void take_state(const BasicWorld<S>& world, int index, SceneBody& body) {
  if (body.is_static) return;
  const auto q = world.place(index);
  const auto v = world.velocity(index);
  if constexpr (S::dimension == Dimension::planar) {
    BodyDefinition& d = body.definition;
    d.x = q.x, d.y = q.y, d.angle = q.angle;
    d.vx = v.x, d.vy = v.y, d.w = v.w;
  } else {
    SpatialBodyDefinition& d = body.spatial;
    d.x = q.x, d.y = q.y, d.z = q.z, d.e0 = q.e0, d.e1 = q.e1, d.e2 = q.e2, d.e3 = q.e3;
    d.vx = v.x, d.vy = v.y, d.vz = v.z, d.wx = v.wx, d.wy = v.wy, d.wz = v.wz;
  }
}

template <class S>
bool on_joints(BasicWorld<S>& world, const Scene& scene) {
  return gap_of(world, scene, row_sizes(world)).share < 1e-10;
}

namespace {

Softness random_softness(Random& random, const Scales& scales, bool turns) {
  Softness s;
  s.by_frequency = random.chance(0.3);
  const double stiffness = scales.mass * scales.rate * scales.rate * random.log_between(0.1, 1000);
  const bool damped = random.chance(0.5);
  s.frequency = scales.rate * random.log_between(0.1, 10);
  s.damping_ratio = damped ? random.between(0, 2) : 0;
  s.stiffness = turns ? stiffness * scales.length * scales.length : stiffness;
  s.damping = damped ? s.stiffness / scales.rate * random.between(0, 0.1) : 0;
  if (s.by_frequency) s.stiffness = s.damping = 0;
  else s.frequency = s.damping_ratio = 0;
  return s;
}

// One or two effects on a coordinate with the value `now`.
CoordinateEffects random_effects(Random& random, const Scales& scales, const CoordinateInfo& info, double now) {
  CoordinateEffects effects;
  effects.coordinate = info.name;
  const bool turns = info.unit == "rad";
  const double unit = turns ? 1 : scales.length;
  const double force = scales.mass * scales.length * scales.rate * scales.rate * unit * random.log_between(0.1, 10);
  const int kind = random.below(5);
  if (kind == 0 || random.chance(0.1)) {
    effects.limit = Limit{now - random.between(0, 1) * unit, now + random.between(0, 1) * unit};
    if (random.chance(0.2)) effects.limit->lower.reset();
  }
  if (kind == 1) {
    effects.motor = Motor{random.between(-1, 1) * scales.rate * unit, unlimited};
    if (random.chance(0.8)) effects.motor->max_force = force;
  }
  if (kind == 2 || random.chance(0.1)) effects.springs.push_back({random_softness(random, scales, turns), now});
  if (kind == 3) effects.springs.push_back({{.by_frequency = false, .damping = force / (scales.rate * unit)}, 0.0});
  if (kind == 4) effects.friction = DryFriction{force};
  return effects;
}

void add_point_spring(Random& random, const Scales& scales, Scene& scene) {
  const int bodies = static_cast<int>(scene.bodies.size());
  SpringDefinition spring;
  spring.body_a = random.below(bodies);
  spring.body_b = random.below(bodies + 1) - 1;  // world_body is -1
  if (spring.body_a == spring.body_b) return;
  const auto a = random.in_cube(0.5 * scales.length, scene.dimension == Dimension::spatial);
  spring.ax = a[0], spring.ay = a[1], spring.az = a[2];
  spring.stiffness = scales.mass * scales.rate * scales.rate * random.log_between(0.1, 100);
  spring.rest_length = scales.length * random.between(0, 2);
  if (random.chance(0.5)) spring.damping = 0.1 * spring.stiffness / scales.rate;
  scene.springs.push_back({spring, {}});
}

void push(Random& random, const Scales& scales, SceneBody& body) {
  if (body.is_static) return;
  const double force = scales.mass * scales.length * scales.rate * scales.rate * random.between(-1, 1);
  body.definition.force_x = body.spatial.force_x = force;
  if (random.chance(0.3)) body.definition.torque = body.spatial.torque_z = force * scales.length;
  if (random.chance(0.3)) body.definition.linear_damping = body.spatial.linear_damping = scales.rate * random.unit();
  if (random.chance(0.3)) body.definition.angular_damping = body.spatial.angular_damping = scales.rate * random.unit();
}

}  // namespace

// An angle between antiparallel axes jumps: the World refuses effects on it.
template <class S>
bool has_value(BasicWorld<S> world, int joint, std::string_view coordinate) {
  try {
    add_motor(world, joint, coordinate, {0, 0});
  } catch (const Error&) {
    return false;
  }
  return true;
}

template <class S>
void add_effects(Random& random, const Scales& scales, Scene& scene) {
  const BasicWorld<S> world = build_world_in<S>(scene);
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    SceneJoint& joint = scene.joints[j];
    const JointType& type = world.joint_type(static_cast<int>(j));
    for (const CoordinateInfo& coordinate : type.coordinates)
      if (random.chance(0.4) && has_value(build_world_in<S>(scene), static_cast<int>(j), coordinate.name))
        joint.effects.push_back(
            random_effects(random, scales, coordinate, world.coordinate(static_cast<int>(j), coordinate.name)));
    if (random.chance(0.1)) joint.definition.soft = random_softness(random, scales, false);
    if (random.chance(0.05))
      joint.bonds = {
          {"breaking",
           {{"strength", {scales.mass * scales.length * scales.rate * scales.rate * random.log_between(1, 100)}}}}};
  }
  if (random.chance(0.3)) add_point_spring(random, scales, scene);
  for (SceneBody& body : scene.bodies)
    if (random.chance(0.1)) push(random, scales, body);
}

#define CDOT_INSTANTIATE(S)                                        \
  template void take_state(const BasicWorld<S>&, int, SceneBody&); \
  template bool on_joints(BasicWorld<S>&, const Scene&);           \
  template void add_effects<S>(Random&, const Scales&, Scene&);
CDOT_INSTANTIATE(Planar<double>)
CDOT_INSTANTIATE(Spatial<double>)
#undef CDOT_INSTANTIATE

}  // namespace cdot::torture
