// The joints of the generated registry as data: a reader of scenes lists them and finds them by name.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include <cdot/kernel.hpp>

namespace cdot {

struct CoordinateInfo {
  std::string_view name;  // "angle", "slide"
  std::string_view unit;  // "rad", "m"
};

struct JointType {
  std::string_view name;
  std::string_view title;  // one sentence on its purpose
  int bodies;
  std::vector<std::string_view> body_names;  // "a", "b", ...
  std::vector<std::string_view> row_names;
  std::vector<RowKind> row_kinds;
  std::vector<ParameterInfo> parameters;
  std::vector<CoordinateInfo> coordinates;
  int parameter_size;           // numbers in Parameters<T>
  bool explicit_time;           // C or the force of an effect depends on t explicitly
  bool is_effect = false;       // its rows are coordinates that its law pushes, not constraints
  bool without_energy = false;  // an effect with a force beside that of its energy, which may damp
  // Of an effect that acts on the coordinate of any joint too: the unit of that, and the use of each parameter there.
  // The unit of one on a joint itself is "joint".
  std::string_view coordinate_unit{};
  std::vector<CoordinateUse> coordinate_uses{};
  bool acts_on_joint() const { return coordinate_unit == "joint"; }
  bool acts_on(std::string_view unit) const { return coordinate_unit == "any" || coordinate_unit == unit; }
};

enum class Dimension { planar, spatial };

// For cdot/detail/add_joints.hpp, before any World is made. Throws std::logic_error if the name is taken.
void add_joint_type(Dimension dimension, JointType type);

// Every registered joint of a dimension, in the order of its registry.
std::span<const JointType> joint_types(Dimension dimension);
// The effects of the catalogue that act on the coordinate of any joint, or on any joint, in the plane and in space.
std::span<const JointType> coordinate_effects();
// nullptr if none has that name.
const JointType* find_coordinate_effect(std::string_view name);

// nullptr if no joint has that name.
const JointType* find_joint_type(Dimension dimension, std::string_view name);

}  // namespace cdot
