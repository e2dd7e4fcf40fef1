// The registry as data: names, rows, parameters and coordinates of every joint.
#include "runtime/joints.hpp"

#include <algorithm>
#include <type_traits>

#include "generated/planar/registry.hpp"
#include "generated/spatial/registry.hpp"

namespace cdot {
namespace {

template <class Joint>
JointType describe() {
  JointType type;
  type.name = Joint::name;
  type.title = Joint::title;
  type.bodies = Joint::bodies;
  type.body_names.assign(Joint::body_names.begin(), Joint::body_names.end());
  type.row_names.assign(Joint::row_names.begin(), Joint::row_names.end());
  type.row_kinds.assign(Joint::row_kinds.begin(), Joint::row_kinds.end());
  type.parameters.assign(Joint::parameters.begin(), Joint::parameters.end());
  [&]<class... Coordinates>(std::type_identity<std::tuple<Coordinates...>>) {
    (type.coordinates.push_back({Coordinates::name, Coordinates::unit}), ...);
  }(std::type_identity<typename Joint::Coordinates>{});
  type.parameter_size = 0;
  for (const ParameterInfo& info : type.parameters)
    type.parameter_size = std::max(type.parameter_size, info.offset + info.size);
  type.explicit_time = Joint::explicit_time;
  return type;
}

template <class... Joints>
std::vector<JointType> describe_all(std::type_identity<std::tuple<Joints...>>) {
  return {describe<Joints>()...};
}

}  // namespace

std::span<const JointType> joint_types(Dimension dimension) {
  static const std::vector<JointType> in_plane = describe_all(std::type_identity<planar::Joints>{});
  static const std::vector<JointType> in_space =
      describe_all(std::type_identity<spatial::Joints>{});
  return dimension == Dimension::planar ? in_plane : in_space;
}

const JointType* find_joint_type(Dimension dimension, std::string_view name) {
  const auto types = joint_types(dimension);
  const auto found = std::find_if(types.begin(), types.end(),
                                  [&](const JointType& type) { return type.name == name; });
  return found == types.end() ? nullptr : &*found;
}

}  // namespace cdot
