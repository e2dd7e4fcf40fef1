// Newton for the middle of a step of the implicit midpoint rule (midpoint.cpp).
#pragma once

#include "runtime/state/world_data.hpp"

namespace cdot {

// f(i) for the rows of slots, f(batch, i) for those of an island.
template <class S, class F>
void each_row(const Batch<S>& batch, int begin, int end, F f) {
  for (int i = begin * batch.ops->rows; i < end * batch.ops->rows; ++i) f(i);
}
template <class S, class F>
void each_row(const Island<S>& island, F f) {
  for (const Segment<S>& segment : island.segments)
    each_row(*segment.batch, segment.begin, segment.end, [&](int i) { f(*segment.batch, i); });
}

// Newton for v_m and lambda of a step of h from the start in Flow. Leaves v_m in the velocities, lambda in
// Batch::correction, the end in the poses, and J v of the mean velocity in Batch::rate. False if the step is too long
// for it.
template <class S>
bool find_middle(WorldData<S>& world, Island<S>& island, typename S::Scalar h);

}  // namespace cdot
