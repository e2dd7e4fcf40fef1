#include "runtime/tool/import/joined.hpp"

#include <algorithm>
#include <cmath>

namespace cdot {
namespace {

constexpr double perpendicular = 1e-6;  // cosine of directions that count as such, and a distance [m]

bool are_perpendicular(const std::vector<MjcfAxis>& axes) {
  for (std::size_t i = 0; i < axes.size(); ++i)
    for (std::size_t j = i + 1; j < axes.size(); ++j)
      if ((axes[i].type == axes[j].type || axes.size() == 3) &&
          std::abs(axes[i].axis.dot(axes[j].axis)) > perpendicular)
        return false;
  return true;
}
bool are_at_one_point(const std::vector<MjcfAxis>& axes) {
  return std::ranges::all_of(axes, [&](const MjcfAxis& a) { return (a.point - axes[0].point).norm() < perpendicular; });
}
bool is_any_busy(const std::vector<MjcfAxis>& axes) {
  return std::ranges::any_of(axes, [](const MjcfAxis& a) {
    const ModelCoordinate& c = a.coordinate;
    return c.range || c.damping > 0 || c.stiffness > 0 || c.friction > 0;
  });
}

}  // namespace

std::optional<ModelJoint> joined(const std::vector<MjcfAxis>& axes) {
  std::string kinds;
  for (const MjcfAxis& a : axes) kinds += a.type[0];
  ModelJoint joint;
  if (axes.empty()) return joint;
  joint.name = axes.front().name, joint.point = axes.back().point;
  const bool square = are_perpendicular(axes), at_one_point = are_at_one_point(axes);
  if (kinds == "h" || kinds == "s") {
    joint.type = kinds == "h" ? ModelJointType::hinge : ModelJointType::slider;
    joint.axis = axes[0].axis, joint.coordinate = axes[0].coordinate;
  } else if (kinds == "hh" && square && at_one_point) {
    joint.type = ModelJointType::universal;
    joint.axis = axes[0].axis, joint.second = axes[1].axis;
    joint.coordinate = axes[0].coordinate, joint.about_second = axes[1].coordinate;
  } else if (kinds == "ssh" && square && !is_any_busy({axes.begin(), axes.begin() + 2})) {
    joint.type = ModelJointType::plane, joint.name = axes[2].name;
    joint.axis = axes[2].axis, joint.coordinate = axes[2].coordinate;
  } else if (kinds == "b" || (kinds == "hhh" && square && at_one_point && !is_any_busy(axes))) {
    joint.type = ModelJointType::ball;
  } else if (kinds == "f" || ((kinds == "sssb" || kinds == "ssshhh") && square && !is_any_busy(axes))) {
    joint.type = ModelJointType::free;
  } else {
    return {};
  }
  return joint;
}

}  // namespace cdot
