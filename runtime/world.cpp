// Setting up a World, and step(). Looking at it is in world_queries.cpp.
#include "runtime/world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "runtime/add_rows.hpp"
#include "runtime/joint_table.hpp"
#include "runtime/laws.hpp"
#include "runtime/parameters.hpp"
#include "runtime/probe.hpp"
#include "runtime/stages.hpp"

namespace cdot {
namespace {

void require(bool condition, std::string_view message) {
  if (!condition) throw Error(std::string(message));
}

void check(const Settings& s) {
  require(s.iterations >= 1, "iterations must be at least 1");
  require(s.substeps >= 1, "substeps must be at least 1");
  require(s.baumgarte >= 0 && s.baumgarte <= 1, "baumgarte must lie between 0 and 1");
  require(std::isfinite(s.gravity_x) && std::isfinite(s.gravity_y), "gravity must be finite");
  require(s.sleep_after >= 0 && s.sleep_speed >= 0, "sleep settings must be >= 0");
}

void check(const BodyDefinition& d) {
  for (double number : {d.x, d.y, d.angle, d.vx, d.vy, d.w, d.mass, d.inertia, d.force_x, d.force_y,
                        d.torque, d.linear_damping, d.angular_damping})
    require(std::isfinite(number), "every number of a body must be finite");
  require(d.is_static || d.mass > 0, "a body needs a mass > 0, or to be static");
  require(d.mass >= 0 && d.inertia >= 0, "mass and inertia must not be negative");
  require(!d.is_static || (d.vx == 0 && d.vy == 0 && d.w == 0), "a static body has no velocity");
  require(d.linear_damping >= 0 && d.angular_damping >= 0, "damping must not be negative");
}

template <class S>
void check_body(const WorldState<S>& world, int body) {
  if (body < 0 || body >= world.bodies.count())
    throw Error(fmt::format("there is no body number {}", body));
}

template <class S>
void check_joint_bodies(const WorldState<S>& world, const JointType& type,
                        const std::vector<int>& bodies) {
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

// Refuses rows that have no direction where they hold. A velocity row has no C, a soft one is a
// spring: both may.
template <class S>
void check_directions(const WorldState<S>& world, const JointRecord& record) {
  const JointType& type = joint_types()[record.type];
  Probe<S> probe(world);
  for (size_t r = 0; r < type.row_kinds.size(); ++r) {
    if (type.row_kinds[r] == RowKind::velocity) continue;
    probe.look_at(record);
    if (probe.at_kink(static_cast<int>(r)))
      throw Error(
          fmt::format("row {} of joint `{}` has no direction here: C = 0 at its kink, as a "
                      "distance of length 0. Hold the points together with a `revolute`",
                      r + 1, type.name));
  }
}

template <class S>
planar::Pose<double> exact_pose(const WorldState<S>& world, int body) {
  const auto& q = world.bodies.pose[body];
  return Planar<double>::pose(q.x, q.y, q.angle);
}

template <class S>
void set_acceleration(WorldState<S>& world, int body) {
  using T = typename S::Scalar;
  Bodies<S>& all = world.bodies;
  const auto own = S::weighted(all.inverse_mass[body], all.force[body]);
  const auto gravity = S::gravity(T(world.settings.gravity_x), T(world.settings.gravity_y));
  const bool falls = !all.immovable(body);
  all.acceleration[body] = S::sum(own, gravity, falls ? T(1) : T(0));
}

}  // namespace

template <class T>
World<T>::World(const Settings& settings) : state_(std::make_unique<WorldState<Planar<T>>>()) {
  check(settings);
  state_->settings = settings;
}
template <class T>
World<T>::~World() = default;
template <class T>
World<T>::World(World&&) noexcept = default;
template <class T>
World<T>& World<T>::operator=(World&&) noexcept = default;

template <class T>
int World<T>::add_body(const BodyDefinition& d) {
  check(d);
  using S = Planar<T>;
  Bodies<S>& all = state_->bodies;
  const int body = all.count();
  const bool turns = !d.is_static && !d.fixed_rotation && d.inertia > 0;
  const typename S::InverseMass m{d.is_static ? T(0) : T(1 / d.mass),
                                  turns ? T(1 / d.inertia) : T(0)};
  all.pose.push_back(S::pose(T(d.x), T(d.y), T(d.angle)));
  all.velocity.push_back({T(d.vx), T(d.vy), T(d.w)});
  all.inverse_mass.push_back(m);
  all.effective_mass.push_back(m);
  all.force.push_back({T(d.force_x), T(d.force_y), T(d.torque)});
  for (auto* array : {&all.acceleration, &all.displacement, &all.increment}) array->push_back({});
  all.start.push_back(all.pose.back());
  set_acceleration(*state_, body);
  if (!d.is_static && (d.linear_damping > 0 || d.angular_damping > 0))
    state_->drags.push_back({body, T(d.linear_damping), T(d.angular_damping)});
  state_->prepared = false;
  return body;
}

template <class T>
int World<T>::ground() {
  if (state_->ground < 0) state_->ground = add_body({.is_static = true});
  return state_->ground;
}

template <class T>
int World<T>::add_joint(const JointDefinition& definition) {
  const JointType* type = find_joint_type(definition.type);
  if (!type) throw Error(fmt::format("there is no joint `{}`", definition.type));
  check_joint_bodies(*state_, *type, definition.bodies);
  JointRecord record{
      static_cast<int>(type - joint_types().data()), definition.bodies, {}, {}, false};
  std::vector<planar::Pose<double>> poses;
  for (int body : record.bodies) poses.push_back(exact_pose(*state_, body));
  record.parameters =
      parameter_numbers(record.type, definition.parameters, poses.data(), state_->time);
  double spring[spring_constants_count] = {};
  if (definition.soft) spring_constants(*definition.soft, spring);

  if (!definition.soft) check_directions(*state_, record);
  const int joint = joint_count();
  state_->joints.push_back(record);
  const auto movable = [&](int body) { return !state_->bodies.immovable(body); };
  if (std::none_of(record.bodies.begin(), record.bodies.end(), movable)) {
    state_->notes.push_back({joint, "connects only immovable bodies and does nothing"});
    return joint;
  }
  using S = Planar<T>;
  const auto& kinds = type->row_kinds;
  const bool unilateral = std::count(kinds.begin(), kinds.end(), RowKind::inequality) > 0;
  const Law<S>* law = definition.soft ? &soft_law<S>()
                      : unilateral    ? &unilateral_law<S>()
                                      : nullptr;
  const auto* ops = joint_entries<S>()[record.type].rows.choose(state_->bodies, record.bodies);
  add_rows(*state_, joint, ops, law, kinds,
           {spring, definition.soft ? static_cast<size_t>(spring_constants_count) : 0});
  return joint;
}

template <class T>
int World<T>::add_spring(const SpringDefinition& d) {
  check_body(*state_, d.body_a);
  check_body(*state_, d.body_b);
  require(d.body_a != d.body_b, "a spring connects two different bodies");
  for (double number : {d.ax, d.ay, d.bx, d.by, d.stiffness, d.rest_length, d.damping})
    require(std::isfinite(number), "every number of a spring must be finite");
  require(d.stiffness >= 0 && d.damping >= 0, "stiffness and damping must not be negative");
  require(d.rest_length >= 0, "a rest length must not be negative");
  state_->springs.push_back({d.body_a, d.body_b, T(d.ax), T(d.ay), T(d.bx), T(d.by), T(d.stiffness),
                             T(d.rest_length), T(d.damping)});
  state_->prepared = false;
  return static_cast<int>(state_->springs.size()) - 1;
}

template <class T>
void World<T>::set_force(int body, double force_x, double force_y, double torque) {
  check_body(*state_, body);
  state_->bodies.force[body] = {T(force_x), T(force_y), T(torque)};
  set_acceleration(*state_, body);
  wake(*state_, body);
}

template <class T>
void World<T>::set_pose(int body, double x, double y, double angle) {
  check_body(*state_, body);
  state_->bodies.pose[body] = Planar<T>::pose(T(x), T(y), T(angle));
  wake(*state_, body);
}

template <class T>
void World<T>::set_velocity(int body, double vx, double vy, double w) {
  check_body(*state_, body);
  require(!is_static(body), "a static body has no velocity");
  state_->bodies.velocity[body] = {T(vx), T(vy), T(w)};
  wake(*state_, body);
}

template <class T>
void World<T>::apply_impulse(int body, double x, double y, double angular) {
  check_body(*state_, body);
  auto& all = state_->bodies;
  const auto change = Planar<T>::weighted(all.inverse_mass[body], {T(x), T(y), T(angular)});
  all.velocity[body] = Planar<T>::sum(all.velocity[body], change, T(1));
  wake(*state_, body);
}

template <class T>
void World<T>::prepare() {
  prepare_topology(*state_);
}

template <class T>
void World<T>::step(double h) {
  WorldState<Planar<T>>& world = *state_;
  if (!(h > 0)) return;
  prepare_topology(world);
  const double part = h / world.settings.substeps;
  const T dt = T(part);
  for (int substep = 0; substep < world.settings.substeps; ++substep) {
    for (int index : world.awake) {
      auto& island = world.islands[index];
      settle_poses(world, island);
      stiffen_bodies(world, island, dt);
      evaluate_rows(world, island, dt);
      apply_forces(world, island, dt);
      if (world.settings.solver == Solver::direct)
        solve_direct(world, island);
      else
        solve_iterative(world, island, dt);
      integrate(world, island, dt);
      correct_drift(world, island, dt);
    }
    for (const auto& hook : world.after_substep) hook.run(world, dt);
    world.time += part;
    world.last_step = part;
  }
  put_to_sleep(world, h);
}

template class World<double>;
template class World<float>;

}  // namespace cdot
