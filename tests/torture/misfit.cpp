#include "tests/torture/misfit.hpp"

#include <fmt/format.h>

#include "tests/torture/draw/random.hpp"
#include "tests/torture/excuses.hpp"
#include "tests/torture/laws.hpp"
#include "tests/torture/observer.hpp"
#include "tests/torture/trial.hpp"

namespace cdot::torture {
namespace {

constexpr double creeping = 0.01;  // of the misfit, in half of the run

double length_of(const Scene& scene) {
  return in_space_of(scene, [&](auto space) {
    auto world = build_world_in<decltype(space)>(scene);
    return row_sizes(world).length;
  });
}

const JointType& type_of(const Scene& scene, const SceneJoint& joint) {
  return *find_joint_type(scene.dimension, joint.definition.type);
}

template <class Definition>
void stop(Definition& d) {
  d.vx = d.vy = d.force_x = d.force_y = d.linear_damping = d.angular_damping = 0;
}

void bring_to_rest(Scene& scene) {
  Settings& s = scene.settings;
  s.gravity_x = s.gravity_y = s.gravity_z = s.sleep_after = 0;
  for (SceneBody& body : scene.bodies) {
    stop(body.definition), stop(body.spatial);
    body.definition.w = body.definition.torque = 0;
    SpatialBodyDefinition& d = body.spatial;
    d.vz = d.wx = d.wy = d.wz = d.force_z = d.torque_x = d.torque_y = d.torque_z = 0;
  }
  scene.springs.clear();
  std::erase_if(scene.joints, [&](const SceneJoint& joint) { return type_of(scene, joint).explicit_time; });
  for (SceneJoint& joint : scene.joints) joint.effects.clear(), joint.bonds.clear(), joint.definition.soft.reset();
}

// The numbers of a point of the joint; null: it has none.
std::vector<double>* point_of(Random& random, const Scene& scene, SceneJoint& joint) {
  std::vector<std::vector<double>*> points;
  for (const ParameterInfo& info : type_of(scene, joint).parameters)
    for (NamedValue& value : joint.definition.parameters)
      if (value.name == info.name && info.kind == ParameterKind::point) points.push_back(&value.numbers);
  return points.empty() ? nullptr : random.of(points);
}

void spoil(Random& random, Scene& scene) {
  if (scene.joints.empty()) return;
  SceneJoint joint = random.of(scene.joints);
  const bool twice = random.chance(0.7);
  const double length = length_of(scene), off = length * random.log_between(1e-5, 1e-3);
  std::vector<double>* const point = point_of(random, scene, joint);
  if (!point) return;
  const auto direction = random.in_cube(1, scene.dimension == Dimension::spatial);
  for (std::size_t k = 0; k < point->size(); ++k) (*point)[k] += off * direction[k];
  for (SceneJoint& other : scene.joints)
    if (!twice && other.name == joint.name) other = joint;
  if (!twice) return;
  joint.name += "_off";
  scene.joints.push_back(std::move(joint));
}

// The longest way of a body between two moments; rotations count with the arm `length`.
template <class S>
double way_between(const std::vector<typename S::Place>& from, const std::vector<typename S::Place>& to,
                   double length) {
  double longest = 0;
  for (std::size_t k = 0; k < from.size(); ++k) {
    const auto &p = from[k], &q = to[k];
    double way = 0, turn = 0;
    if constexpr (S::dimension == Dimension::planar) {
      way = std::hypot(q.x - p.x, q.y - p.y), turn = std::abs(q.angle - p.angle);
    } else {
      way = std::hypot(q.x - p.x, q.y - p.y, q.z - p.z);
      const double same = p.e0 * q.e0 + p.e1 * q.e1 + p.e2 * q.e2 + p.e3 * q.e3, sign = same < 0 ? -1 : 1;
      turn = 2 * std::hypot(std::hypot(q.e0 - sign * p.e0, q.e1 - sign * p.e1),
                            std::hypot(q.e2 - sign * p.e2, q.e3 - sign * p.e3));
    }
    longest = std::max({longest, way, turn * length});
  }
  return longest;
}

template <class S>
std::vector<typename S::Place> places_of(const BasicWorld<S>& world, const Scene& scene) {
  std::vector<typename S::Place> places;
  for (int b = 0; b < static_cast<int>(scene.bodies.size()); ++b) places.push_back(world.place(b));
  return places;
}

template <class S>
Verdict watch(const Scene& scene) {
  using T = typename S::Scalar;
  BasicWorld<S> world = build_world_in<S>(scene);
  const double length = row_sizes(world).length;
  const double off = gap_of(world, scene, row_sizes(world)).share;  // of the size
  if (world.project(by_precision<T>(1e-4, 1e-9))) return verdict(Outcome::held, "the joints fit", "");
  world.prepare();
  auto middle = places_of(world, scene);
  const int steps = steps_of(scene);
  for (int k = 1; k <= steps; ++k) {
    if (const StepResult result = world.step(scene.step); !result)
      return verdict(Outcome::limited, fmt::format("the World says: {}", name_of(result.problem)), "", 0, 0, k);
    if (k == steps / 2) middle = places_of(world, scene);
  }
  const double crept = way_between<S>(middle, places_of(world, scene), length) / length;
  const double bound = creeping * off + by_precision<T>(1e-5, 1e-11);
  if (!(crept <= bound)) return verdict(Outcome::broken, "creeps", "", crept, bound, steps);
  const double speed = bound * length / scene.duration, mass = motion_of(world).root_mass * motion_of(world).root_mass;
  const Balance balance = world.balance();
  if (!(balance.method() <= 0.5 * mass * speed * speed))
    return verdict(Outcome::broken, "energy of a mechanism at rest", "", balance.method(), 0.5 * mass * speed * speed,
                   steps);
  return verdict(Outcome::held, "told", "", crept, bound, steps);
}

template <class S>
Verdict judge_in(const Scene& scene) {
  const Verdict seen = watch<S>(scene);
  if (!seen.broken() || heaviest_over_lightest(scene) * told_apart<typename S::Scalar> <= 1) return seen;
  return verdict(Outcome::limited, "masses further apart than pivots are told from round-off: " + seen.what, "",
                 seen.value, seen.bound, seen.step);
}

}  // namespace

Mechanism nearly_misfitting(std::uint64_t seed, Wish wish) {
  wish.solver = Solver::direct, wish.drift = Drift::projection;
  Mechanism made = generate(seed, wish);
  try {
    bring_to_rest(made.scene);
    Random random(~seed);
    spoil(random, made.scene);
  } catch (const std::exception&) {  // judge_misfit() refuses the mechanism for the same reason
  }
  return made;
}

Verdict judge_misfit(const Scene& scene) {
  try {
    return in_space_of(scene, [&](auto space) { return judge_in<decltype(space)>(scene); });
  } catch (const SceneError& error) {
    return verdict(Outcome::refused, error.what(), "");
  } catch (const Error& error) {
    return verdict(Outcome::refused, error.what(), "");
  }
}

}  // namespace cdot::torture
