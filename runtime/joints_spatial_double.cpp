// Instantiates every generated spatial kernel in double. Apart because this is most of what there
// is to compile.
#include "generated/spatial/registry.hpp"
#include "runtime/joint_table.hpp"
#include "runtime/spatial.hpp"

namespace cdot {

template <>
std::vector<JointEntry<Spatial<double>>>& joint_entries<Spatial<double>>() {
  static auto entries =
      make_joint_entries<Spatial<double>>(std::type_identity<spatial::Joints>{});
  return entries;
}

}  // namespace cdot
