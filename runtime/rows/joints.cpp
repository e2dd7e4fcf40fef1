// The registry as data: names, rows, parameters and coordinates of every joint.
#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include <cdot/detail/describe_joint.hpp>

namespace cdot {
namespace {

std::vector<JointType>& registered(Dimension dimension) {
  static std::vector<JointType> in_plane = joints_of_program(Dimension::planar);
  static std::vector<JointType> in_space = joints_of_program(Dimension::spatial);
  return dimension == Dimension::planar ? in_plane : in_space;
}

}  // namespace

std::span<const JointType> joint_types(Dimension dimension) { return registered(dimension); }

void add_joint_type(Dimension dimension, JointType type) {
  if (find_joint_type(dimension, type.name) != nullptr)
    throw std::logic_error("there is already a joint `" + std::string(type.name) + "`");
  registered(dimension).push_back(std::move(type));
}

const JointType* find_joint_type(Dimension dimension, std::string_view name) {
  const auto types = joint_types(dimension);
  const auto found = std::find_if(types.begin(), types.end(), [&](const JointType& type) { return type.name == name; });
  return found == types.end() ? nullptr : &*found;
}

}  // namespace cdot
