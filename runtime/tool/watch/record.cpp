#include "runtime/tool/watch/record.hpp"

#include <algorithm>

namespace cdot {
namespace {

// clang-format off
constexpr Recordable groups_of_sensors[] = {
    {"coordinates",   "of every joint, and their rates"},
    {"reactions",     "force and torque of every joint on its last body"},
    {"drives",        "force and power of all effects on a coordinate; power of effects between bodies"},
    {"accelerations", "of every body that moves, mean over the last step"},
    {"energies",      "kinetic energy, and with potentials"},
};
// clang-format on

const JointType& type_of(const Scene& scene, const SceneJoint& joint) {
  return *find_joint_type(scene.dimension, joint.definition.type);
}

// Whether an effect acts on the coordinate.
bool is_driven(const SceneJoint& joint, const std::string& coordinate) {
  const auto found = std::ranges::find(joint.effects, coordinate, &CoordinateEffects::coordinate);
  bool any = false;
  if (found != joint.effects.end()) found->each([&](const auto&) { any = true; });
  return any;
}

// The group of a quantity; null if none has it.
const char* group_of(const Scene& scene, const Measured& m) {
  using enum Measured::What;
  const auto joint = [&]() -> const SceneJoint& { return scene.joints[static_cast<std::size_t>(m.joint)]; };
  switch (m.what) {
    case energy:
    case kinetic: return "energies";
    case coordinate:
    case rate: return "coordinates";
    case effects:
    case power: return m.effect.empty() && is_driven(joint(), m.coordinate_name) ? "drives" : nullptr;
    case given: return type_of(scene, joint()).is_effect ? "drives" : nullptr;
    case force:
    case torque: return type_of(scene, joint()).is_effect ? nullptr : "reactions";
    case acceleration:
    case angular_acceleration:
      return scene.bodies[static_cast<std::size_t>(m.joint)].is_static ? nullptr : "accelerations";
  }
  return nullptr;
}

// The quantity, or one component of it. Names of a scene need not fit an expression, so it gets one that does.
void add_sensor(Scene& scene, const Measured& measured, const Vocabulary::Quantity& quantity, const std::string& part) {
  const std::string name = quantity.name + part;
  if (std::ranges::find(scene.sensors, name, &Sensor::name) != scene.sensors.end()) return;
  const Vocabulary one{scene.dimension == Dimension::planar ? 2 : 3, {}, {{"value", quantity.unit, quantity.vector}}};
  const std::string unit = quantity.unit == "J/s" ? "W" : quantity.unit;
  scene.sensors.push_back({name, unit, *Formula::read("value" + part, one).formula, {measured}});
}

}  // namespace

std::span<const Recordable> recordables() { return groups_of_sensors; }

void record(Scene& scene, const std::vector<std::string>& groups) {
  const Measurable all = measurable_of(scene);
  const auto asked = [&](const std::string& name) { return std::ranges::find(groups, name) != groups.end(); };
  for (const Recordable& group : groups_of_sensors) {
    if (!asked("all") && !asked(group.name)) continue;
    for (std::size_t k = 0; k < all.measured.size(); ++k) {
      const char* of = group_of(scene, all.measured[k]);
      if (of == nullptr || std::string_view(of) != group.name) continue;
      const Vocabulary::Quantity& quantity = all.words.quantities[k];
      if (!quantity.vector) add_sensor(scene, all.measured[k], quantity, "");
      for (int c = 0; quantity.vector && c < (scene.dimension == Dimension::planar ? 2 : 3); ++c)
        add_sensor(scene, all.measured[k], quantity, std::string(".") + "xyz"[c]);
    }
  }
}

}  // namespace cdot
