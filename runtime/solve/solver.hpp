// The solvers of an island's rows, as integrators see them: one interface, a file for each that implements it. Nothing
// here knows of joints or of an integrator.
#pragma once

#include "runtime/state/world_data.hpp"

namespace cdot {

template <class S>
struct RowSolver {
  using T = typename S::Scalar;
  using Velocity = typename S::Velocity;

  // To round-off, by the factor of the island's K: Island::factored says whether that is of the present J, with all
  // rows free. Otherwise by sweeps over the blocks, to what the sweeps leave.
  bool exact;

  // J has changed: an old factor is forgotten, or the blocks get theirs anew.
  void (*renew)(WorldData<S>&, Island<S>&);
  // The same at once, for whoever begins with the factor of all rows.
  void (*factor)(WorldData<S>&, Island<S>&);
  // Adds impulses to v such that J v = -bias, within the bounds of rows under a law. Sweeps start from `share` of the
  // impulses at hand, unless warm starting is off.
  void (*velocities)(WorldData<S>&, Island<S>&, Velocity* v, T share);
  // Adds forces to dv/dt such that J dv/dt = -bias, in rows under a law that are held; the others have the force
  // between their bounds, which are one number.
  void (*accelerations)(WorldData<S>&, Island<S>&);
  // Moves the poses onto C = 0: with the factor at hand, or, if `fresh`, with J and K at the present poses. Leaves the
  // moves in Bodies::displacement, the rest of C in Island::residual.
  void (*positions)(WorldData<S>&, Island<S>&, T time, bool fresh);
  // Projects the velocities onto J v = -bias, where C and J were just evaluated: exact rows and those that are held.
  // Afterwards Island::factored says whether the factor of these rows is at hand.
  void (*projection)(WorldData<S>&, Island<S>&);
};

template <class S>
const RowSolver<S>& direct_solver();
template <class S>
const RowSolver<S>& iterative_solver();

template <class S>
const RowSolver<S>& solver_of(Solver solver) {
  return sweeps(solver) ? iterative_solver<S>() : direct_solver<S>();
}

}  // namespace cdot
