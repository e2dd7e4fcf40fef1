#include "runtime/tool/watch/worst_step.hpp"

#include <algorithm>
#include <cmath>

#include <cdot/spaces.hpp>

#include "runtime/balance/balance.hpp"
#include "runtime/state/world_data.hpp"

namespace cdot {
namespace {

constexpr double larger = 1.1;
// Steps between looks at momenta, which change slowly. For a free body one costs a quarter of a step.
constexpr long long steps_of_momenta = 32;

// Balance::method() since the first step.
template <class S>
double method_of(const WorldData<S>& world, const Energy& now) {
  const auto [put_in, taken] = work_so_far(world);
  return now.kinetic + now.potential - world.accounts.start - put_in + taken;
}

double size_of(const planar::Wrench& wrench) { return std::hypot(wrench.force_x, wrench.force_y); }
double size_of(const spatial::Wrench& wrench) { return std::hypot(wrench.force_x, wrench.force_y, wrench.force_z); }

Balance balance_at(double time, double kinetic, double potential, double method) {
  Balance balance;
  balance.time = time, balance.kinetic = kinetic, balance.potential = potential;
  balance.start = kinetic + potential, balance.put_in = -method;
  return balance;
}

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

// Only numbers are extremes.
template <class S>
void WorstStepWatch<S>::note(const Energy& energy, double method, double time) {
  fastest_ = std::max(fastest_, energy.kinetic);
  lowest_ = std::min(lowest_, energy.potential), highest_ = std::max(highest_, energy.potential);
  if (method > risen_.method) risen_ = {method, time};
  if (method < fallen_.method) fallen_ = {method, time};
}

// By balances that have these extremes and no others.
template <class S>
void WorstStepWatch<S>::tell(BalanceWatch& balance) const {
  if (!(lowest_ <= highest_ && fallen_.method <= risen_.method)) return;
  const Balance last = balance.last;
  balance.look(balance_at(0, fastest_, lowest_, 0));
  for (const auto& [method, time] : {risen_, fallen_}) balance.look(balance_at(time, 0, highest_, method));
  balance.look(last);
}

template <class S>
void WorstStepWatch<S>::begin(BasicWorld<S>& world, const Energy& energy, BalanceWatch& balance) {
  balance.look(balance_of(world.data(), energy, true));
  method_ = balance.last.method(), told_ = least_ * balance.energy.scale;
  note(energy, method_, world.data().time);
}

template <class S>
void WorstStepWatch<S>::look(BasicWorld<S>& world, const Energy& energy, long long k, bool at_once,
                             BalanceWatch& balance) {
  const WorldData<S>& data = world.data();
  const double method = method_of(data, energy), change = std::abs(method - method_);
  note(energy, method, data.time);
  if (k % steps_of_momenta == 0 || at_once || std::isnan(method)) {
    tell(balance);
    balance.look(balance_of(data, energy, k % steps_of_momenta == 0));
    told_ = least_ * balance.energy.scale;
  }
  if (change > std::abs(worst_.most)) worst_.most = method - method_, worst_.most_time = data.time;
  if (change > told_ && change > larger * std::abs(worst_.change))
    worst_.change = method - method_, worst_.time = data.time, worst_.largest = largest_force(world);
  method_ = method;
}

#define CDOT_INSTANTIATE(S)         \
  template class WorstStepWatch<S>; \
  template LargestForce largest_force(const BasicWorld<S>&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
