// From a generated struct to JointType: what a World and a reader of scenes know of a joint as data.
#pragma once

#include <algorithm>
#include <type_traits>

#include <cdot/joints.hpp>

namespace cdot {

template <class Joint>
JointType describe_joint() {
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

}  // namespace cdot
