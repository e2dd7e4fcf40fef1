#include "runtime/tool/watch/near_break.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <cdot/spaces.hpp>

#include "runtime/events/bonds.hpp"
#include "runtime/tool/watch/rank_watch.hpp"
#include "runtime/tool/watch/watched_ends.hpp"

namespace cdot {
namespace {

// Errors of loads in local errors, where a method chooses its steps and locates what breaks.
constexpr double errors_of_loads = 1e4;

template <class S>
bool locates(const WorldData<S>& world, const Bond& bond) {
  return world.islands[island_of_joint(world, bond.joint)].flow.locates;
}

}  // namespace

double share_of_strength(double distance) { return std::isinf(distance) ? distance : (1 - distance) / (1 + distance); }

// Equal steps know the mean of a load. Within a step it may differ from that by as much as from one step to the next.
template <class S>
void BreakWatch::look(BasicWorld<S>& world, double time) {
  const WorldData<S>& data = world.data();
  if (data.bonds.empty()) return;
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  before_.resize(data.bonds.size(), unknown), nearest_.resize(data.bonds.size());
  const WeakestRow& now_weakest = world.weakest_row();
  const WeakestRow& weakest = is_near_loss(now_weakest) ? now_weakest : weakest_;
  for (std::size_t k = 0; k < data.bonds.size(); ++k) {
    const double load = share_of_strength(distance_from_break(data, data.bonds[k], time));
    const double error = local_error_ > 0 ? errors_of_loads * local_error_ : std::abs(load - before_[k]);
    const bool breaks = std::isinf(load) && std::isfinite(before_[k]);
    const bool by_equal_steps = local_error_ == 0 || !locates(data, data.bonds[k]);
    if (breaks && at_loss_.joint < 0 && is_near_loss(weakest) && by_equal_steps)
      at_loss_ = {data.bonds[k].joint, weakest, time};
    const NearBreak now{data.bonds[k].joint, std::max(0.0, 1 - load), error, time};
    const NearBreak& most = nearest_[k];
    if (std::isfinite(load) && 1 - load < error && (most.joint < 0 || now.share() > most.share())) nearest_[k] = now;
    before_[k] = load;
  }
  weakest_ = now_weakest;
}

template <class S>
NearBreak BreakWatch::found(const BasicWorld<S>& world) const {
  NearBreak most;
  for (const NearBreak& one : nearest_)
    if (one.joint >= 0 && !world.broken(one.joint) && (most.joint < 0 || one.share() > most.share())) most = one;
  return most;
}

#define CDOT_INSTANTIATE(S)                               \
  template void BreakWatch::look(BasicWorld<S>&, double); \
  template NearBreak BreakWatch::found(const BasicWorld<S>&) const;
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
