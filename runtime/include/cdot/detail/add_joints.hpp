// Registers a program's own joints with the runtime. A file written by `cdot_add_joints` calls this before main().
#pragma once

#include <cdot/detail/describe_joint.hpp>
#include <cdot/detail/joint_table.hpp>
#include <cdot/spaces.hpp>

namespace cdot {

// `Space` is Planar or Spatial; the tuple is that of a generated registry.
template <template <class> class Space, class... Joints>
void add_joints(std::type_identity<std::tuple<Joints...>>) {
  (add_joint_type(Space<double>::dimension, describe_joint<Joints>()), ...);
  (joint_entries<Space<double>>().push_back(joint_entry<Space<double>, Joints>()), ...);
  (joint_entries<Space<float>>().push_back(joint_entry<Space<float>, Joints>()), ...);
}

}  // namespace cdot
