// Sequential impulses: each block brings its own rows to J v = -bias, or to C = 0, in turn, again and again.
#include <algorithm>
#include <cmath>
#include <limits>

#include <cdot/spaces.hpp>

#include "runtime/solve/projection.hpp"
#include "runtime/solve/solve.hpp"
#include "runtime/solve/solver.hpp"

namespace cdot {
namespace {

template <class S>
void renew(WorldData<S>& world, Island<S>& island) {
  island.factored = false;
  factorize_rows(world, island);
}

template <class S>
void sweep_velocities(WorldData<S>& world, Island<S>& island, typename S::Velocity* v, typename S::Scalar share) {
  using T = typename S::Scalar;
  const bool warm = world.settings.warm_start;
  if (!warm) share = 0;
  for (const Segment<S>& segment : island.segments) {
    Batch<S>& batch = *segment.batch;
    const int rows = batch.ops->rows;
    T* const lambda = batch.lambda.data();
    for (int i = segment.begin * rows; i < segment.end * rows; ++i) lambda[i] *= share;
    if (warm) batch.ops->apply(batch, segment.begin, segment.end, world.bodies, batch.lambda.data(), v);
  }
  for (int sweep = 0; sweep < world.settings.iterations; ++sweep) {
    for (const Segment<S>& segment : island.segments) {
      Batch<S>& batch = *segment.batch;
      if (batch.law) batch.ops->iterate_bounded(batch, segment.begin, segment.end, world.bodies, v);
      else batch.ops->iterate(batch, segment.begin, segment.end, world.bodies, v, batch.lambda.data());
    }
  }
}

template <class S>
void sweep_accelerations(WorldData<S>& world, Island<S>& island) {
  factorize_rows(world, island);
  sweep_velocities(world, island, world.bodies.velocity_rate.data(), typename S::Scalar(1));
}

// The largest error that a sweep met on its way.
template <class S>
typename S::Scalar errors_met(const Island<S>& island) {
  typename S::Scalar worst = 0;
  for (const Segment<S>& segment : island.segments) {
    const Batch<S>& batch = *segment.batch;
    if (batch.law) continue;
    const int rows = batch.ops->rows;
    for (int i = segment.begin * rows; i < segment.end * rows; ++i) worst = std::max(worst, std::abs(batch.C[i]));
  }
  return worst;
}

// In continuous time only where a row is held: one that is out of reach must be seen to pass.
template <class S>
void sweep_lawful_poses(WorldData<S>& world, const Island<S>& island, const Segment<S>& segment,
                        typename S::Scalar time) {
  Batch<S>& batch = *segment.batch;
  if (!batch.law->error) return;
  if (!island.continuous) return batch.ops->correct_bounded(batch, segment.begin, segment.end, world.bodies, time);
  for (int slot = segment.begin; slot < segment.end; ++slot) {
    const auto mode = batch.mode.begin() + slot * batch.ops->rows;
    if (std::find(mode, mode + batch.ops->rows, Mode::held) != mode + batch.ops->rows)
      batch.ops->correct_bounded(batch, slot, slot + 1, world.bodies, time);
  }
}

// Where a sweep meets larger errors than the one before, the directions of the step's J mislead: they are renewed.
template <class S>
void sweep_positions(WorldData<S>& world, Island<S>& island, typename S::Scalar time, bool fresh) {
  using T = typename S::Scalar;
  const auto renew_directions = [&] {
    evaluate_anew(world, island, time);
    factorize_rows(world, island);
  };
  if (fresh) renew_directions();
  T first = std::numeric_limits<T>::infinity();
  for (int sweep = 0; sweep < world.settings.iterations; ++sweep) {
    for (const Segment<S>& segment : island.segments) {
      Batch<S>& batch = *segment.batch;
      if (!batch.law) batch.ops->correct(batch, segment.begin, segment.end, world.bodies, time);
      else sweep_lawful_poses(world, island, segment, time);
    }
    const T met = errors_met(island);
    if (sweep == 0) first = met;
    if (met > T(2) * first) {
      renew_directions();
      first = met;
    }
  }
  island.residual = find_errors(world, island, time);
}

// Rows that are not held keep the impulse that they have.
template <class S>
void bound_for_projection(const Island<S>& island) {
  using T = typename S::Scalar;
  for (const Segment<S>& segment : island.segments) {
    Batch<S>& batch = *segment.batch;
    if (!batch.law) continue;
    for (int i = segment.begin * batch.ops->rows; i < segment.end * batch.ops->rows; ++i) {
      const bool held = batch.mode[i] == Mode::held;
      batch.softness[i] = 0;
      batch.lower[i] = held ? -std::numeric_limits<T>::infinity() : batch.lambda[i];
      batch.upper[i] = held ? std::numeric_limits<T>::infinity() : batch.lambda[i];
    }
  }
}

template <class S>
void sweep_projection(WorldData<S>& world, Island<S>& island) {
  renew(world, island);
  auto* const v = world.bodies.velocity.data();
  if (island.continuous) bound_for_projection(island);
  for (int sweep = 0; sweep < world.settings.iterations; ++sweep) {
    for (const Segment<S>& segment : island.segments) {
      Batch<S>& batch = *segment.batch;
      if (!batch.law) batch.ops->iterate(batch, segment.begin, segment.end, world.bodies, v, batch.correction.data());
      else if (island.continuous) batch.ops->iterate_bounded(batch, segment.begin, segment.end, world.bodies, v);
    }
  }
}

}  // namespace

template <class S>
const RowSolver<S>& iterative_solver() {
  static constexpr RowSolver<S> solver{.exact = false,
                                       .renew = renew<S>,
                                       .factor = renew<S>,
                                       .velocities = sweep_velocities<S>,
                                       .accelerations = sweep_accelerations<S>,
                                       .positions = sweep_positions<S>,
                                       .projection = sweep_projection<S>};
  return solver;
}

#define CDOT_INSTANTIATE(S) template const RowSolver<S>& iterative_solver();
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
