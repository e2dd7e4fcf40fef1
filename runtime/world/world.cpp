// Sets a World up and changes it. world/queries.cpp has the queries, world/step.cpp has step().
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include <cdot/detail/joint_table.hpp>
#include <cdot/world.hpp>

#include "runtime/balance/balance.hpp"
#include "runtime/rows/laws.hpp"
#include "runtime/rows/parameters.hpp"
#include "runtime/state/add_rows.hpp"
#include "runtime/state/checks.hpp"
#include "runtime/state/drives.hpp"
#include "runtime/state/gyroscopes.hpp"
#include "runtime/text/spelling.hpp"
#include "runtime/world/islands.hpp"

namespace cdot {
namespace {

void require(bool condition, std::string_view message) {
  if (!condition) throw Error(std::string(message));
}

void check(const Settings& s) {
  require(s.iterations >= 1, "iterations must be at least 1");
  require(s.substeps >= 1, "substeps must be at least 1");
  require(s.baumgarte >= 0 && s.baumgarte <= 1, "baumgarte must lie between 0 and 1");
  require(std::isfinite(s.gravity_x) && std::isfinite(s.gravity_y) && std::isfinite(s.gravity_z),
          "gravity must be finite");
  require(s.local_error >= 0 && std::isfinite(s.local_error), "local_error must be finite and >= 0");
  if (const char* wrong = mistake_in_methods(s)) throw Error(wrong);
  require(s.sleep_after >= 0 && s.sleep_speed >= 0, "sleep settings must be >= 0");
}

// "; did you mean `revolute`?" for a joint that does not exist.
template <class S>
std::string near_type(const std::string& word) {
  std::vector<std::string> names;
  for (const JointType& type : joint_types(S::dimension)) names.emplace_back(type.name);
  return text::did_you_mean(word, names);
}

// Checks that bodies of both dimensions share.
template <class Definition>
void check_common(const Definition& d, bool moves, std::initializer_list<double> numbers) {
  for (double number : numbers) require(std::isfinite(number), "every number of a body must be finite");
  require(d.is_static || d.mass > 0, "a body that is not static needs a mass > 0");
  require(d.mass >= 0, "mass and inertia must not be negative");
  require(!d.is_static || !moves, "a static body has no velocity");
  require(d.linear_damping >= 0 && d.angular_damping >= 0, "damping must not be negative");
}

void check(const BodyDefinition& d) {
  check_common(d, d.vx != 0 || d.vy != 0 || d.w != 0,
               {d.x, d.y, d.angle, d.vx, d.vy, d.w, d.mass, d.inertia, d.force_x, d.force_y, d.torque, d.linear_damping,
                d.angular_damping});
  require(d.inertia >= 0, "mass and inertia must not be negative");
}

void check(const SpatialBodyDefinition& d) {
  const bool moves = d.vx != 0 || d.vy != 0 || d.vz != 0 || d.wx != 0 || d.wy != 0 || d.wz != 0;
  // clang-format off
  check_common(d, moves, {d.x, d.y, d.z, d.e0, d.e1, d.e2, d.e3, d.vx, d.vy, d.vz, d.wx, d.wy, d.wz, d.mass,
                          d.inertia.xx, d.inertia.yy, d.inertia.zz, d.inertia.xy, d.inertia.xz, d.inertia.yz,
                          d.force_x, d.force_y, d.force_z, d.torque_x, d.torque_y, d.torque_z,
                          d.linear_damping, d.angular_damping});
  // clang-format on
  if (const char* wrong = mistake_in(d.inertia)) throw Error(wrong);
  require(d.e0 * d.e0 + d.e1 * d.e1 + d.e2 * d.e2 + d.e3 * d.e3 > 1e-100,
          "an orientation must not be the zero quaternion");
}

template <class S>
void check_finite(const typename S::Velocity& v, const char* message) {
  typename S::Scalar numbers[S::freedom];
  S::write(v, numbers);
  for (auto number : numbers) require(std::isfinite(number), message);
}

// Checks in the World's own precision, which may be float.
template <class S>
void check_finite(const typename S::Pose& q) {
  typename S::Scalar numbers[S::pose_numbers];
  S::write(q, numbers);
  for (auto number : numbers)
    require(std::isfinite(number), "every number of a pose must be finite, and an orientation not the zero quaternion");
}

template <class S>
void check_in_precision(const typename S::BodyDefinition& d) {
  check_finite<S>(S::placed(S::place_of(d)));
  check_finite<S>(S::velocity_of(d), "every number of a body must be finite");
  check_finite<S>(S::components(S::wrench_of(d)), "every number of a body must be finite");
  typename S::Velocity one{}, weighted;
  typename S::Scalar numbers[S::freedom];
  std::fill_n(numbers, S::freedom, typename S::Scalar(1));
  one = S::read_velocity(numbers);
  weighted = S::weighted(S::inverse_mass_of(d), one);
  check_finite<S>(weighted, "a mass or inertia is too small: its inverse overflows in this precision");
  require(d.is_static || weighted.x > 0, "a mass is too large: its inverse underflows in this precision");
}

template <class S>
void check_body(const WorldData<S>& world, int body) {
  if (body < 0 || body >= world.bodies.count()) throw Error(fmt::format("there is no body number {}", body));
}

template <class S>
void check_joint_bodies(const WorldData<S>& world, const JointType& type, const std::vector<int>& bodies) {
  if (static_cast<int>(bodies.size()) != type.bodies)
    throw Error(fmt::format("joint `{}` connects {} bod{}, not {}", type.name, type.bodies,
                            type.bodies == 1 ? "y" : "ies", bodies.size()));
  for (size_t i = 0; i < bodies.size(); ++i) {
    check_body(world, bodies[i]);
    for (size_t j = 0; j < i; ++j)
      if (bodies[i] == bodies[j] && !world.bodies.immovable(bodies[i]))
        throw Error(fmt::format("joint `{}` names the same movable body twice", type.name));
  }
}

template <class S>
void set_acceleration(WorldData<S>& world, int body) {
  using T = typename S::Scalar;
  Bodies<S>& all = world.bodies;
  const auto own = S::weighted(all.inverse_mass[body], all.force[body]);
  const auto gravity = S::gravity(world.settings);
  const bool falls = !all.immovable(body);
  all.acceleration[body] = S::sum(own, gravity, falls ? T(1) : T(0));
  if constexpr (S::has_gyroscopes)
    with_gyroscope(world, body, [&](auto& gyroscope) { S::set_torque(gyroscope, all.force[body]); });
}

}  // namespace

template <class S>
BasicWorld<S>::BasicWorld(const Settings& settings) : data_(std::make_unique<WorldData<S>>()) {
  check(settings);
  data_->settings = settings;
}
template <class S>
BasicWorld<S>::~BasicWorld() = default;
template <class S>
BasicWorld<S>::BasicWorld(BasicWorld&&) noexcept = default;
template <class S>
BasicWorld<S>& BasicWorld<S>::operator=(BasicWorld&&) noexcept = default;

template <class S>
void BasicWorld<S>::set_origin(double x, double y, double z) {
  require(data_->bodies.count() == 0, "set_origin() must come before the first add_body()");
  require(std::isfinite(x) && std::isfinite(y) && std::isfinite(z), "the origin must be finite");
  data_->origin = {x, y, z};
}

template <class S>
int BasicWorld<S>::add_body(const BodyDefinition& d) {
  check(d);
  check_in_precision<S>(d);
  Bodies<S>& all = data_->bodies;
  const int body = all.count();
  note_change(*data_);
  const auto m = S::inverse_mass_of(d);
  all.pose.push_back(S::placed(moved_by(S::place_of(d), data_->origin, -1)));
  all.velocity.push_back(S::velocity_of(d));
  all.inverse_mass.push_back(m);
  all.effective_mass.push_back(m);
  all.mass.push_back(S::inverted(m));
  all.force.push_back(S::components(S::wrench_of(d)));
  all.acceleration.push_back({}), all.velocity_rate.push_back({});
  all.displacement.push_back({}), all.increment.push_back({}), all.stiffness.push_back({});
  all.start.push_back(all.pose[body]);
  if constexpr (S::has_gyroscopes)
    if (S::is_gyroscope(d)) data_->turning.push_back(body), data_->gyroscopes.push_back(S::gyroscope_of(d));
  set_acceleration(*data_, body);
  if (!d.is_static && (d.linear_damping > 0 || d.angular_damping > 0))
    data_->drags.push_back({body, T(d.linear_damping), T(d.angular_damping)});
  data_->prepared = false;
  return body;
}

template <class S>
int BasicWorld<S>::ground() {
  if (data_->ground >= 0) return data_->ground;
  BodyDefinition d = moved_by(BodyDefinition{}, data_->origin, 1);
  d.is_static = true;
  data_->ground = add_body(d);
  return data_->ground;
}

template <class S>
int BasicWorld<S>::add_joint(const JointDefinition& definition) {
  const JointType* type = find_joint_type(S::dimension, definition.type);
  if (!type) throw Error(fmt::format("there is no joint `{}`{}", definition.type, near_type<S>(definition.type)));
  if (is_extended<T> && type - joint_types(S::dimension).data() >= std::ssize(joint_entries<S>()))
    throw Error(fmt::format("joint `{}` was not made for extended precision", type->name));
  check_joint_bodies(*data_, *type, definition.bodies);
  JointRecord record;
  record.type = static_cast<int>(type - joint_types(S::dimension).data());
  record.bodies = definition.bodies;
  using InDoubles = typename S::InDoubles;
  std::vector<typename InDoubles::Pose> poses;
  for (int body : record.bodies) poses.push_back(InDoubles::placed(place_in_world(*data_, body)));
  const std::vector<NamedValue> given = at_time(definition.parameters, data_->time);
  auto numbers = parameter_numbers<InDoubles>(record.type, given, poses.data(), data_->time);
  check_functions(*type, given);
  move_world_points(
      *type, record.bodies, [&](int body) { return body == data_->ground; }, data_->origin, -1, numbers);
  record.parameters = numbers;
  if (type->is_effect && definition.soft)
    throw Error(fmt::format("`{}` is an effect: it has a law of its own and cannot be a spring", type->name));
  double spring[spring_constants_count] = {};
  if (definition.soft) spring_constants(*definition.soft, spring);

  record.added.add(record.type), record.added.add(record.bodies), record.added.add(numbers);

  check_rows(*data_, record, definition.soft.has_value());
  const int joint = joint_count();
  note_change(*data_);
  data_->joints.push_back(record);
  const auto movable = [&](int body) { return !data_->bodies.immovable(body); };
  if (std::none_of(record.bodies.begin(), record.bodies.end(), movable)) {
    data_->notes.push_back({joint, "connects only immovable bodies and does nothing"});
    return joint;
  }
  if (type->is_effect && moves_nothing(*data_, record, -1))
    data_->notes.push_back({joint, "pushes its bodies where they cannot move, and does nothing"});
  const auto& kinds = type->row_kinds;
  const bool unilateral = std::count(kinds.begin(), kinds.end(), RowKind::inequality) > 0;
  const Law<S>* const own = joint_entries<S>()[record.type].law;
  const Law<S>* law = own ? own : definition.soft ? &soft_law<S>() : unilateral ? &unilateral_law<S>() : nullptr;
  const auto* ops = joint_entries<S>()[record.type].rows.choose(data_->bodies, record.bodies);
  add_rows(*data_, joint, ops, law, kinds, {spring, definition.soft ? static_cast<size_t>(spring_constants_count) : 0},
           definition.soft ? "spring" : "");
  add_bounded_rows(*data_, joint);
  add_drives(*data_, joint, -1, *type, given);
  return joint;
}

template <class S>
int BasicWorld<S>::add_spring(const SpringDefinition& d) {
  check_body(*data_, d.body_a);
  check_body(*data_, d.body_b);
  constexpr const char* along = "distance";
  require(d.body_a != d.body_b, "a spring connects two different bodies");
  for (double number : {d.ax, d.ay, d.az, d.bx, d.by, d.bz, d.stiffness, d.rest_length, d.damping})
    require(std::isfinite(number), "every number of a spring must be finite");
  require(d.stiffness >= 0 && d.damping >= 0, "stiffness and damping must not be negative");
  require(d.rest_length >= 0, "a rest length must not be negative");
  const auto joined = [&](const char* type, double stiffness, double damping) {
    const auto point = [](double x, double y, double z) {
      return S::dimension == Dimension::planar ? std::vector{x, y} : std::vector{x, y, z};
    };
    if (!find_joint_type(S::dimension, type))
      throw Error(
          fmt::format("a spring between points is a soft `{}`, which this program does not use: add that joint "
                      "to cdot_use_joints",
                      type));
    JointDefinition joint{type, {d.body_a, d.body_b}, {}, {}};
    joint.parameters = {{"pa", point(d.ax, d.ay, d.az)}, {"pb", point(d.bx, d.by, d.bz)}};
    if (d.rest_length > 0) joint.parameters.push_back({"l", {d.rest_length}});
    joint.soft = Softness{.by_frequency = false, .stiffness = stiffness, .damping = damping};
    return add_joint(joint);
  };
  // At length 0 the direction of a spring is undefined, but not the force of one with rest length 0.
  if (d.rest_length > 0 || d.stiffness == 0) return joined(along, d.stiffness, d.damping);
  const int joint = joined(S::dimension == Dimension::planar ? "revolute" : "spherical", d.stiffness, 0);
  if (d.damping > 0) data_->joints[joint].companion = joined(along, 0, d.damping);
  return joint;
}

template <class S>
void BasicWorld<S>::set_force(int body, const Wrench& force) {
  check_body(*data_, body);
  check_finite<S>(S::components(force), "every number of a force must be finite");
  note_change(*data_);
  data_->bodies.force[body] = S::components(force);
  set_acceleration(*data_, body);
  wake_pushed(*data_, body);
}

template <class S>
void BasicWorld<S>::set_pose(int body, const Place& place) {
  check_body(*data_, body);
  Bodies<S>& all = data_->bodies;
  const auto pose = S::placed(body == data_->ground ? place : moved_by(place, data_->origin, -1));
  check_finite<S>(pose);
  note_change(*data_);
  all.pose[body] = pose;
  if constexpr (S::has_gyroscopes)
    with_gyroscope(*data_, body, [&](auto& gyroscope) {
      S::set_inertia(gyroscope, all.pose[body], all.inverse_mass[body], all.velocity[body]);
      all.effective_mass[body] = all.inverse_mass[body];
      set_acceleration(*data_, body);
    });
  wake(*data_, body);
}

template <class S>
void BasicWorld<S>::set_velocity(int body, const typename S::Exact::Velocity& velocity) {
  check_body(*data_, body);
  require(!is_static(body), "a static body has no velocity");
  check_finite<S>(S::rounded(velocity), "every number of a velocity must be finite");
  note_change(*data_);
  data_->bodies.velocity[body] = S::rounded(velocity);
  wake(*data_, body);
}

template <class S>
void BasicWorld<S>::apply_impulse(int body, const typename S::Exact::Velocity& impulse) {
  check_body(*data_, body);
  auto& all = data_->bodies;
  const auto change = S::weighted(all.inverse_mass[body], S::rounded(impulse));
  check_finite<S>(S::rounded(impulse), "every number of an impulse must be finite");
  check_finite<S>(S::sum(all.velocity[body], change, T(1)), "an impulse must leave the velocity finite");
  note_change(*data_);
  all.velocity[body] = S::sum(all.velocity[body], change, T(1));
  wake(*data_, body);
}

template <class S>
void BasicWorld<S>::prepare() {
  prepare_topology(*data_);
}

template <class S>
void BasicWorld<S>::use(const Settings& settings) {
  require(!data_->accounts.open, "settings are chosen before the first step");
  check(settings);
  data_->settings = settings;
  for (int body = 0; body < body_count(); ++body) set_acceleration(*data_, body);
  data_->prepared = false;
}

template <class S>
void BasicWorld<S>::on_failure(OnFailure what) {
  data_->on_failure = what;
  data_->prepared = false;
}

#define CDOT_INSTANTIATE(S) template class BasicWorld<S>;
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
