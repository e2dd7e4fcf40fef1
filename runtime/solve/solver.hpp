// The interface of the solvers of an island's rows; one file for each implementation. It does not depend on joints or
// integrators.
#pragma once

#include <array>

#include "runtime/state/world_data.hpp"

namespace cdot {

template <class S>
struct RowSolver {
  using T = typename S::Scalar;
  using Velocity = typename S::Velocity;

  // True: solves to round-off with the factor of the island's K. Island::factored tells if that is the factor of the
  // present J with all rows free. False: approximates by sweeps over the blocks.
  bool exact;

  // Call after a change of J: drops an old factor, or factors the blocks again.
  void (*renew)(WorldData<S>&, Island<S>&);
  // The same, and factors all rows at once.
  void (*factor)(WorldData<S>&, Island<S>&);
  // Adds impulses to v such that J v = -bias, within the bounds of rows under a law. With warm starting, sweeps start
  // from `share` of the present impulses.
  void (*velocities)(WorldData<S>&, Island<S>&, Velocity* v, T share);
  // The same for Drift::soft, before the poses move: exact rows count C as well.
  void (*soften)(WorldData<S>&, Island<S>&, SoftSweep<T>, T share);
  // Afterwards, with C and J of the new poses: goes on from the present impulses, without C.
  void (*relax)(WorldData<S>&, Island<S>&);
  // Adds forces to dv/dt such that J dv/dt = -bias in exact and held rows. Other rows have a known force: both bounds
  // are that number.
  void (*accelerations)(WorldData<S>&, Island<S>&);
  // Projects the poses onto C = 0 with the present factor or, if `fresh`, with J and K at the present poses. Writes the
  // moves to Bodies::displacement and the remaining C to Island::residual.
  void (*positions)(WorldData<S>&, Island<S>&, T time, bool fresh);
  // Projects the velocities onto J v = -bias after an evaluation of C and J, for exact and held rows. Sets
  // Island::factored if the factor of these rows is available.
  void (*projection)(WorldData<S>&, Island<S>&);
  // Makes lambda of exact rows the least impulses that push the bodies alike, so that redundant rows share their load.
  void (*share)(WorldData<S>&, Island<S>&);
};

template <class S>
const RowSolver<S>& direct_solver();
template <class S>
const RowSolver<S>& iterative_solver();

// In the order of `solvers`.
template <class S>
const RowSolver<S>& solver_of(Solver solver) {
  constexpr std::array all{&direct_solver<S>, &iterative_solver<S>};
  static_assert(all.size() == solvers.size());
  return all[static_cast<std::size_t>(solver)]();
}

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

}  // namespace cdot
