// The error of a trajectory in the units of the accuracy that was asked for.
#pragma once

#include <cstddef>
#include <vector>

#include "runtime/tool/run/frame.hpp"
#include "runtime/tool/scene/scene.hpp"

namespace cdot {

// For Scene::accuracy: metres and rad. For the default accuracy: sizes of each body's mechanism, and rad.
class Yardstick {
 public:
  explicit Yardstick(const Scene& scene);
  double asked() const { return asked_; }
  bool of_size() const { return of_size_; }
  int mechanisms() const { return mechanisms_; }
  double size(std::size_t body) const { return size_[body]; }  // of its mechanism; 0: not known yet
  // This share of the size of the largest mechanism, or of a radian if that is more.
  double of_largest(double share) const { return share * largest_; }

  // A single point has no size: the distance that it travels, in the first run seen, takes the place of one.
  void see(const std::vector<Frame>& run);
  // The error of velocities that a local error of 1 allows at these, the largest over the bodies [its unit / s].
  double allowed_pace(const Frame& frame) const;
  // The largest over the bodies.
  double apart(const Frame& a, const Frame& b) const;

 private:
  Dimension dimension_;
  double asked_;
  bool of_size_;
  int mechanisms_;
  double largest_;
  std::vector<double> size_;  // of the mechanism of each body [m]
};

}  // namespace cdot
