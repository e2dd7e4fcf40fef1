// The scene reader and a World resolve all names, parameters, masses and places.
#include "derive/compile/scene/mechanism.hpp"

#include <algorithm>
#include <fmt/format.h>

#include <cdot/world.hpp>

#include "derive/compile/scene/effects.hpp"
#include "runtime/solve/projection.hpp"
#include "runtime/tool/scene/extent.hpp"
#include "runtime/tool/scene/scene.hpp"

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

void refuse_joint(const SceneJoint& joint, Refusals& refusals) {
  const std::string& name = joint.name;
  const auto refuse = [&](const std::string& part) {
    refusals.add(joint.where, fmt::format("{}: cdot compile knows no {}", name, part), "leave it to cdot-run");
  };
  if (joint.breaking) refuse("joints that break");
  const auto follows = [](const CoordinateEffects& effects) {
    return std::ranges::any_of(effects.specs, [](const SpecEffect& effect) { return in_time(effect.parameters); });
  };
  if (in_time(joint.definition.parameters) || std::ranges::any_of(joint.effects, follows))
    refuse("numbers that follow functions of time");
  const JointType* type = find_joint_type(Dimension::planar, joint.definition.type);
  if (type && std::ranges::find(type->row_kinds, RowKind::inequality) != type->row_kinds.end())
    refuse(fmt::format("inequality, as {} has: it would end the fixed pattern of the equations", type->name));
}

void refuse_parts(const Scene& scene) {
  Refusals refusals(scene);
  const auto refuse = [&](bool unknown, const std::string& cause, const std::string& fix) {
    if (unknown) refusals.add({}, cause, fix);
  };
  const Settings& s = scene.settings;
  refuse(scene.dimension != Dimension::planar, "cdot compile knows planar scenes only", "leave it to cdot-run");
  if (scene.dimension == Dimension::planar)
    for (const SceneJoint& joint : scene.joints) refuse_joint(joint, refusals);
  refuse(s.solver != Solver::direct, "a compiled step solves all rows at once", "write solver = \"direct\"");
  refuse(s.drift != Drift::projection, "a compiled step projects its end", "write drift = \"projection\"");
  refuse(s.local_error > 0, "a compiled step has a fixed length", "give --step in place of local_error");
  refuse(s.substeps != 1, "a compiled step is one step", "divide the step by substeps");
  refuse(s.sleep_after > 0, "compiled bodies do not sleep", "leave out sleep_after");
  refusals.throw_any();
}

constexpr struct {
  Integrator integrator;
  Method method;
} methods[] = {
    {Integrator::euler, Method::euler}, {Integrator::rk4, Method::rk4}, {Integrator::dop853, Method::dop853}};

Method method_of(const Scene& scene) {
  for (const auto& [integrator, method] : methods)
    if (scene.settings.integrator == integrator) return method;
  Refusals refusals(scene);
  refusals.add({}, fmt::format("cdot compile knows no integrator {}", row_of(scene.settings.integrator).name),
               "give --integrator euler, rk4 or dop853");
  refusals.throw_any();
  return {};
}

// A scene that chooses its method by an accuracy compiles to rk4.
void settle_method(Scene& scene, const Wishes& wishes) {
  if (!wishes.integrator.empty())
    scene.settings.integrator = std::ranges::find(integrator_rows, wishes.integrator, &IntegratorRow::name)->integrator;
  else if (chooses_method(scene) || !scene.names_integrator) scene.settings.integrator = Integrator::rk4;
  if (wishes.step > 0) scene.step = wishes.step;
  else if (scene.step == 0 || chooses_method(scene)) scene.step = default_step;
  scene.accuracy = 0;
  settle_drift(scene);
}

Body body_of(const Scene& scene, const BasicWorld<Space>& world, int index) {
  const SceneBody& source = scene.bodies[static_cast<std::size_t>(index)];
  const BodyDefinition& d = source.definition;
  const auto pose = world.place(index);
  const auto velocity = world.velocity(index);
  const auto mass = world.inverse_mass(index);
  Body body;
  body.name = source.name, body.moves = !Space::immovable(mass);
  body.x = pose.x, body.y = pose.y, body.angle = pose.angle;
  body.vx = velocity.x, body.vy = velocity.y, body.w = velocity.w;
  body.inv_m = mass.m, body.inv_I = mass.I;
  body.ax = mass.m * d.force_x, body.ay = mass.m * d.force_y;
  body.aw = mass.I * d.torque;
  body.linear_drag = d.linear_damping, body.angular_drag = d.angular_damping;
  return body;
}

Joint joint_of(const Scene& scene, const BasicWorld<Space>& world, int index) {
  const SceneJoint& source = scene.joints[static_cast<std::size_t>(index)];
  Joint joint{source.name, source.definition.type, {}, world.joint_parameters(index)};
  const int ground = static_cast<int>(scene.bodies.size());
  for (const int body : source.definition.bodies) joint.bodies.push_back(body == world_body ? ground : body);
  return joint;
}

// World stops Newton at this error, in units of a size of the island that it takes from the rows (Island::scale).
double tolerance_of(const Scene& scene) {
  double scale = 1;
  for (const double extent : extents_of(scene).of_body)
    if (extent > 0) scale = std::min(scale, 10 * extent);
  return converged<double> * scale;
}

void add_effects(const Scene& scene, BasicWorld<Space>& world, Mechanism& mechanism) {
  Refusals refusals(scene);
  const auto refuse = [&](const SceneJoint* joint, const std::string& what) {
    refusals.add(joint->where, fmt::format("{}: cdot compile does not know {}", joint->name, what),
                 mechanism.method == Method::euler ? "leave it to cdot-run"
                                                   : "give --integrator euler, or leave it to cdot-run");
  };
  read_effects(scene, world, refuse, mechanism);
  refusals.throw_any();
}

}  // namespace

Mechanism read_mechanism(const std::string& file, const Wishes& wishes) {
  Scene scene = read_scene(file);
  settle_method(scene, wishes);
  refuse_parts(scene);
  Mechanism mechanism;
  mechanism.file = file, mechanism.title = scene.title;
  mechanism.method_name = row_of(scene.settings.integrator).name;
  mechanism.method = method_of(scene);
  mechanism.step = scene.step;
  mechanism.tolerance = tolerance_of(scene);
  mechanism.inputs = wishes.inputs;
  for (std::string& name : mechanism.inputs) std::ranges::replace(name, '.', '_');
  mechanism.gravity_x = scene.settings.gravity_x, mechanism.gravity_y = scene.settings.gravity_y;
  BasicWorld<Space> world = build_world<double>(scene);
  if (scene.project) world.project(1e-12);
  for (int i = 0; i < static_cast<int>(scene.bodies.size()); ++i) mechanism.bodies.push_back(body_of(scene, world, i));
  mechanism.bodies.emplace_back();
  mechanism.bodies.back().name = "world", mechanism.bodies.back().moves = false;
  for (int i = 0; i < static_cast<int>(scene.joints.size()); ++i)
    if (!world.joint_type(i).is_effect && !scene.joints[static_cast<std::size_t>(i)].definition.soft)
      mechanism.joints.push_back(joint_of(scene, world, i));
  add_effects(scene, world, mechanism);
  return mechanism;
}

}  // namespace cdot::compile
