// Instantiates every generated planar kernel in float. Apart because this is most of what there is
// to compile.
#include "generated/planar/registry.hpp"
#include "runtime/joint_table.hpp"
#include "runtime/planar.hpp"

namespace cdot {

template <>
std::vector<JointEntry<Planar<float>>>& joint_entries<Planar<float>>() {
  static auto entries =
      make_joint_entries<Planar<float>>(std::type_identity<planar::Joints>{});
  return entries;
}

}  // namespace cdot
