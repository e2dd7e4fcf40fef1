// The balance of a run, and the step in which the method's own share of the energy changed most, with the largest force
// of a joint there.
#pragma once

#include <limits>

#include <cdot/balance.hpp>
#include <cdot/world.hpp>

namespace cdot {

struct Energy;  // runtime/balance/balance.hpp

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
  double most = 0, most_time = 0;  // the same of all steps, also of those that queried no joints
};

template <class S>
class WorstStepWatch {
 public:
  // Of a run of `steps` steps that reports errors of the energy above `told` of its scale: one of these steps then errs
  // by told / steps at least.
  WorstStepWatch(double told, long long steps) : least_(told / static_cast<double>(steps)) {}
  void begin(BasicWorld<S>& world, const Energy& energy, BalanceWatch& balance);
  // After step k, with the energy there. Queries the joints where the change exceeds that and the largest so far by a
  // tenth, so that they are queried at some dozen steps of a run at most. `balance` follows with some steps' delay,
  // unless it is asked for `at_once`.
  void look(BasicWorld<S>& world, const Energy& energy, long long k, bool at_once, BalanceWatch& balance);
  // Tells the extremes of the steps so far.
  void tell(BalanceWatch& balance) const;
  const WorstStep& found() const { return worst_; }

 private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  struct Extreme {
    double method, time;  // [J], [s]
  };
  void note(const Energy& energy, double method, double time);

  double least_, told_ = 0;  // of the energy's scale, and in J
  double method_ = 0;
  double fastest_ = 0, lowest_ = infinity, highest_ = -infinity;  // kinetic and potential energies
  Extreme risen_{-infinity, 0}, fallen_{infinity, 0};
  WorstStep worst_;
};

}  // namespace cdot
