// Joints that hold, though the error of their load may be all that keeps them from breaking; and joints that break
// where K nearly loses rank.
#pragma once

#include <string>
#include <vector>

#include <cdot/world.hpp>

#include "runtime/tool/scene/scene.hpp"

namespace cdot {

struct NearBreak {
  int joint = -1;                  // -1: none
  double distance = 0, error = 0;  // of the load from the strength, as a share of it
  double time = 0;                 // [s], of the step's end
  double share() const { return error / distance; }
};

// By a method of equal steps: loads grow without bound towards a loss of rank, and where steps fall decides how far.
struct BreakAtLoss {
  int joint = -1;   // -1: none
  WeakestRow row;   // by which K nearly loses rank
  double time = 0;  // [s], of the step's end
};

// The load of a joint or a row as a share of its strength. Its distance from breaking is (strength - load) / (strength
// + load); infinite for a joint that is broken.
double share_of_strength(double distance);

class BreakWatch {
 public:
  explicit BreakWatch(const Settings& settings) : local_error_(settings.local_error) {}
  // After every step.
  template <class S>
  void look(BasicWorld<S>& world, double time);
  // The least sure of the joints that hold at the end.
  template <class S>
  NearBreak found(const BasicWorld<S>& world) const;
  // The first one.
  const BreakAtLoss& at_loss() const { return at_loss_; }

 private:
  double local_error_;
  std::vector<double> before_;      // load after the last step, by bond
  std::vector<NearBreak> nearest_;  // by bond
  WeakestRow weakest_;              // after the last step
  BreakAtLoss at_loss_;
};

}  // namespace cdot
