// Effects of specs in a random mechanism: on bodies, and on the coordinates of its joints. The kinds, units and ranges
// of their parameters determine the numbers; no code depends on an effect's name.
#pragma once

#include "tests/torture/draw/draw.hpp"

namespace cdot::torture {

// The value of a unit in the mechanism's own: "m^3*kg/s^2".
double scale_of(std::string_view unit, const Scales& scales);

// The scene with the change, if a World takes it; else the reason into `refused`.
template <class S, class Change>
bool taken(Scene& scene, std::vector<std::string>& refused, Change change) {
  Scene trial = scene;
  change(trial);
  try {
    build_world_in<S>(trial).prepare();
  } catch (const Error& error) {
    refused.push_back(error.what());
    return false;
  } catch (const SceneError& error) {
    refused.push_back(error.what());
    return false;
  }
  scene = std::move(trial);
  return true;
}

// The effects that a mechanism may have.
struct EffectTypes {
  std::vector<const JointType*> on_bodies, on_coordinates;
};

// All that are compiled, but for those on coordinates whose names are keys of a scene already.
EffectTypes effects_of_catalogue(Dimension dimension);

// Between bodies of the scene, or one and the world, with random numbers.
SceneJoint random_effect(Random& random, const Scales& scales, const Scene& scene, const JointType& type);

// The effects on coordinate k of the type. They stand in the order of its coordinates, as a reader of the scene adds
// them.
CoordinateEffects& effects_on(SceneJoint& joint, const JointType& type, std::size_t k);

// At most `most` on bodies, and others on coordinates. `refused` receives the reasons why the World took one not.
template <class S>
void add_spec_effects(Random& random, const Scales& scales, const EffectTypes& types, int most, Scene& scene,
                      std::vector<std::string>& refused);

}  // namespace cdot::torture
