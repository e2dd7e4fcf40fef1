// Drift::projection: Newton on C with the J and K of the step (SHAKE), the displacement over h
// added to the velocities and these projected onto J v = -dC/dt at the new poses. Moving the poses
// alone would drain energy at first order: every step turns the velocity out of the tangent plane,
// and what the next solve cuts off is gone.
#include <algorithm>
#include <cmath>

#include <cdot/spaces.hpp>

#include "runtime/solve/projection.hpp"
#include "runtime/solve/solve.hpp"

namespace cdot {

template <class S>
void settle_poses(WorldState<S>& world, Island<S>& island) {
  using T = typename S::Scalar;
  if (world.settings.drift != Drift::projection || island.segments.empty()) return;
  if (!(island.residual > foreign<T> * island.scale)) return;
  clear_correction(world, island);
  hold_poses(world, island, T(world.time), true);
  island.evaluated = island.factored = false;
}

template <class S>
void correct_drift(WorldState<S>& world, Island<S>& island, typename S::Scalar h) {
  using T = typename S::Scalar;
  if (world.settings.drift != Drift::projection || island.segments.empty()) return;
  const T time = T(world.time) + h;
  clear_correction(world, island);
  // What the start of the step could not correct (joints that contradict each other, too few
  // sweeps) is not motion.
  const T foreign_error = island.residual, error = find_errors(world, island, time);
  const bool from_motion = foreign_error <= T(0.1) * error;
  hold_poses(world, island, time, false);
  // Otherwise it would be thrown in as energy.
  const bool keep = from_motion && bends_the_path(world, island, double(h));
  const bool was_apart = foreign_error > foreign<T> && std::isfinite(foreign_error);
  if (!was_apart) tell_joints_apart(world, island, foreign_error);
  else if (!keep && island.residual > T(2) * std::max(error, foreign_error)) island.trouble = StepProblem::joints_apart;
  add_corrections(world, island, keep ? T(1) / h : T(0));
  evaluate_anew(world, island, time);
  hold_velocities(world, island);
  island.evaluated = true;
  island.factored = world.settings.solver == Solver::direct && !island.system.lawful();
}

#define CDOT_INSTANTIATE(S)                               \
  template void settle_poses(WorldState<S>&, Island<S>&); \
  template void correct_drift(WorldState<S>&, Island<S>&, S::Scalar);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
