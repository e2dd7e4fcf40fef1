// The island's whole K at once: J v = -bias to round-off, whatever the mass ratios and however long
// the chain.
#include <cdot/spaces.hpp>

#include "runtime/solve/solve.hpp"

namespace cdot {

template <class S>
void solve_direct(WorldState<S>& world, Island<S>& island) {
  using T = typename S::Scalar;
  System<S>& system = island.system;
  if (system.rows() == 0) return;
  Bodies<S>& all = world.bodies;
  for (const Segment<S>& segment : island.segments)
    segment.batch->ops->velocity(*segment.batch, segment.begin, segment.end, all.velocity.data(),
                                 segment.batch->scratch.data());
  // K lambda = -(J v + bias)
  system.load([](const Batch<S>& batch, int i) { return -(batch.scratch[i] + batch.bias[i]); });
  system.load_tensions(all.velocity.data());
  if (!island.factored) system.assemble(all);
  if (system.lawful()) {
    system.load_laws();
    island.redundant_rows = system.solve_bounded();
  } else {
    if (!island.factored) island.redundant_rows = system.factor();
    system.solve();
  }
  system.store([](Batch<S>& batch, int i, auto lambda) { batch.lambda[i] = T(lambda); });
  for (const Segment<S>& segment : island.segments)
    segment.batch->ops->apply(*segment.batch, segment.begin, segment.end, all, segment.batch->lambda.data(),
                              all.velocity.data());
  system.pull(all, all.velocity.data());
}

#define CDOT_INSTANTIATE(S) template void solve_direct(WorldState<S>&, Island<S>&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
