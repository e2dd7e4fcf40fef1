// The joints that the playground has compiled: those that scenes use most, and all effects. It derives the others from
// their specs and interprets them, so the page stays small.
#include <cdot/detail/describe_joint.hpp>
#include <cdot/detail/joint_table.hpp>
#include <cdot/planar.hpp>
#include <cdot/planar/registry.hpp>
#include <cdot/spatial.hpp>
#include <cdot/spatial/registry.hpp>

namespace cdot {
namespace {

using PlanarJoints =
    std::type_identity<std::tuple<planar::revolute, planar::prismatic, planar::distance, planar::weld>>;
using SpatialJoints = std::type_identity<std::tuple<spatial::revolute, spatial::spherical, spatial::distance>>;

}  // namespace

template <>
std::vector<JointEntry<Planar<double>>>& joint_entries<Planar<double>>() {
  static auto entries = make_joint_entries<Planar<double>>(PlanarJoints{}, std::type_identity<planar::Effects>{});
  return entries;
}
template <>
std::vector<JointEntry<Spatial<double>>>& joint_entries<Spatial<double>>() {
  static auto entries = make_joint_entries<Spatial<double>>(SpatialJoints{}, std::type_identity<spatial::Effects>{});
  return entries;
}

std::vector<JointType> joints_of_program(Dimension dimension) {
  return dimension == Dimension::planar ? describe_joints(PlanarJoints{}, std::type_identity<planar::Effects>{})
                                        : describe_joints(SpatialJoints{}, std::type_identity<spatial::Effects>{});
}

}  // namespace cdot
