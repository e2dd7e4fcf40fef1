#include "derive/compile/scene/effects.hpp"

#include <fmt/format.h>
#include <type_traits>

#include <cdot/effects.hpp>

#include "runtime/state/world_data.hpp"

namespace cdot::compile {
namespace {

bool is_damper(const CoordinateSpring& spring) {
  return !spring.softness.by_frequency && spring.softness.stiffness == 0;
}

class EffectReader {
 public:
  EffectReader(const Scene& scene, BasicWorld<Space>& world, const RefuseEffect& refuse, Mechanism& mechanism)
      : scene_(scene), world_(world), refuse_(refuse), mechanism_(mechanism) {}

  void read() {
    const int joints = static_cast<int>(scene_.joints.size());
    for (int j = 0; j < joints; ++j) {
      const SceneJoint& source = scene_.joints[static_cast<std::size_t>(j)];
      if (record(j).places.empty()) continue;  // between immovable bodies
      if (world_.joint_type(j).is_effect) add_of_joint(source, j);
      else if (source.definition.soft) add_soft(source.name, j);
      add_on_coordinates(source, j);
    }
    for (int j = joints; j < world_.joint_count(); ++j)
      if (!record(j).places.empty()) add_soft(fmt::format("spring{}", j - joints + 1), j);
  }

 private:
  const JointRecord& record(int joint) { return world_.data().joints[static_cast<std::size_t>(joint)]; }
  const Batch<Space>& batch_of(const Place& place) {
    return *world_.data().batches[static_cast<std::size_t>(place.batch)];
  }
  bool is_bounded(const Place& place) { return batch_of(place).law && batch_of(place).law->guard; }
  bool has_limits(const Place& place) { return batch_of(place).law->within_limits != nullptr; }

  std::vector<double> constants_of(const Place& place) {
    const Batch<Space>& batch = batch_of(place);
    const int count = batch.law->constants;
    const double* const first = batch.constants.data() + slot_of(world_.data(), place) * count;
    return {first, first + count};
  }

  // An effect that acts along the rows of the World's joint.
  Effect along(const std::string& name, int joint) {
    Effect effect{name, std::string(world_.joint_type(joint).name), {}, record(joint).bodies, {}, {}, {}, {}};
    const int ground = static_cast<int>(scene_.bodies.size());
    for (int& body : effect.bodies) body = body == world_.ground() ? ground : body;
    effect.parameters = world_.joint_parameters(joint);
    return effect;
  }

  void add_of_joint(const SceneJoint& source, int joint) {
    Effect effect = along(source.name, joint);
    const std::vector<Place>& places = record(joint).places;
    for (const Place& place : places)
      if (is_bounded(place)) return refuse_(&source, fmt::format("{}: a row with bounds", effect.type));
    if (has_limits(places[0]) && mechanism_.method == Method::euler)
      return refuse_(&source, fmt::format("{} by Euler's method: a force with limits", effect.type));
    effect.law_type = effect.type;
    effect.numbers = effect.parameters;
    mechanism_.effects.push_back(std::move(effect));
  }

  void add_soft(const std::string& name, int joint) {
    Effect effect = along(name, joint);
    effect.law = Effect::spring;
    effect.numbers = constants_of(record(joint).places[0]);
    effect.numbers.push_back(0);  // C itself is the distance from rest
    mechanism_.effects.push_back(std::move(effect));
  }

  void add_on_coordinates(const SceneJoint& source, int joint) {
    std::size_t count = 0;
    for (const CoordinateEffects& on : source.effects) on.each([&](const auto&) { ++count; });
    const std::vector<Place>& places = record(joint).places;
    std::size_t next = places.size() - count;
    for (const CoordinateEffects& on : source.effects)
      on.each([&](const auto& effect) { add_on_coordinate(source, joint, on.coordinate, effect, places[next++]); });
  }

  template <class Kind>
  void add_on_coordinate(const SceneJoint& source, int joint, const std::string& coordinate, const Kind& kind,
                         const Place& place) {
    Effect effect = along(source.name + "." + coordinate, joint);
    effect.coordinate = coordinate;
    effect.numbers = constants_of(place);
    std::string what = "row with bounds";
    if constexpr (std::is_same_v<Kind, SpecEffect>) what = effect.law_type = kind.type;
    else if constexpr (std::is_same_v<Kind, CoordinateSpring>)
      effect.law = Effect::spring, what = is_damper(kind) ? "damper" : "spring";
    else if constexpr (std::is_same_v<Kind, Load>) effect.law = Effect::load, what = "load";
    else if constexpr (std::is_same_v<Kind, Motor>) what = "motor";
    else if constexpr (std::is_same_v<Kind, Limit>) what = "limit";
    else if constexpr (std::is_same_v<Kind, DryFriction>) what = "friction";
    effect.name += "." + what;
    if (is_bounded(place)) return refuse_(&source, fmt::format("{}.{}: a row with bounds", coordinate, what));
    if (has_limits(place) && mechanism_.method == Method::euler)
      return refuse_(&source, fmt::format("{}.{} by Euler's method: a force with limits", coordinate, what));
    mechanism_.effects.push_back(std::move(effect));
  }

  const Scene& scene_;
  BasicWorld<Space>& world_;
  const RefuseEffect& refuse_;
  Mechanism& mechanism_;
};

}  // namespace

void read_effects(const Scene& scene, BasicWorld<Space>& world, const RefuseEffect& refuse, Mechanism& mechanism) {
  EffectReader(scene, world, refuse, mechanism).read();
}

}  // namespace cdot::compile
