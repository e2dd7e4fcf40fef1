// Symplectic Euler, plain or linearly implicit: velocities first, with whatever holds the joints, then the poses with
// the new ones, then the drift.
#include <cdot/spaces.hpp>

#include "runtime/motion/motion.hpp"
#include "runtime/solve/solve.hpp"
#include "runtime/step/integrators.hpp"

namespace cdot {
namespace {

template <class S>
void move_velocities(WorldState<S>& world, Island<S>& island, typename S::Scalar h) {
  evaluate_rows(world, island, h);
  apply_forces(world, island, h);
  if (world.settings.solver == Solver::direct) solve_direct(world, island);
  else  // the same forces over another time
    solve_iterative(world, island, world.last_step > 0 ? h / typename S::Scalar(world.last_step) : 0);
}

// The linearly implicit step wants the impulses of the one before. The first one takes those that it would have
// without.
template <class S>
void rehearse(WorldState<S>& world, Island<S>& island, typename S::Scalar h) {
  Bodies<S>& all = world.bodies;
  for (int i : island.bodies) all.velocity_rate[i] = all.velocity[i];
  move_velocities(world, island, h);
  for (int i : island.bodies) all.velocity[i] = all.velocity_rate[i];
  island.evaluated = island.factored = false;
}

}  // namespace

template <class S>
void step_euler(WorldState<S>& world, Island<S>& island, typename S::Scalar h) {
  settle_poses(world, island);
  if (world.settings.integrator == Integrator::implicit) {
    if (world.last_step == 0) rehearse(world, island, h);
    stiffen_bodies(world, island, h);
  }
  move_velocities(world, island, h);
  integrate(world, island, h);
  correct_drift(world, island, h);
  island.system.slacken();  // what follows between steps is no motion of this one
}

#define CDOT_INSTANTIATE(S) template void step_euler(WorldState<S>&, Island<S>&, S::Scalar);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
