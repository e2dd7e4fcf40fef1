#include "runtime/tool/search/yardstick.hpp"

#include <algorithm>
#include <cmath>

#include "runtime/tool/run/trajectory.hpp"
#include "runtime/tool/scene/extent.hpp"

namespace cdot {

Yardstick::Yardstick(const Scene& scene)
    : dimension_(scene.dimension),
      asked_(scene.accuracy > 0 ? scene.accuracy : default_accuracy),
      of_size_(scene.accuracy == 0) {
  const Extents extents = extents_of(scene);
  mechanisms_ = std::max(1, extents.mechanisms);
  largest_ = 1;
  if (!of_size_ && !extents.of_body.empty()) largest_ = std::max(1.0, *std::ranges::max_element(extents.of_body));
  size_ = of_size_ ? extents.of_body : std::vector<double>(scene.bodies.size(), 1);
}

void Yardstick::see(const std::vector<Frame>& run) {
  for (std::size_t k = 0; k < size_.size(); ++k) {
    if (size_[k] > 0) continue;
    for (const Frame& frame : run)
      size_[k] = std::max(size_[k], cdot::apart(frame.bodies[k], run.front().bodies[k], dimension_).position);
    if (size_[k] == 0) size_[k] = 1;
  }
}

double Yardstick::allowed_pace(const Frame& frame) const {
  double most = 0;
  for (std::size_t k = 0; k < size_.size(); ++k) {
    const BodyState& body = frame.bodies[k];
    most = std::max({most, (1 + std::hypot(body.vx, body.vy, body.vz)) / size_[k], 1 + std::abs(body.w),
                     1 + std::hypot(body.wx, body.wy, body.wz)});
  }
  return most;
}

double Yardstick::apart(const Frame& a, const Frame& b) const {
  double worst = 0;
  for (std::size_t k = 0; k < size_.size(); ++k) {
    const Apart one = cdot::apart(a.bodies[k], b.bodies[k], dimension_);
    worst = std::max({worst, one.position / size_[k], one.angle});
  }
  return worst;
}

}  // namespace cdot
