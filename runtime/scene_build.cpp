// From a scene to a World: the names are gone, what the World refuses is reported in the lines of
// the scene.
#include <fmt/format.h>

#include "runtime/scene.hpp"

namespace cdot {
namespace {

template <class S>
void add_effects(BasicWorld<S>& world, int joint, const SceneJoint& source) {
  for (const SceneEffects& effects : source.effects) {
    const std::string& coordinate = effects.coordinate;
    if (effects.limit) add_limit(world, joint, coordinate, *effects.limit);
    if (effects.motor) add_motor(world, joint, coordinate, *effects.motor);
    for (const SceneSpring& spring : effects.springs) {
      const double rest = spring.rest ? *spring.rest : world.coordinate(joint, coordinate);
      add_spring(world, joint, coordinate, {spring.softness, rest});
    }
    if (effects.friction) add_friction(world, joint, coordinate, *effects.friction);
  }
  if (source.breaking) set_breaking_load(world, joint, *source.breaking);
}

template <class S>
void add_joint(BasicWorld<S>& world, const SceneJoint& source) {
  JointDefinition definition = source.definition;
  for (int& body : definition.bodies) body = body == world_body ? world.ground() : body;
  add_effects(world, world.add_joint(definition), source);
}

template <class S>
void add_spring(BasicWorld<S>& world, SpringDefinition spring) {
  for (int* body : {&spring.body_a, &spring.body_b})
    *body = *body == world_body ? world.ground() : *body;
  world.add_spring(spring);
}

// "C2 = -0.25, Cdot1 = -3": positions first; rows are numbered where there are several.
std::string rows_text(const std::vector<Inconsistency>& rows, int joint, std::size_t joint_rows) {
  std::string list;
  for (const bool velocity : {false, true}) {
    for (const Inconsistency& row : rows) {
      if (row.joint != joint || row.velocity != velocity) continue;
      const std::string number = joint_rows > 1 ? std::to_string(row.row + 1) : "";
      list += fmt::format("{}{}{} = {:.3g}", list.empty() ? "" : ", ", velocity ? "Cdot" : "C",
                          number, row.value);
    }
  }
  return list;
}

}  // namespace

template <class S>
BasicWorld<S> build_world_in(const Scene& scene) {
  BasicWorld<S> world(scene.settings);
  for (const SceneBody& body : scene.bodies) {
    if constexpr (S::dimension == Dimension::planar)
      world.add_body(body.definition);
    else
      world.add_body(body.spatial);
  }
  std::string report;
  int mistakes = 0;
  for (const SceneJoint& joint : scene.joints) {
    try {
      add_joint(world, joint);
    } catch (const Error& error) {
      report += scene.source->paragraph("error", joint.where,
                                        fmt::format("{}: {}", joint.name, error.what()), "");
      ++mistakes;
    }
  }
  if (mistakes > 0) throw SceneError(report, mistakes);
  for (const SpringDefinition& spring : scene.springs) add_spring(world, spring);
  return world;
}

template <class S>
std::string inconsistency_report(const Scene& scene, const BasicWorld<S>& world, double tolerance) {
  std::string report;
  const std::vector<Inconsistency> rows = world.inconsistencies(tolerance);
  for (int joint = 0; joint < world.joint_count(); ++joint) {
    const SceneJoint& source = scene.joints[static_cast<std::size_t>(joint)];
    const std::string list = rows_text(rows, joint, world.joint_type(joint).row_kinds.size());
    if (list.empty()) continue;
    report += scene.source->paragraph(
        "warning", source.where,
        fmt::format("the start does not fit {} \"{}\": {}", source.definition.type, source.name,
                    list),
        "correct the pose or velocity, or let project = true move the bodies onto their joints");
  }
  return report;
}

#define CDOT_INSTANTIATE(S)                               \
  template BasicWorld<S> build_world_in<S>(const Scene&); \
  template std::string inconsistency_report(const Scene&, const BasicWorld<S>&, double);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
