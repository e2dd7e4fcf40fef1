// For watches of joints that break and of rows that end.
#pragma once

#include <vector>

#include "runtime/events/bonds.hpp"
#include "runtime/tool/watch/near_break.hpp"

namespace cdot {

// True if rows of the batch have events.
template <class S>
bool tears(const Batch<S>& batch) {
  return batch.law && batch.law->distance;
}

// A force as a share of the one by which the row ends.
template <class S>
double share_of_end(const Batch<S>& batch, int row, typename S::Scalar force) {
  typename S::Scalar from[2];
  batch.law->distance(batch, row, batch.rate[row], force, from);
  return share_of_strength(double(from[1]));
}

// False if it ends by other things.
template <class S>
bool ends_by_load(const Batch<S>& batch, int row) {
  return share_of_end(batch, row, typename S::Scalar(0)) < 1;
}

template <class S>
bool has_ended(const Batch<S>& batch, int row) {
  return (static_cast<int>(batch.happened[row]) & static_cast<int>(Event::ended)) != 0;
}

template <class S>
int island_of_joint(const WorldData<S>& world, int joint) {
  return world.island_of[movable_body(world, world.joints[joint])];
}

// f(slot, before) for each slot of the batch, with the number that was kept for it; `none` at first.
template <class S, class Number, class F>
void each_kept(const Batch<S>& batch, std::vector<Number>& kept, int each, Number none, F f) {
  kept.resize(static_cast<std::size_t>(batch.count() * each), none);
  for (int slot = 0; slot < batch.count(); ++slot) f(slot, &kept[static_cast<std::size_t>(batch.home[slot] * each)]);
}

}  // namespace cdot
