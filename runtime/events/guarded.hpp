// Walks over the guarded rows of an island: rows under a law that has events between which they keep a mode.
#pragma once

#include <algorithm>

#include "runtime/solve/direct.hpp"
#include "runtime/solve/solve.hpp"
#include "runtime/solve/solver.hpp"
#include "runtime/state/world_data.hpp"

namespace cdot {

// Relative resolution: below this share of their terms, C, its rate and its force count as 0.
template <class T>
inline constexpr T slight = T(by_precision<T>(1e-4, 1e-9));

// The threshold for an event that was passed. In units of the resolution, relative to the margin at the choice of the
// mode: a row that creeps may have chosen its mode many steps ago.
inline constexpr double passed = -1;

// The same for the k-th of Flow::margins.
template <class S>
double event_threshold(const Flow<S>& flow, size_t k) {
  return std::min(double(flow.margins_chosen[k]), 0.0) + passed;
}

// f(batch, slot) for all slots with guarded rows, in the order of Flow::margins.
template <class S, class F>
void each_guarded_slot(const Island<S>& island, F f) {
  for (const Segment<S>& segment : island.segments) {
    if (!segment.batch->law || !segment.batch->law->guard) continue;
    for (int slot = segment.begin; slot < segment.end; ++slot) f(*segment.batch, slot);
  }
}

// f(batch, index, guard, resolution) for every guarded row, with guards at the present C.
template <class S, class F>
void each_guarded_row(Island<S>& island, F f) {
  Guard<typename S::Scalar> guards[most_rows];
  auto resolution = island.flow.resolution.begin();
  each_guarded_slot(island, [&](Batch<S>& batch, int slot) {
    batch.law->guard(batch, slot, guards);
    for (int r = 0; r < batch.ops->rows; ++r) f(batch, slot * batch.ops->rows + r, guards[r], *resolution++);
  });
}

// At the present C.
template <class S>
Guard<typename S::Scalar> guard_of(const Batch<S>& batch, int i) {
  Guard<typename S::Scalar> guards[most_rows];
  batch.law->guard(batch, i / batch.ops->rows, guards);
  return guards[i % batch.ops->rows];
}

template <class S>
bool has_unlimited_motor(const Island<S>& island) {
  bool motor = false;
  Guard<typename S::Scalar> guards[most_rows];
  each_guarded_slot(island, [&](const Batch<S>& batch, int slot) {
    batch.law->guard(batch, slot, guards);
    for (int r = 0; r < batch.ops->rows; ++r) motor |= guards[r].of_rate && guards[r].bilateral();
  });
  return motor;
}

// The motor may drive its bodies against the ends.
template <class S>
bool has_unlimited_motor_beside_ends(const Island<S>& island) {
  bool ends = false;
  each_guarded_slot(island, [&](const Batch<S>& batch, int) { ends |= batch.law->error != nullptr; });
  return ends && has_unlimited_motor(island);
}

// J v of every row under a law, into Batch::rate.
template <class S>
void find_rates(WorldData<S>& world, Island<S>& island) {
  for (const Segment<S>& segment : island.segments) {
    if (!segment.batch->law) continue;
    const auto* velocity = world.bodies.velocity.data();
    segment.batch->ops->velocity(*segment.batch, segment.begin, segment.end, velocity, segment.batch->rate.data());
  }
}

// The rest of its prescribed rate that a row lacks, after find_rates().
template <class S>
typename S::Scalar missing_of(const Batch<S>& batch, int i, const Guard<typename S::Scalar>& guard) {
  return guard.rate - (batch.rate[i] + batch.bias[i]);
}

// No bounds, no softness, no load: before new ones are offered.
template <class S>
void clear_laws(Island<S>& island) {
  for (const Segment<S>& segment : island.segments) {
    Batch<S>& batch = *segment.batch;
    if (!batch.law) continue;
    for (int i = segment.begin * batch.ops->rows; i < segment.end * batch.ops->rows; ++i)
      batch.softness[i] = batch.lower[i] = batch.upper[i] = 0;
    std::fill(batch.load.begin() + segment.begin, batch.load.begin() + segment.end, typename S::Scalar(0));
  }
}

// v (velocities or accelerations) such that J v = -bias within the bounds.
template <class S>
void solve(WorldData<S>& world, Island<S>& island, typename S::Velocity* v) {
  island.solver->renew(world, island);
  island.solver->velocities(world, island, v, typename S::Scalar(0));
}

}  // namespace cdot
