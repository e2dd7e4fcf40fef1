#include "runtime/tool/watch/worst_step.hpp"

#include <algorithm>
#include <cmath>

#include <cdot/spaces.hpp>

namespace cdot {
namespace {

constexpr double larger = 1.1;

double size_of(const planar::Wrench& wrench) { return std::hypot(wrench.force_x, wrench.force_y); }
double size_of(const spatial::Wrench& wrench) { return std::hypot(wrench.force_x, wrench.force_y, wrench.force_z); }

}  // namespace

template <class S>
LargestForce largest_force(const BasicWorld<S>& world) {
  LargestForce largest;
  for (int joint = 0; joint < world.joint_count(); ++joint) {
    if (world.broken(joint)) continue;
    for (const int body : world.joint_bodies(joint)) {
      const double force = size_of(world.reaction(joint, body));
      if (force > largest.force) largest = {joint, force};
    }
  }
  return largest;
}

template <class S>
void WorstStepWatch<S>::look(const BasicWorld<S>& world, const BalanceWatch& balance) {
  const Balance& now = balance.last;
  const double change = now.method() - method_;
  method_ = now.method();
  if (!(std::abs(change) > std::max(larger * std::abs(worst_.change), least_ * balance.energy.scale))) return;
  worst_ = {change, now.time, largest_force(world)};
}

#define CDOT_INSTANTIATE(S)         \
  template class WorstStepWatch<S>; \
  template LargestForce largest_force(const BasicWorld<S>&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
