// The whole catalogue as data. A program that chose its joints defines this function itself (cdot_use_joints).
#include <cdot/detail/describe_joint.hpp>
#include <cdot/planar/registry.hpp>
#include <cdot/spatial/registry.hpp>

namespace cdot {

std::vector<JointType> joints_of_program(Dimension dimension) {
  return dimension == Dimension::planar
             ? describe_joints(std::type_identity<planar::Joints>{}, std::type_identity<planar::Effects>{})
             : describe_joints(std::type_identity<spatial::Joints>{}, std::type_identity<spatial::Effects>{});
}

}  // namespace cdot
