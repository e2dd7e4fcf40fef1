// The step of a run in which the method's own share of the energy changed most, and its largest force of a joint.
#pragma once

#include <cdot/balance.hpp>
#include <cdot/world.hpp>

namespace cdot {

struct LargestForce {
  int joint = -1;    // -1: no joint carried one
  double force = 0;  // [N]
};
template <class S>
LargestForce largest_force(const BasicWorld<S>& world);

struct WorstStep {
  double change = 0;  // of Balance::method() [J]
  double time = 0;    // [s] at its end
  LargestForce largest;
};

template <class S>
class WorstStepWatch {
 public:
  // Of a run of `steps` steps that reports errors of the energy above `told` of its scale: one of these steps then errs
  // by told / steps at least.
  WorstStepWatch(double told, long long steps) : least_(told / static_cast<double>(steps)) {}
  // After every step. Queries the joints where the change exceeds that and the largest so far by a tenth, so that they
  // are queried at some dozen steps of a run at most.
  void look(const BasicWorld<S>& world, const BalanceWatch& balance);
  const WorstStep& found() const { return worst_; }

 private:
  double least_, method_ = 0;
  WorstStep worst_;
};

}  // namespace cdot
