// Acceleration level: M dv/dt = f + J^T lambda with J dv/dt = gamma, lambda being forces. The solvers are those of the
// velocities, with dv/dt in their place and -gamma for the bias.
#include <algorithm>

#include <cdot/spaces.hpp>

#include "runtime/motion/motion.hpp"
#include "runtime/solve/projection.hpp"
#include "runtime/solve/solve.hpp"

namespace cdot {
namespace {

// K lambda = gamma - J dv/dt without joints, known forces being given.
template <class S>
void solve_for_forces(WorldState<S>& world, Island<S>& island) {
  using T = typename S::Scalar;
  System<S>& system = island.system;
  if (system.rows() == 0) return;
  auto* rate = world.bodies.velocity_rate.data();
  for (const Segment<S>& segment : island.segments)
    segment.batch->ops->velocity(*segment.batch, segment.begin, segment.end, rate, segment.batch->scratch.data());
  system.load([](const Batch<S>& batch, int i) { return -(batch.scratch[i] + batch.bias[i]); });
  if (!island.factored) system.assemble(world.bodies);
  if (system.lawful()) {
    system.choose([](const Batch<S>& batch, int i) { return !batch.law || batch.mode[i] == Mode::held; });
    system.give([](const Batch<S>& batch, int i) { return batch.law ? batch.lower[i] : T(0); });
  }
  if (!island.factored) island.redundant_rows = system.factor();
  island.factored = true;
  system.solve();
  system.store([](Batch<S>& batch, int i, auto lambda) { batch.lambda[i] = T(lambda); });
  for (const Segment<S>& segment : island.segments)
    segment.batch->ops->apply(*segment.batch, segment.begin, segment.end, world.bodies, segment.batch->lambda.data(),
                              rate);
}

}  // namespace

template <class S>
void find_known_forces(WorldState<S>& world, Batch<S>& batch, int begin, int end) {
  using T = typename S::Scalar;
  const int rows = batch.ops->rows;
  batch.ops->effective_mass(batch, begin, end, world.bodies);
  batch.ops->velocity(batch, begin, end, world.bodies.velocity.data(), batch.scratch.data());
  for (int slot = begin; slot < end; ++slot) {
    T force[most_rows], rate[most_rows];
    for (int r = 0; r < rows; ++r) rate[r] = batch.scratch[slot * rows + r] + batch.bias[slot * rows + r];
    batch.law->force(batch, slot, rate, force);
    for (int r = 0; r < rows; ++r) {
      batch.softness[slot * rows + r] = 0;
      batch.lower[slot * rows + r] = batch.upper[slot * rows + r] = force[r];
    }
  }
}

template <class S>
void ask_for_gamma(WorldState<S>& world, Island<S>& island, typename S::Scalar time) {
  ++world.counts.evaluations;
  free_accelerations(world, island);
  for (const Segment<S>& segment : island.segments) {
    Batch<S>& batch = *segment.batch;
    if (batch.law && batch.law->force) find_known_forces(world, batch, segment.begin, segment.end);
    batch.ops->gamma(batch, segment.begin, segment.end, world.bodies, time, batch.bias.data());
    const int rows = batch.ops->rows;
    for (int i = segment.begin * rows; i < segment.end * rows; ++i) batch.bias[i] = -batch.bias[i];
  }
}

template <class S>
void accelerate(WorldState<S>& world, Island<S>& island, typename S::Scalar time) {
  ask_for_gamma(world, island, time);
  if (world.settings.solver == Solver::direct) return solve_for_forces(world, island);
  factorize_rows(world, island);
  std::swap(world.bodies.velocity, world.bodies.velocity_rate);
  solve_iterative(world, island, typename S::Scalar(1));
  std::swap(world.bodies.velocity, world.bodies.velocity_rate);
}

#define CDOT_INSTANTIATE(S)                                             \
  template void find_known_forces(WorldState<S>&, Batch<S>&, int, int); \
  template void ask_for_gamma(WorldState<S>&, Island<S>&, S::Scalar);   \
  template void accelerate(WorldState<S>&, Island<S>&, S::Scalar);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
