// Cdot itself, in the plane for planar problems. A second engine solves planar problems in space, like the engines
// without a planar mode.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <string>

#include <cdot/effects.hpp>
#include <cdot/recommended.hpp>
#include <cdot/spatial.hpp>
#include <cdot/world.hpp>

#include "tests/bench/peers/geometry.hpp"

namespace cdot::peers {
namespace {

BodyDefinition definition(const Planar<double>*, const Body& body) {
  const State& s = body.start;
  return {.x = s.x[0],
          .y = s.x[1],
          .angle = angle(s.q),
          .vx = s.v[0],
          .vy = s.v[1],
          .w = s.w[2],
          .mass = body.mass,
          .inertia = body.inertia[2],
          .is_static = !body.moves,
          .fixed_rotation = !body.turns,
          .torque = body.torque[2],
          .linear_damping = body.damping,
          .angular_damping = body.damping};
}

SpatialBodyDefinition definition(const Spatial<double>*, const Body& body) {
  const State& s = body.start;
  return {.x = s.x[0],
          .y = s.x[1],
          .z = s.x[2],
          .e0 = s.q[0],
          .e1 = s.q[1],
          .e2 = s.q[2],
          .e3 = s.q[3],
          .vx = s.v[0],
          .vy = s.v[1],
          .vz = s.v[2],
          .wx = s.w[0],
          .wy = s.w[1],
          .wz = s.w[2],
          .mass = body.mass,
          .inertia = {.xx = body.inertia[0], .yy = body.inertia[1], .zz = body.inertia[2]},
          .is_static = !body.moves,
          .fixed_rotation = !body.turns,
          .torque_x = body.torque[0],
          .torque_y = body.torque[1],
          .torque_z = body.torque[2],
          .linear_damping = body.damping,
          .angular_damping = body.damping};
}

NamedValue planar_value(const char* name, const Vec3& u) { return {name, {u[0], u[1]}}; }
NamedValue spatial_value(const char* name, const Vec3& u) { return {name, {u[0], u[1], u[2]}}; }

const char* over_wheels(NamedValue (*value)(const char*, const Vec3&), const Joint& joint, JointDefinition& d) {
  for (const NamedValue& more : {value("ga", joint.wheel), value("gb", joint.wheel_b),
                                 NamedValue{"ratio", {joint.ratio}}, NamedValue{"length", {joint.length}}})
    d.parameters.push_back(more);
  return "pulley";
}

const char* with_length(const Joint& joint, JointDefinition& d) {
  d.parameters.push_back({"l", {joint.length}});
  return joint.kind == JointKind::distance ? "distance" : "max_distance";
}

// These have points in `d`.
JointDefinition contact(NamedValue (*value)(const char*, const Vec3&), const Joint& joint, JointDefinition d) {
  const bool in_plane = value == planar_value;
  d.type = in_plane ? "rough_line" : "rough_plane";
  d.parameters.push_back(value(in_plane ? "n" : "f", joint.axis));
  d.parameters.push_back({"mu", {joint.friction}});
  return d;
}
JointDefinition mount(NamedValue (*value)(const char*, const Vec3&), const Problem& problem, const Joint& joint,
                      JointDefinition d) {
  d.type = "bushing";
  d.parameters.push_back(value("fa", local_direction(problem, joint.a, joint.axis)));
  const Mount& by = *joint.mount;
  const std::vector<NamedValue> in_plane{{"kx", {by.along}}, {"ky", {by.across}}, {"k_turn", {by.bend}}},
      in_space{{"k_along", {by.along}}, {"k_across", {by.across}}, {"k_twist", {by.twist}}, {"k_bend", {by.bend}}};
  for (const NamedValue& more : value == planar_value ? in_plane : in_space) d.parameters.push_back(more);
  return d;
}

JointDefinition definition(const Planar<double>*, const Problem& problem, const Joint& joint) {
  JointDefinition d;
  d.parameters = {planar_value("pa", local_point(problem, joint.a, joint.anchor)),
                  planar_value("pb", local_point(problem, joint.b, joint.anchor_b))};
  if (joint.kind == JointKind::orientation) return {"angle", {}, {}, {}};
  if (joint.kind == JointKind::mount) return mount(planar_value, problem, joint, std::move(d));
  if (joint.kind == JointKind::contact) return contact(planar_value, joint, std::move(d));
  d.type = joint.kind == JointKind::prismatic  ? "prismatic"
           : joint.kind == JointKind::fixed    ? "weld"
           : joint.kind == JointKind::revolute ? "revolute"
           : joint.kind == JointKind::pulley   ? over_wheels(planar_value, joint, d)
                                               : with_length(joint, d);
  if (joint.kind == JointKind::prismatic) {
    const Vec3 normal{joint.axis[1], -joint.axis[0], 0};
    d.parameters.push_back(planar_value("t", local_direction(problem, joint.b, normal)));
  }
  return d;
}

// The frame of a joint with several axes: x, y and z of a six-degree joint, y and z of a universal joint.
NamedValue frame(const Problem& problem, const Joint& joint) {
  const Vec3 &first = joint.turns[0].axis, &second = joint.turns[1].axis;
  const bool universal = joint.kind == JointKind::universal;
  const Vec3 x = local_direction(problem, joint.a, universal ? cross(first, second) : first),
             y = local_direction(problem, joint.a, universal ? first : second);
  return {"fa", {x[0], x[1], x[2], y[0], y[1], y[2]}};
}

JointDefinition definition(const Spatial<double>*, const Problem& problem, const Joint& joint) {
  JointDefinition d;
  d.parameters = {spatial_value("pa", local_point(problem, joint.a, joint.anchor)),
                  spatial_value("pb", local_point(problem, joint.b, joint.anchor_b))};
  if (joint.kind == JointKind::orientation) return {"relative_orientation", {}, {spatial_value("fa", {1, 0, 0})}, {}};
  if (joint.kind == JointKind::mount) return mount(spatial_value, problem, joint, std::move(d));
  if (joint.kind == JointKind::contact) return contact(spatial_value, joint, std::move(d));
  const bool acted_on = joint.motor || joint.stops || joint.spring || joint.servo || !joint.brakes.empty();
  d.type = joint.kind == JointKind::prismatic   ? (acted_on ? "slider" : "prismatic")
           : joint.kind == JointKind::spherical ? "spherical"
           : joint.kind == JointKind::fixed     ? "fixed"
           : joint.kind == JointKind::revolute  ? (acted_on ? "hinge" : "revolute")
           : joint.kind == JointKind::universal ? "universal"
           : joint.kind == JointKind::six_dof   ? "six_dof"
           : joint.kind == JointKind::pulley    ? over_wheels(spatial_value, joint, d)
                                                : with_length(joint, d);
  if (!joint.turns.empty()) d.parameters.push_back(frame(problem, joint));
  if (joint.kind == JointKind::fixed) d.parameters.push_back(spatial_value("fa", {1, 0, 0}));
  if (joint.kind == JointKind::revolute || joint.kind == JointKind::prismatic)
    d.parameters.push_back(spatial_value("fa", local_direction(problem, joint.a, joint.axis)));
  if (joint.axis_b) d.parameters.push_back(spatial_value("fb", local_direction(problem, joint.b, *joint.axis_b)));
  return d;
}

State state_of(const planar::Place& q, const planar::Velocity<double>& v) {
  return {{q.x, q.y, 0}, about_z(q.angle), {v.x, v.y, 0}, {0, 0, v.w}};
}
State state_of(const spatial::Place& q, const spatial::Velocity<double>& v) {
  return {{q.x, q.y, q.z}, {q.e0, q.e1, q.e2, q.e3}, {v.x, v.y, v.z}, {v.wx, v.wy, v.wz}};
}

// The origin lies among the bodies, as for scenes far from 0.
template <class S>
void choose_origin(const Problem& problem, BasicWorld<S>& world) {
  constexpr double far_away = 1000;
  const Vec3 from = problem.bodies[0].start.x;
  double apart = 1;
  for (const Body& body : problem.bodies) apart = std::max(apart, norm(body.start.x - from));
  if (norm(from) > far_away * apart) world.set_origin(std::round(from[0]), std::round(from[1]), std::round(from[2]));
}

template <class S>
void add_turns(BasicWorld<S>& made, int index, const Joint& joint) {
  static const char *const bends[] = {"bend_a", "bend_b"}, *const twists[] = {"twist_x", "twist_y", "twist_z"};
  for (std::size_t k = 0; k < joint.turns.size(); ++k) {
    const Turn& turn = joint.turns[k];
    const char* coordinate = joint.kind == JointKind::universal ? bends[k] : twists[k];
    if (turn.held) add_limit(made, index, coordinate, {0, 0});
    if (turn.motor) add_motor(made, index, coordinate, {turn.motor->speed, turn.motor->most});
  }
  if (joint.kind != JointKind::six_dof) return;
  for (const char* slide : {"slide_x", "slide_y", "slide_z"}) add_limit(made, index, slide, {0, 0});
}

template <class S>
void add_motor(BasicWorld<S>& made, int index, const char* coordinate, const Motor& motor) {
  if (!motor.speed_at) return cdot::add_motor(made, index, coordinate, {motor.speed, motor.most}), void();
  const auto speed = [at = motor.speed_at](double time) { return ProfileValue{at(time)}; };
  add_effect(made, index, coordinate,
             SpecEffect{"motor", {in_time("speed", {Profile::function(speed)}), {"max", {motor.most}}}});
}

template <class S>
void add_servo(BasicWorld<S>& made, int index, const Servo& servo) {
  add_effect(
      made, index, "angle",
      SpecEffect{
          servo.saturates_smoothly ? "servo" : "position_drive",
          {{"target", {servo.target}}, {"k", {servo.stiffness}}, {"d", {servo.damping}}, {"most", {servo.most}}}});
}

template <class S>
void add(BasicWorld<S>& made, const Problem& problem, const Joint& joint) {
  JointDefinition d = definition(static_cast<const S*>(nullptr), problem, joint);
  for (const int body : {joint.a, joint.b}) d.bodies.push_back(body == world ? made.ground() : body);
  if (joint.soft) d.soft = Softness{false, 0, 0, joint.soft->stiffness, joint.soft->damping};
  const int index = made.add_joint(d);
  add_turns(made, index, joint);
  const char* coordinate = joint.kind == JointKind::prismatic ? "slide" : "angle";
  if (joint.stops) add_limit(made, index, coordinate, {joint.stops->lower, joint.stops->upper});
  if (joint.motor) add_motor(made, index, coordinate, *joint.motor);
  if (joint.servo) add_servo(made, index, *joint.servo);
  for (const double torque : joint.brakes)
    add_effect(made, index, "angle", SpecEffect{"brake", {{"torque", {torque}}}});
  if (!joint.spring) return;
  const Softness softness{false, 0, 0, joint.spring->stiffness, joint.spring->damping};
  add_spring(made, index, coordinate, {softness, double(made.coordinate(index, coordinate))});
}

template <class S>
BasicWorld<S> build(const Problem& problem, Settings settings) {
  settings.gravity_x = problem.gravity[0];
  settings.gravity_y = problem.gravity[1];
  settings.gravity_z = problem.gravity[2];
  settings.sleep_after = problem.sleep_after;
  BasicWorld<S> made(settings);
  choose_origin(problem, made);
  for (const Body& body : problem.bodies) made.add_body(definition(static_cast<const S*>(nullptr), body));
  for (const Joint& joint : problem.joints) add(made, problem, joint);
  made.prepare();
  return made;
}

// Throws if step() reports a problem.
void check(const StepResult& result, const Problem& problem) {
  if (result) return;
  const std::string body = result.body >= 0 ? problem.bodies[std::size_t(result.body)].name : "";
  throw std::runtime_error(in_words(result, body, fmt::format("joint {}", result.joint + 1)));
}

double norm(const planar::Wrench& w) { return std::hypot(w.force_x, w.force_y); }
double norm(const spatial::Wrench& w) { return std::hypot(w.force_x, w.force_y, w.force_z); }
void put(planar::Velocity<double>& to, const Vec3& u) { to.x = u[0], to.y = u[1]; }
void put(spatial::Velocity<double>& to, const Vec3& u) { to.x = u[0], to.y = u[1], to.z = u[2]; }

template <class S, class Base>
class WorldRun : public Base {
 public:
  template <class... Arguments>
  WorldRun(const Problem& problem, const Settings& settings, const Arguments&... arguments)
      : Base(arguments...), problem_(problem), world_(build<S>(problem, settings)) {
    for (const Joint& joint : problem.joints) index_.emplace(joint.number, int(index_.size()));
  }
  // The method that the runtime chooses by itself for steps of h.
  void choose_method(double h) { world_.use(recommended(world_, h).settings); }
  void step(double by) override { peers::check(world_.step(by), problem_); }
  State state(int body) const override { return state_of(world_.place(body), world_.velocity(body)); }

