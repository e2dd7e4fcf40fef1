// Errors of steps by RK4 from what it has computed anyway, so no other steps are taken for them.
//
// The errors of n steps are y_n - y_0 less the integral of dy/dt, which Newton and Cotes' rule takes from the rates at
// the n + 1 ends. Its own error is of ninth order in the step for six steps, of seventh for four, that of the method of
// fifth. What errors of velocities displace within these steps is not in it.
#pragma once

#include <array>
#include <vector>

#include <cdot/world.hpp>

namespace cdot {

struct BodyError {
  std::array<double, 3> position{}, angle{}, velocity{}, spin{};
};

template <class S>
class ErrorsByRates {
 public:
  static constexpr int fewest = 4, most = 6;
  // Of four or six steps.
  explicit ErrorsByRates(int steps) : steps_(steps) {}
  int steps() const { return steps_; }
  // Call after each of the steps, with its number from 0 on and its length. False if it had parts, as at an event.
  bool add(const WorldData<S>& world, int step, double h);
  // Call after the last of them: the errors by body.
  void read(const WorldData<S>& world, std::vector<BodyError>& errors) const;

 private:
  int steps_;
  std::vector<int> awake_;
  long long rescued_ = 0;
  std::vector<double> end_;  // by that rule, [body][numbers_per_body]
};

}  // namespace cdot
