// Registers a program's own joints with the runtime. A file written by `cdot_add_joints` calls this before main().
#pragma once

#include <stdexcept>
#include <string>

#include <cdot/detail/coordinate_effects.hpp>
#include <cdot/detail/describe_joint.hpp>
#include <cdot/detail/joint_table.hpp>
#include <cdot/spaces.hpp>

namespace cdot {

// An effect whose law is about one coordinate: on the coordinates of all joints.
template <class Pose, class Effect>
void add_coordinate_effect() {
  if constexpr (requires { Effect::coordinate_unit; }) {
    if (find_coordinate_effect(Effect::name) != nullptr)
      throw std::logic_error("there is already an effect `" + std::string(Effect::name) + "` on coordinates");
    registered_coordinate_effects().push_back(describe_joint<Effect>());
    functions_on_coordinates().push_back(functions_on_coordinate<Effect, Pose>());
    laws_on_coordinates<Planar<double>>().push_back(law_on_coordinate<Planar<double>, Effect>());
    laws_on_coordinates<Planar<float>>().push_back(law_on_coordinate<Planar<float>, Effect>());
    laws_on_coordinates<Spatial<double>>().push_back(law_on_coordinate<Spatial<double>, Effect>());
    laws_on_coordinates<Spatial<float>>().push_back(law_on_coordinate<Spatial<float>, Effect>());
  }
}

// `Space` is Planar or Spatial; the tuple is that of a generated registry.
template <template <class> class Space, class... Joints>
void add_joints(std::type_identity<std::tuple<Joints...>>) {
  (add_joint_type(Space<double>::dimension, describe_joint<Joints>()), ...);
  (joint_entries<Space<double>>().push_back(joint_entry<Space<double>, Joints>()), ...);
  (joint_entries<Space<float>>().push_back(joint_entry<Space<float>, Joints>()), ...);
  (add_coordinate_effect<typename Space<double>::Pose, Joints>(), ...);
}

// The tuple is that of the registry of effects on any coordinate.
template <class... Effects>
void add_effects_on_any_coordinate(std::type_identity<std::tuple<Effects...>>) {
  (add_coordinate_effect<planar::Pose<double>, Effects>(), ...);
}

}  // namespace cdot