  void strike(int body, const Vec3& impulse) override {
    typename S::Exact::Velocity all{};
    put(all, impulse);
    world_.apply_impulse(body, all);
  }
  bool add(const Problem& now, const Joint& joint) override {
    peers::add(world_, now, joint);
    index_[joint.number] = world_.joint_count() - 1;
    return true;
  }
  bool remove(int joint) override {
    world_.remove_joint(index_.at(joint));
    return true;
  }
  bool change(const Problem& now, const Joint& joint) override {
    world_.set_parameters(index_.at(joint.number), definition(static_cast<const S*>(nullptr), now, joint).parameters);
    return true;
  }
  double force(int joint) const override {
    const int index = index_.at(joint);
    return norm(world_.reaction(index, world_.joint_bodies(index).back()));
  }
  bool asleep(int body) const override { return world_.asleep(body); }

 private:
  const Problem& problem_;
  BasicWorld<S> world_;
  std::map<int, int> index_;  // of joints in the World, by their numbers
};

template <class S>
using CdotRun = WorldRun<S, SteppedRun>;

// Adaptive steps by local_error.
class Adaptive : public Run {
 public:
  void advance(double to) final {
    step(to - now_);
    now_ = to;
  }

 private:
  double now_ = 0;
};
template <class S>
using AdaptiveRun = WorldRun<S, Adaptive>;

Settings with(Settings settings, double local_error) {
  settings.local_error = local_error;
  return settings;
}

// One row per way to use the runtime, with the changes from the defaults of a scene with fixed steps.
struct Way {
  const char* name;
  const char* changed;
  enum Steps { coarse, fine, adaptive } steps;
  Settings settings;
  bool chosen = false;  // by the runtime, for the scene and the step
};

const std::vector<Way>& ways() {
  using enum Integrator;
  static const std::vector<Way> all = {
      {"chosen by the runtime", "", Way::coarse, {}, true},
      {"dop853, adaptive", "integrator = dop853, local_error", Way::adaptive, {.integrator = dop853}},
      {"dop853", "integrator = dop853", Way::fine, {.integrator = dop853}},
      {"rk4, adaptive", "integrator = rk4, local_error", Way::adaptive, {.integrator = rk4}},
      {"rk4", "integrator = rk4", Way::fine, {.integrator = rk4}},
      {"rattle", "integrator = rattle", Way::fine, {.integrator = rattle}},
      {"Euler", "integrator = euler", Way::coarse, {}},
      {"Euler, Baumgarte", "integrator = euler, drift = baumgarte", Way::coarse, {.drift = Drift::baumgarte}},
      {"implicit", "integrator = implicit", Way::coarse, {.integrator = implicit}},
      {"Euler, iterative, Baumgarte",
       "integrator = euler, solver = iterative, drift = baumgarte",
       Way::coarse,
       {.solver = Solver::iterative, .drift = Drift::baumgarte}},
      {"Euler, iterative, 3 iterations, Baumgarte",
       "integrator = euler, solver = iterative, iterations = 3, drift = baumgarte",
       Way::coarse,
       {.solver = Solver::iterative, .drift = Drift::baumgarte, .iterations = 3}},
      {"Euler, iterative, 1 iteration, Baumgarte",
       "integrator = euler, solver = iterative, iterations = 1, drift = baumgarte",
       Way::coarse,
       {.solver = Solver::iterative, .drift = Drift::baumgarte, .iterations = 1}},
      {"Euler, Baumgarte 0.8",
       "integrator = euler, drift = baumgarte, baumgarte = 0.8",
       Way::coarse,
       {.drift = Drift::baumgarte, .baumgarte = 0.8}},
      {"Euler, iterative, 2 iterations, all the error per step",
       "integrator = euler, solver = iterative, iterations = 2, drift = baumgarte, baumgarte = 1",
       Way::coarse,
       {.solver = Solver::iterative, .drift = Drift::baumgarte, .iterations = 2, .baumgarte = 1}},
  };
  return all;
}

template <class S>
std::unique_ptr<Run> started(const Problem& problem, const Way& way, double h) {
  auto run = std::make_unique<CdotRun<S>>(problem, way.settings, h);
  if (way.chosen) run->choose_method(h);
  return run;
}

std::vector<double> local_errors() {
  std::vector<double> all;
  for (int half_digits = 4; half_digits <= 30; ++half_digits) all.push_back(std::pow(10.0, -half_digits / 2.0));
  return all;
}

template <class S>
std::vector<Series> series_in(const Problem& problem) {
  std::vector<Series> all;
  for (const Way& way : ways()) {
    Series series{way.name, way.changed, "h", way.steps == Way::fine ? fine_steps(problem) : steps(problem),
                  [&](double h) { return started<S>(problem, way, h); }};
    if (way.steps == Way::adaptive) {
      series.knob = "local error";
      series.knobs = local_errors();
      series.start = [&](double knob) { return std::make_unique<AdaptiveRun<S>>(problem, with(way.settings, knob)); };
    }
    all.push_back(series);
  }
  return all;
}

std::vector<Series> series(const Problem& problem) {
  return problem.planar ? series_in<Planar<double>>(problem) : series_in<Spatial<double>>(problem);
}

std::vector<Series> series_in_space(const Problem& problem) {
  if (!problem.planar) return {};
  return series_in<Spatial<double>>(problem);
}

const Registration registration{{"Cdot", CDOT_VERSION, "double", "#d1242f", "", series}};
const Registration in_space{
    {"Cdot in space", CDOT_VERSION, "double", "#f0883e", "planar problems posed in space", series_in_space}};

}  // namespace
}  // namespace cdot::peers
