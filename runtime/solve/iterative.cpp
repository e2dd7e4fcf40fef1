// Sequential impulses: each block brings its own rows to J v = -bias, in turn, again and again.
#include <algorithm>

#include <cdot/spaces.hpp>

#include "runtime/solve/solve.hpp"

namespace cdot {

template <class S>
void solve_iterative(WorldState<S>& world, Island<S>& island, typename S::Scalar share) {
  using T = typename S::Scalar;
  const bool warm = world.settings.warm_start;
  if (!warm) share = 0;
  for (const Segment<S>& segment : island.segments) {
    Batch<S>& batch = *segment.batch;
    const int rows = batch.ops->rows;
    T* const lambda = batch.lambda.data();
    for (int i = segment.begin * rows; i < segment.end * rows; ++i) lambda[i] *= share;
    if (warm)
      batch.ops->apply(batch, segment.begin, segment.end, world.bodies, batch.lambda.data(),
                       world.bodies.velocity.data());
  }
  for (int sweep = 0; sweep < world.settings.iterations; ++sweep) {
    for (const Segment<S>& segment : island.segments) {
      Batch<S>& batch = *segment.batch;
      if (batch.law) batch.ops->iterate_bounded(batch, segment.begin, segment.end, world.bodies);
      else batch.ops->iterate(batch, segment.begin, segment.end, world.bodies, batch.lambda.data());
    }
  }
}

#define CDOT_INSTANTIATE(S) template void solve_iterative(WorldState<S>&, Island<S>&, S::Scalar);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
