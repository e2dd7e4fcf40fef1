// Instantiates every generated spatial kernel in float. Apart because this is most of what there is
// to compile.
#include "generated/spatial/registry.hpp"
#include "runtime/joint_table.hpp"
#include "runtime/spatial.hpp"

namespace cdot {

template <>
std::vector<JointEntry<Spatial<float>>>& joint_entries<Spatial<float>>() {
  static auto entries =
      make_joint_entries<Spatial<float>>(std::type_identity<spatial::Joints>{});
  return entries;
}

}  // namespace cdot
