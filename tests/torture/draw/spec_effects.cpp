#include "tests/torture/draw/spec_effects.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "runtime/own/own.hpp"

namespace cdot::torture {

double scale_of(std::string_view unit, const Scales& scales) {
  const double newton = scales.mass * scales.length * scales.rate * scales.rate;
  double scale = 1;
  bool over = false;
  for (std::size_t k = 0; k < unit.size();) {
    std::size_t end = unit.find_first_of("*/^", k);
    end = std::min(end, unit.size());
    const std::string_view name = unit.substr(k, end - k);
    int power = 1;
    if (end < unit.size() && unit[end] == '^') power = unit[end + 1] - '0', end += 2;
    const double one = name == "m"    ? scales.length
                       : name == "kg" ? scales.mass
                       : name == "s"  ? 1 / scales.rate
                       : name == "N"  ? newton
                                      : 1;
    scale *= std::pow(one, over ? -power : power);
    if (end < unit.size()) over = unit[end] == '/';
    k = end + 1;
  }
  return scale;
}

namespace {

// Within the range of the parameter. `end`: the sign of the lower or upper end of a range; 0: it is none.
double random_number(Random& random, const Scales& scales, const ParameterInfo& info, double sign) {
  const double size = scale_of(info.unit, scales) * random.log_between(0.1, 10);
  if (sign != 0) return sign * size;
  if (std::isfinite(info.above) && std::isfinite(info.below)) return random.between(info.above, info.below);
  if (std::isfinite(info.above)) return info.above + size;
  if (std::isfinite(info.below)) return info.below - size;
  return random.either_sign(size);
}

// The lower of two ends lies below 0, as the coordinate's start, and the upper above.
double sign_of_end(std::string_view name) { return name == "lower" ? -1 : name == "upper" ? 1 : 0; }

// Numbers of one parameter; those with a default are drawn now and then.
std::vector<double> random_value(Random& random, const Scales& scales, const ParameterInfo& info, bool in_space) {
  if (info.kind == ParameterKind::scalar) return {random_number(random, scales, info, sign_of_end(info.name))};
  const double size = info.kind == ParameterKind::point    ? 0.5 * scales.length
                      : info.kind == ParameterKind::vector ? scale_of(info.unit, scales)
                                                           : 1;
  auto p = random.in_cube(size, in_space);
  if (std::hypot(p[0], p[1], p[2]) < 0.05 * size) p[0] = size;
  return {p.begin(), p.begin() + (in_space ? 3 : 2)};
}

// A body of the scene, and others or the world.
std::vector<int> random_bodies(Random& random, const Scene& scene, int count) {
  const int all = static_cast<int>(scene.bodies.size());
  std::vector<int> bodies{random.below(all)};
  while (static_cast<int>(bodies.size()) < count) {
    const int other = random.chance(0.3) ? world_body : random.below(all);
    bodies.push_back(std::count(bodies.begin(), bodies.end(), other) > 0 ? world_body : other);
  }
  return bodies;
}

SpecEffect random_law(Random& random, const Scales& scales, const JointType& type) {
  SpecEffect effect{std::string(type.name)};
  for (std::size_t k = 0; k < type.parameters.size(); ++k) {
    const CoordinateUse use = type.coordinate_uses[k];
    const bool needed = use == CoordinateUse::required;
    if (needed || (use == CoordinateUse::by_default && random.chance(0.15)))
      effect.parameters.push_back(
          {std::string(type.parameters[k].name), random_value(random, scales, type.parameters[k], false)});
  }
  return effect;
}

// Effects whose names are keys of a scene already.
bool has_key_of_its_own(const JointType& law) {
  return std::any_of(std::begin(effect_kinds), std::end(effect_kinds),
                     [&](const EffectKind* kind) { return law.name == kind->key; });
}

std::vector<const JointType*> laws_for(const EffectTypes& types, const CoordinateInfo& coordinate) {
  std::vector<const JointType*> laws;
  for (const JointType* type : types.on_coordinates)
    if (type->coordinate_unit == coordinate.unit) laws.push_back(type);
  return laws;
}

bool is_compiled(const JointType& type) { return file_of_own_type(std::string(type.name)).empty(); }

}  // namespace

SceneJoint random_effect(Random& random, const Scales& scales, const Scene& scene, const JointType& type) {
  SceneJoint effect;
  effect.definition.type = type.name;
  effect.definition.bodies = random_bodies(random, scene, type.bodies);
  for (const ParameterInfo& info : type.parameters)
    if (!info.has_default || random.chance(0.15))
      effect.definition.parameters.push_back(
          {std::string(info.name), random_value(random, scales, info, scene.dimension == Dimension::spatial)});
  return effect;
}

CoordinateEffects& effects_on(SceneJoint& joint, const JointType& type, std::size_t k) {
  auto at = joint.effects.begin();
  for (std::size_t before = 0; before < k; ++before)
    if (at != joint.effects.end() && at->coordinate == type.coordinates[before].name) ++at;
  if (at == joint.effects.end() || at->coordinate != type.coordinates[k].name)
    at = joint.effects.insert(at, CoordinateEffects{.coordinate = std::string(type.coordinates[k].name)});
  return *at;
}

EffectTypes effects_of_catalogue(Dimension dimension) {
  EffectTypes types;
  for (const JointType& type : joint_types(dimension))
    if (type.is_effect && is_compiled(type)) types.on_bodies.push_back(&type);
  for (const JointType& type : coordinate_effects())
    if (!has_key_of_its_own(type) && is_compiled(type)) types.on_coordinates.push_back(&type);
  return types;
}

template <class S>
void add_spec_effects(Random& random, const Scales& scales, const EffectTypes& types, int most, Scene& scene,
                      std::vector<std::string>& refused) {
  const std::size_t joints = scene.joints.size();
  for (std::size_t j = 0; j < joints; ++j) {
    const JointType& type = *find_joint_type(S::dimension, scene.joints[j].definition.type);
    for (std::size_t k = 0; k < type.coordinates.size(); ++k) {
      const std::vector<const JointType*> laws = laws_for(types, type.coordinates[k]);
      if (laws.empty() || !random.chance(0.4)) continue;
      const SpecEffect law = random_law(random, scales, *random.of(laws));
      taken<S>(scene, refused, [&](Scene& trial) { effects_on(trial.joints[j], type, k).specs.push_back(law); });
    }
  }
  for (int k = 1 + random.below(most); k > 0; --k) {
    SceneJoint effect = random_effect(random, scales, scene, *random.of(types.on_bodies));
    effect.name = fmt::format("e{}", k);
    taken<S>(scene, refused, [&](Scene& trial) { trial.joints.push_back(effect); });
  }
}

#define CDOT_INSTANTIATE(S) \
  template void add_spec_effects<S>(Random&, const Scales&, const EffectTypes&, int, Scene&, std::vector<std::string>&);
CDOT_INSTANTIATE(Planar<double>)
CDOT_INSTANTIATE(Spatial<double>)
#undef CDOT_INSTANTIATE

}  // namespace cdot::torture
