// The registry as data: names, rows, parameters and coordinates of every joint.
#include <algorithm>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

#include <cdot/detail/describe_joint.hpp>
#include <cdot/joints.hpp>
#include <cdot/planar/registry.hpp>
#include <cdot/spatial/registry.hpp>

namespace cdot {
namespace {

template <class... Joints>
std::vector<JointType> describe_all(std::type_identity<std::tuple<Joints...>>) {
  return {describe_joint<Joints>()...};
}

std::vector<JointType>& registered(Dimension dimension) {
  static std::vector<JointType> in_plane = describe_all(std::type_identity<planar::Joints>{});
  static std::vector<JointType> in_space = describe_all(std::type_identity<spatial::Joints>{});
  return dimension == Dimension::planar ? in_plane : in_space;
}

}  // namespace

std::span<const JointType> joint_types(Dimension dimension) { return registered(dimension); }

void add_joint_type(Dimension dimension, JointType type) {
  if (find_joint_type(dimension, type.name) != nullptr)
    throw std::logic_error("there is a joint `" + std::string(type.name) + "` already");
  registered(dimension).push_back(std::move(type));
}

const JointType* find_joint_type(Dimension dimension, std::string_view name) {
  const auto types = joint_types(dimension);
  const auto found = std::find_if(types.begin(), types.end(), [&](const JointType& type) { return type.name == name; });
  return found == types.end() ? nullptr : &*found;
}

}  // namespace cdot
