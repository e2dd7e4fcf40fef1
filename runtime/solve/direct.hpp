// The steps that every use of an island's factor is made of, from J v to the bodies:
//
//   load_rates or load_errors, assemble, factor, solve, store, exert
//
// Inline: to a small island a call would cost as much as what it does.
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

// b = share * the errors that find_errors() left.
template <class S>
[[gnu::always_inline]] inline void load_errors(System<S>& system, typename S::Scalar share) {
  system.load([share](const Batch<S>& batch, int i) { return share * batch.error[i]; });
}

// to += M^-1 J^T x, x being an array of the batches; what tension adds to the rows is part of it.
template <class S, class Array>
[[gnu::always_inline]] inline void exert(const WorldData<S>& world, const Island<S>& island, const System<S>& system,
                                         Array x, typename S::Velocity* to) {
  for (const Segment<S>& segment : island.segments)
    segment.batch->ops->apply(*segment.batch, segment.begin, segment.end, world.bodies, (segment.batch->*x).data(), to);
  system.pull(world.bodies, to);
}

// Takes rows out of the system that have nothing to correct, and factors the rest.
template <class S>
void factor_rows_with_errors(System<S>& system);

// The solution becomes the batches' impulse of this round of a projection, is added to their correction, and acts on
// `to`.
template <class S>
void exert_correction(const WorldData<S>& world, const Island<S>& island, System<S>& system, typename S::Velocity* to);

}  // namespace cdot
