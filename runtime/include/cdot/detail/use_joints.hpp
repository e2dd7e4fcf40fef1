// A program's own choice of joints in place of the whole catalogue, for the file that cdot_use_joints writes. That file
// defines the catalogue's functions, so the linker omits the library's catalogue.
#pragma once

#include <cdot/detail/describe_joint.hpp>
#include <cdot/detail/joint_table.hpp>
#include <cdot/spaces.hpp>

// `planar_joints` and `spatial_joints` are tuples of generated structs. Use at global scope, once in a program.
#define CDOT_USE_JOINTS(planar_joints, spatial_joints)                                             \
  namespace cdot {                                                                                 \
  CDOT_USE_JOINTS_IN(Planar<double>, planar_joints)                                                \
  CDOT_USE_JOINTS_IN(Planar<float>, planar_joints)                                                 \
  CDOT_USE_JOINTS_IN(Spatial<double>, spatial_joints)                                              \
  CDOT_USE_JOINTS_IN(Spatial<float>, spatial_joints)                                               \
  std::vector<JointType> joints_of_program(Dimension dimension) {                                  \
    return dimension == Dimension::planar ? describe_joints(std::type_identity<planar_joints>{})   \
                                          : describe_joints(std::type_identity<spatial_joints>{}); \
  }                                                                                                \
  }

#define CDOT_USE_JOINTS_IN(Space, joints)                                          \
  template <>                                                                      \
  std::vector<JointEntry<Space>>& joint_entries<Space>() {                         \
    static auto entries = make_joint_entries<Space>(std::type_identity<joints>{}); \
    return entries;                                                                \
  }
