// The joints that MJCF gives one body, as one joint of a Model.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "runtime/tool/import/model.hpp"

namespace cdot {

// A <joint> of MJCF: hinge, slide, ball or free.
struct MjcfAxis {
  std::string name, type;
  Eigen::Vector3d point, axis;
  ModelCoordinate coordinate;
};

// Several joints of one body, as one that keeps all that acts on them; none if there is no such joint.
std::optional<ModelJoint> joined(const std::vector<MjcfAxis>& axes);

}  // namespace cdot
