// The scene reader and a World resolve all names, parameters, masses and places.
#include "derive/compile/scene/mechanism.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

#include <cdot/methods.hpp>
#include <cdot/world.hpp>

#include "derive/compile/scene/bonds.hpp"
#include "derive/compile/scene/effects.hpp"
#include "runtime/own/own.hpp"
#include "runtime/solve/misfits.hpp"
#include "runtime/state/world_data.hpp"
#include "runtime/tool/scene/scene.hpp"
#include "runtime/world/islands.hpp"

namespace cdot::compile {
namespace {

// Collects what cannot be compiled.
class Refusals {
 public:
  explicit Refusals(const Scene& scene) : scene_(scene) {}
  void add(Span where, const std::string& cause, const std::string& fix) {
    report_ += scene_.source->paragraph("error", where, cause, fix);
    ++count_;
  }
  void throw_any() const {
    if (count_ > 0) throw SceneError(report_, count_);
  }

 private:
  const Scene& scene_;
  std::string report_;
  int count_ = 0;
};

void refuse_joint(const SceneJoint& joint, const Scene& scene, Refusals& refusals) {
  const std::string& name = joint.name;
  const auto refuse = [&](const std::string& part) {
    refusals.add(joint.where, fmt::format("{}: cdot compile knows no {}", name, part), "leave it to cdot-run");
  };
  const JointType* type = find_joint_type(scene.dimension, joint.definition.type);
  const auto has = [&](RowKind kind) {
    return type && std::ranges::find(type->row_kinds, kind) != type->row_kinds.end();
  };
  const auto& soft = joint.definition.soft;
  const Integrator method = scene.settings.integrator;
  const bool is_damped = soft && (soft->damping > 0 || soft->damping_ratio > 0);
  const bool unknown = method == Integrator::implicit || (method == Integrator::rattle && is_damped);
  if (has(RowKind::inequality) && soft && unknown) refuse("soft ropes by implicit, and damped ones by rattle");
  else if (has(RowKind::inequality) && !is_rope(*type))
    refuse(fmt::format("inequality beside other rows, as {} has", type->name));
}

void refuse_parts(const Scene& scene) {
  Refusals refusals(scene);
  const auto refuse = [&](bool unknown, const std::string& cause, const std::string& fix) {
    if (unknown) refusals.add({}, cause, fix);
  };
  const Settings& s = scene.settings;
  for (const SceneJoint& joint : scene.joints) refuse_joint(joint, scene, refusals);
  refuse(s.solver != Solver::direct, "a compiled step solves all rows at once", "write solver = \"direct\"");
  refuse(s.drift == Drift::soft || (s.drift != Drift::projection && s.integrator != Integrator::euler),
         "a compiled step projects its end, unless euler takes baumgarte or none", "write drift = \"projection\"");
  refuse(s.local_error > 0, "a compiled step has a fixed length", "give --step in place of local_error");
  refuse(s.substeps != 1, "a compiled step is one step", "divide the step by substeps");
  refusals.throw_any();
}

// A scene that chooses its method by an accuracy compiles to rk4.
void settle_method(Scene& scene, const Wishes& wishes) {
  if (!wishes.integrator.empty())
    scene.settings.integrator = std::ranges::find(integrator_rows, wishes.integrator, &IntegratorRow::name)->integrator;
  else if (chooses_method(scene) || !scene.names_integrator) scene.settings.integrator = Integrator::rk4;
  if (!wishes.drift.empty()) scene.drift = std::ranges::find(drifts, wishes.drift, &Named<Drift>::name)->method;
  if (wishes.step > 0) scene.step = wishes.step;
  else if (scene.step == 0 || chooses_method(scene)) scene.step = default_step;
  scene.accuracy = 0;
  settle_drift(scene);
}

void set_pose(const BasicWorld<Planar<double>>& world, int index, Body& body) {
  const auto q = world.place(index);
  const auto v = world.velocity(index);
  const auto m = world.inverse_mass(index);
  body.pose = {q.x, q.y, q.angle}, body.velocity = {v.x, v.y, v.w};
  body.inv_m = m.m, body.inv_I = m.I;
}

void set_pose(const BasicWorld<Spatial<double>>& world, int index, Body& body) {
  const auto q = world.place(index);
  const auto v = world.velocity(index);
  const auto m = world.inverse_mass(index);
  body.pose = {q.x, q.y, q.z, q.e0, q.e1, q.e2, q.e3}, body.velocity = {v.x, v.y, v.z, v.wx, v.wy, v.wz};
  body.inv_m = m.m, body.inv_I = m.Ixx;
}

void set_forces(const BodyDefinition& d, Body& body) {
  body.acceleration = {body.inv_m * d.force_x, body.inv_m * d.force_y, body.inv_I * d.torque};
}

void set_forces(const SpatialBodyDefinition& d, Body& body) {
  using S = Spatial<double>;
  if (S::is_gyroscope(d)) {
    const S::Gyroscope g = S::gyroscope_of(d);
    const auto numbers = [](const S::Symmetric& I) { return Tensor{I.xx, I.yy, I.zz, I.xy, I.xz, I.yz}; };
    body.inertia_turns = true, body.inv_I = 0;
    body.inertia = numbers(g.inertia), body.inverse_inertia = numbers(g.inverse);
    body.torque = {d.torque_x, d.torque_y, d.torque_z};
  }
  body.acceleration = {body.inv_m * d.force_x,  body.inv_m * d.force_y,  body.inv_m * d.force_z,
                       body.inv_I * d.torque_x, body.inv_I * d.torque_y, body.inv_I * d.torque_z};
}

template <class S>
const auto& definition_of(const SceneBody& body) {
  if constexpr (S::dimension == Dimension::planar) return body.definition;
  else return body.spatial;
}

template <class S>
Body body_of(const Scene& scene, const BasicWorld<S>& world, int index) {
  const SceneBody& source = scene.bodies[static_cast<std::size_t>(index)];
  const auto& d = definition_of<S>(source);
  Body body;
  body.name = source.name, body.moves = !S::immovable(world.inverse_mass(index));
  set_pose(world, index, body);
  set_forces(d, body);
  body.linear_drag = d.linear_damping, body.angular_drag = d.angular_damping;
  return body;
}

template <class S>
Joint joint_of(const Scene& scene, const BasicWorld<S>& world, int index) {
  const SceneJoint& source = scene.joints[static_cast<std::size_t>(index)];
  Joint joint{source.name, source.definition.type, {}, world.joint_parameters(index)};
  const int ground = static_cast<int>(scene.bodies.size());
  for (const CoordinateInfo& coordinate : world.joint_type(index).coordinates)
    joint.coordinates.emplace_back(coordinate.name);
  for (const RowKind kind : world.joint_type(index).row_kinds) joint.is_rate.push_back(kind == RowKind::velocity);
  for (const int body : source.definition.bodies) joint.bodies.push_back(body == world_body ? ground : body);
  return joint;
}

template <class S>
void add_joint(const Scene& scene, BasicWorld<S>& world, int index, Mechanism& mechanism) {
  Joint joint = joint_of(scene, world, index);
  joint.holds = number_among_breakable(world, index);
  const JointRecord& record = world.data().joints[static_cast<std::size_t>(index)];
  if (!record.places.empty()) joint.tensions = tensions_of(world, record.places[0]);
  if (counts_turns(world, index)) joint.turns = turns_of(world.joint_type(index), mechanism);
  if (!find_functions(scene, record, -1, true, mechanism, joint.in_time)) {
    Refusals refusals(scene);
    refusals.add(scene.joints[static_cast<std::size_t>(index)].where,
                 fmt::format("{}: cdot compile knows no numbers that follow a function of a program", joint.name),
                 "leave it to cdot-run");
    refusals.throw_any();
  }
  mechanism.joints.push_back(std::move(joint));
}

// Of the World's smallest mechanism, and the error at which the World stops Newton.
template <class S>
void measure(BasicWorld<S>& world, Mechanism& mechanism) {
  prepare_topology(world.data());
  double size = std::numeric_limits<double>::infinity(), scale = 1;
  for (const Island<S>& island : world.data().islands)
    size = std::min(size, double(island.size)), scale = std::min(scale, double(island.scale));
  mechanism.size = std::isinf(size) ? 1 : size;
  mechanism.tolerance = converged<double> * scale;
}

template <class S>
void add_effects(const Scene& scene, BasicWorld<S>& world, Mechanism& mechanism) {
  Refusals refusals(scene);
  const auto refuse = [&](const SceneJoint& joint, const std::string& what) {
    refusals.add(joint.where, fmt::format("{}: cdot compile does not know {}", joint.name, what),
                 "leave it to cdot-run");
  };
  read_effects(scene, world, refuse, mechanism);
  refusals.throw_any();
}

template <class S>
void refuse_counters(const Scene& scene, BasicWorld<S>& world) {
  Refusals refusals(scene);
  for (int i = 0; i < static_cast<int>(scene.joints.size()); ++i) {
    const SceneJoint& joint = scene.joints[static_cast<std::size_t>(i)];
    const bool knows = !world.joint_type(i).is_effect && !is_rope(world.joint_type(i));
    if (!knows && counts_turns(world, i))
      refusals.add(joint.where,
                   fmt::format("{}: cdot compile knows no effects by rows that count whole turns, as {} has",
                               joint.name, joint.definition.type),
                   "leave it to cdot-run");
  }
  refusals.throw_any();
}

// Their ends are kept by projections, and their loads count what these pull.
void refuse_bounds_without_projection(const Scene& scene, const Mechanism& mechanism) {
  if (!mechanism.open || (mechanism.bounded.empty() && mechanism.bonds.empty())) return;
  Refusals refusals(scene);
  refusals.add({},
               fmt::format("{}: cdot compile knows rows with bounds and joints that break only with projections",
                           mechanism.bounded.empty() ? mechanism.bonds[0].name : mechanism.bounded[0].name),
               "write drift = \"projection\"");
  refusals.throw_any();
}

// Radau IIA: Newton's dense matrices stay on the stack.
void refuse_large(const Scene& scene, const Mechanism& mechanism) {
  constexpr std::size_t most = 128;
  if (mechanism.components() <= most) return;
  Refusals refusals(scene);
  refusals.add({},
               fmt::format("a step compiled by radau5 solves for all velocities at once: for {} components, at most {}",
                           mechanism.components(), most),
               "give another --integrator, or leave it to cdot-run");
  refusals.throw_any();
}

void note_own_specs(Mechanism& mechanism) {
  const auto note = [&](const std::string& type) {
    if (const std::string file = file_of_own_type(type); !file.empty()) mechanism.own_specs[type] = file;
  };
  for (const Joint& joint : mechanism.joints) note(joint.type);
  for (const Bond& bond : mechanism.bonds) note(bond.type);
  for (const auto* list : {&mechanism.effects, &mechanism.bounded})
    for (const Effect& effect : *list) note(effect.type), note(effect.law_type);
}

// The World solves joints that contradict each other in the sense of least squares.
template <class S>
void refuse_contradictions(const Scene& scene) {
  constexpr double plain = 1e-6;
  BasicWorld<S> probe = build_world_in<S>(scene);
  const ProjectResult result = probe.project(plain);
  const bool known = result.joint >= 0 && result.joint < static_cast<int>(scene.joints.size());
  if (result.met || !known) return;
  const SceneJoint& joint = scene.joints[static_cast<std::size_t>(result.joint)];
  Refusals refusals(scene);
  refusals.add(joint.where,
               fmt::format("{}: cdot compile knows no joints that contradict each other at the start", joint.name),
               "correct the anchors or the lengths of its loop, or leave it to cdot-run");
  refusals.throw_any();
}

template <class S>
void add_parts(const Scene& scene, Mechanism& mechanism) {
  BasicWorld<S> world = build_world_in<S>(scene);
  refuse_counters(scene, world);
  if (scene.project) world.project(1e-12);
  measure(world, mechanism);
  for (int i = 0; i < static_cast<int>(scene.bodies.size()); ++i) mechanism.bodies.push_back(body_of(scene, world, i));
  mechanism.bodies.emplace_back();
  Body& ground = mechanism.bodies.back();
  ground.name = "world", ground.moves = false;
  ground.pose =
      S::dimension == Dimension::planar ? std::vector<double>{0, 0, 0} : std::vector<double>{0, 0, 0, 1, 0, 0, 0};
  for (int i = 0; i < static_cast<int>(scene.joints.size()); ++i)
    if (!world.joint_type(i).is_effect && !is_rope(world.joint_type(i)) &&
        !scene.joints[static_cast<std::size_t>(i)].definition.soft)
      add_joint(scene, world, i, mechanism);
  if (mechanism.method == Method::radau5) refuse_large(scene, mechanism);
  add_effects(scene, world, mechanism);
  read_bonds(scene, world, mechanism);
  refuse_bounds_without_projection(scene, mechanism);
  note_own_specs(mechanism);
  refuse_contradictions<S>(scene);
}

}  // namespace

Mechanism read_mechanism(const std::string& file, const Wishes& wishes) {
  Scene scene = read_scene(file);
  settle_method(scene, wishes);
  refuse_parts(scene);
  Mechanism mechanism;
  mechanism.file = file, mechanism.title = scene.title;
  mechanism.dimension = scene.dimension == Dimension::planar ? 2 : 3;
  mechanism.method_name = row_of(scene.settings.integrator).name;
  mechanism.method = scene.settings.integrator;
  mechanism.step = scene.step;
  if (scene.settings.sleep_after > 0)
    mechanism.notes.emplace_back("Compiled bodies do not sleep: sleep_after is left out.");
  mechanism.inputs = scene.inputs;
  for (const std::string& input : wishes.inputs)
    if (std::ranges::find(scene.inputs, input) == scene.inputs.end()) mechanism.inputs.push_back(input);
  mechanism.foresees = !wishes.plain;
  mechanism.open = scene.settings.drift != Drift::projection;
  if (scene.settings.drift == Drift::baumgarte) mechanism.fed_back = scene.settings.baumgarte;
  for (std::string& name : mechanism.inputs) std::ranges::replace(name, '.', '_');
  mechanism.gravity = {scene.settings.gravity_x, scene.settings.gravity_y, scene.settings.gravity_z};
  if (mechanism.spatial()) add_parts<Spatial<double>>(scene, mechanism);
  else add_parts<Planar<double>>(scene, mechanism);
  return mechanism;
}

}  // namespace cdot::compile
