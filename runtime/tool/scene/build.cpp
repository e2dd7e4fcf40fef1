// A scene -> a World. Errors of the World are reported in the lines of the scene.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <span>

#include "runtime/tool/scene/scene.hpp"

namespace cdot {
namespace {

template <class S>
void add_joint(BasicWorld<S>& world, const SceneJoint& source) {
  JointDefinition definition = source.definition;
  for (int& body : definition.bodies) body = body == world_body ? world.ground() : body;
  const int joint = world.add_joint(definition);
  for (const CoordinateEffects& effects : source.effects)
    effects.each([&](const auto& effect) { add_effect(world, joint, effects.coordinate, effect); });
  for (const SpecEffect& bond : source.bonds) add_effect(world, joint, bond);
}

template <class S>
void add_spring(BasicWorld<S>& world, SpringDefinition spring) {
  for (int* body : {&spring.body_a, &spring.body_b}) *body = *body == world_body ? world.ground() : *body;
  if (world.is_static(spring.body_a) && world.is_static(spring.body_b)) return;  // moves nothing; no length is wrong
  world.add_spring(spring);
}

// After the joints and effects, whose defaults are of the written poses.
template <class S>
void move_to_start(BasicWorld<S>& world, const Scene& scene) {
  for (int body = 0; body < std::ssize(scene.bodies); ++body) {
    const SceneBody& source = scene.bodies[static_cast<std::size_t>(body)];
    if (!source.started) continue;
    const auto put = [&](const auto& start) {
      typename S::Exact::Scalar numbers[S::freedom];
      double written[S::freedom];
      S::InDoubles::write(start.velocity, written);
      std::copy_n(written, S::freedom, numbers);
      world.set_pose(body, start.place);
      world.set_velocity(body, S::Exact::read_velocity(numbers));
    };
    if constexpr (S::dimension == Dimension::planar) put(source.planar_start);
    else put(source.spatial_start);
  }
}

// "C2 = -0.25, Cdot1 = -3": positions first; several rows are numbered.
std::string rows_text(std::span<const Inconsistency> rows, std::size_t joint_rows) {
  std::string list;
  for (const bool velocity : {false, true}) {
    for (const Inconsistency& row : rows) {
      if (row.velocity != velocity) continue;
      const std::string number = joint_rows > 1 ? std::to_string(row.row + 1) : "";
      list += fmt::format("{}{}{} = {:.3g}", list.empty() ? "" : ", ", velocity ? "Cdot" : "C", number, row.value);
    }
  }
  return list;
}

constexpr int most_violated = 5;  // joints that the start violates; the others are counted

// If all bodies are this many times further away than they are apart, the origin moves among them.
constexpr double far_away = 1000;

template <class S>
void choose_origin(const Scene& scene, BasicWorld<S>& world) {
  if (scene.bodies.empty()) return;
  Vec3 centre;
  double apart = 1, distance = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const SceneBody& body : scene.bodies) {
      const double x = position_of(body, S::dimension)[axis];
      low = std::min(low, x);
      high = std::max(high, x);
    }
    centre[axis] = double(float(std::round(0.5 * (low + high))));  // exact in either precision
    apart = std::max(apart, high - low);
    distance = std::max(distance, std::abs(centre[axis]));
  }
  if (distance > far_away * apart) world.set_origin(centre[0], centre[1], centre[2]);
}

// Parts of a scene that the World refuses, each reported in its line.
struct Refusals {
  const Scene& scene;
  std::string report{};
  int mistakes = 0;

  template <class Add>
  void attempt(const Span& where, const std::string& name, Add add) {
    try {
      add();
    } catch (const Error& error) {
      report += scene.source->paragraph("error", where, name + error.what(), "");
      ++mistakes;
    }
  }
  void raise() const {
    if (mistakes > 0) throw SceneError(report, mistakes);
  }
};

}  // namespace

Vec3 position_of(const SceneBody& body, Dimension dimension) {
  if (dimension == Dimension::planar) return {body.definition.x, body.definition.y, 0};
  return {body.spatial.x, body.spatial.y, body.spatial.z};
}

template <class S>
BasicWorld<S> build_world_in(const Scene& scene) {
  BasicWorld<S> world(scene.settings);
  choose_origin(scene, world);
  world.on_failure(scene.on_failure);
  for (const SceneBody& body : scene.bodies) {
    if constexpr (S::dimension == Dimension::planar) world.add_body(body.definition);
    else world.add_body(body.spatial);
  }
  Refusals refusals{scene};
  for (const SceneJoint& joint : scene.joints)
    refusals.attempt(joint.where, joint.name + ": ", [&] { add_joint(world, joint); });
  for (const SceneSpring& spring : scene.springs)
    refusals.attempt(spring.where, "", [&] { add_spring(world, spring); });
  refusals.raise();
  move_to_start(world, scene);
  return world;
}

std::string end_name(const Scene& scene, const PassedEnd& end) {
  const SceneJoint& joint = scene.joints[static_cast<std::size_t>(end.joint)];
  if (joint.definition.type == end.effect) return fmt::format("an end of {} \"{}\"", end.effect, joint.name);
  return fmt::format("an end of `{}` of {} \"{}\"", end.effect, joint.definition.type, joint.name);
}

template <class S>
std::string inconsistency_report(const Scene& scene, const BasicWorld<S>& world, double tolerance) {
  std::string report;
  const std::string_view project = scene.project ? "" : ", or set project = true";
  const std::vector<Inconsistency> rows = world.inconsistencies(tolerance);
  int violated = 0;
  std::size_t begin = 0, end = 0;  // the rows of one joint
  for (; begin < rows.size(); begin = end) {
    const int joint = rows[begin].joint;
    while (end < rows.size() && rows[end].joint == joint) ++end;
    if (++violated > most_violated) continue;
    const SceneJoint& source = scene.joints[static_cast<std::size_t>(joint)];
    const std::string list =
        rows_text(std::span(rows).subspan(begin, end - begin), world.joint_type(joint).row_kinds.size());
    report += scene.source->paragraph(
        "warning", source.where,
        fmt::format("the start violates {} \"{}\": {}", source.definition.type, source.name, list),
        fmt::format("correct the pose or velocity{}", project));
  }
  for (const PassedEnd& end : world.passed_ends(tolerance)) {
    if (++violated > most_violated) continue;
    report +=
        scene.source->paragraph("warning", scene.joints[static_cast<std::size_t>(end.joint)].where,
                                fmt::format("the start passes {} by {:.3g} (m or rad)", end_name(scene, end), end.by),
                                fmt::format("correct the pose or the end{}", project));
  }
  if (violated > most_violated)
    report += fmt::format("warning: the start violates {} more joint{}\n", violated - most_violated,
                          violated == most_violated + 1 ? "" : "s");
  return report;
}

#define CDOT_INSTANTIATE(S)                               \
  template BasicWorld<S> build_world_in<S>(const Scene&); \
  template std::string inconsistency_report(const Scene&, const BasicWorld<S>&, double);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
CDOT_FOR_EACH_EXTENDED_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
