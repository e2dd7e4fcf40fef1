// Instantiates every generated planar kernel in double. Apart because this is most of what there is
// to compile.
#include "generated/planar/registry.hpp"
#include "runtime/joint_table.hpp"
#include "runtime/planar.hpp"

namespace cdot {

template <>
std::vector<JointEntry<Planar<double>>>& joint_entries<Planar<double>>() {
  static auto entries =
      make_joint_entries<Planar<double>>(std::type_identity<planar::Joints>{});
  return entries;
}

}  // namespace cdot
