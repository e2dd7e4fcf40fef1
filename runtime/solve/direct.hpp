// The stages of every solve with an island's factor, from J v to the bodies:
//
//   load_rates or load_errors, assemble, factor, solve, store, exert
//
// Inline, because in a small island the call would cost as much as the work.
#pragma once

#include "runtime/state/world_data.hpp"

namespace cdot {

// b = -(J v + bias)
template <class S>
[[gnu::always_inline]] inline void load_rates(const Island<S>& island, System<S>& system,
                                              const typename S::Velocity* v) {
  for (const Segment<S>& segment : island.segments)
    segment.batch->ops->velocity(*segment.batch, segment.begin, segment.end, v, segment.batch->rate.data());
  system.load([](const Batch<S>& batch, int i) { return -(batch.rate[i] + batch.bias[i]); });
}

// True if rows of the batch act from ends on: limits, ropes and other bounds of C.
template <class S>
bool has_ends(const Batch<S>& batch) {
  return batch.law && batch.law->error && batch.law->guard;
}

// b = share * the errors from find_errors().
template <class S>
[[gnu::always_inline]] inline void load_errors(System<S>& system, typename S::Scalar share) {
  system.load([share](const Batch<S>& batch, int i) { return share * batch.error[i]; });
}

// to += M^-1 J^T x, where x is an array of the batches, plus the impulse of tension rows.
template <class S, class Array>
[[gnu::always_inline]] inline void exert(const WorldData<S>& world, const Island<S>& island, const System<S>& system,
                                         Array x, typename S::Velocity* to) {
  for (const Segment<S>& segment : island.segments)
    segment.batch->ops->apply(*segment.batch, segment.begin, segment.end, world.bodies, (segment.batch->*x).data(), to);
  system.pull(world.bodies, to);
}

// The rows under laws, within the bounds that they have now.
template <class S>
[[gnu::always_inline]] inline void solve_bounded(WorldData<S>& world, Island<S>& island, System<S>& system) {
  island.redundant_rows = system.solve_bounded();
  if (!island.acceleration_level) world.solves += system.rounds();
}

// Selects the rows that have an error to correct and factors them, unless the last factor is `kept`, that of the same
// K, and of the same rows. Velocity rows have no error: they take part if the correction is to change no rate of
// theirs.
enum class Rates : char { free, kept };
enum class Factor : char { anew, kept };
template <class S>
void factor_rows_with_errors(System<S>& system, Rates rates, Factor last);

// Stores the solution as the batches' impulse of this projection round, adds it to their correction and applies it to
// `to`.
template <class S>
void exert_correction(const WorldData<S>& world, const Island<S>& island, System<S>& system, typename S::Velocity* to);

}  // namespace cdot
