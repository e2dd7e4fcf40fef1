// A generated struct -> JointType: the joint as data, for Worlds and for readers of scenes.
#pragma once

#include <algorithm>
#include <tuple>
#include <type_traits>
#include <vector>

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
  type.is_effect = requires { Joint::is_effect; };
  if constexpr (requires { Joint::is_effect; }) {
    type.explicit_time |= Joint::law_in_time;
    constexpr bool stores = requires { &Joint::template energy<double>; };
    constexpr bool also_pushes = requires { &Joint::template unstored<double>; };
    type.without_energy = also_pushes || !stores;
  }
  if constexpr (requires { Joint::coordinate_unit; }) {
    type.coordinate_unit = Joint::coordinate_unit;
    type.coordinate_uses.assign(Joint::coordinate_uses.begin(), Joint::coordinate_uses.end());
  }
  if constexpr (requires { Joint::on_joint; }) type.explicit_time |= Joint::in_time;
  if constexpr (requires { typename Joint::Bounded; }) {
    [&]<class... Rows>(std::type_identity<std::tuple<Rows...>>) {
      type.explicit_time |= (Rows::in_time || ...);
    }(std::type_identity<typename Joint::Bounded>{});
  }
  return type;
}

template <class... Joints, class... Effects>
std::vector<JointType> describe_joints(std::type_identity<std::tuple<Joints...>>,
                                       std::type_identity<std::tuple<Effects...>> = {}) {
  return {describe_joint<Joints>()..., describe_joint<Effects>()...};
}

// The joints of a program: the whole catalogue, or its own choice (cdot_use_joints).
std::vector<JointType> joints_of_program(Dimension dimension);

}  // namespace cdot
