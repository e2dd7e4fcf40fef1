// Symplectic Euler, plain or linearly implicit: solves the velocities with the joints, advances the poses with the new
// velocities, corrects the drift.
#include <cdot/spaces.hpp>

#include "runtime/balance/balance.hpp"
#include "runtime/motion/motion.hpp"
#include "runtime/solve/projection.hpp"
#include "runtime/solve/solve.hpp"
#include "runtime/solve/solver.hpp"
#include "runtime/step/integrators.hpp"

namespace cdot {
namespace {

template <class S>
void move_velocities(WorldData<S>& world, Island<S>& island, typename S::Scalar h, double last_step) {
  using T = typename S::Scalar;
  evaluate_rows(world, island, h);
  apply_forces(world, island, h);
  // Warm start: the same forces over another time.
  const T share = last_step > 0 ? h / T(last_step) : T(0);
  // The last projection's part of the joints' forces turns the velocities.
  island.corrections_in_loads = world.settings.drift == Drift::projection ? share : T(0);
  island.solver->velocities(world, island, world.bodies.velocity.data(), share);
  island.corrections_in_loads = 0;
}

// The linearly implicit step needs the last step's impulses. The first step takes those of a plain step.
template <class S>
void rehearse(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  Bodies<S>& all = world.bodies;
  std::vector<typename S::Velocity>& start = island.flow.velocity;
  for (size_t k = 0; k < start.size(); ++k) start[k] = all.velocity[island.bodies[k]];
  move_velocities(world, island, h, 0);
  for (size_t k = 0; k < start.size(); ++k) all.velocity[island.bodies[k]] = start[k];
  island.evaluated = island.factored = false;
}

}  // namespace

template <class S>
void step_euler(WorldData<S>& world, Island<S>& island, typename S::Scalar h, double last_step) {
  if (world.settings.drift == Drift::soft) return step_soft(world, island, h, last_step);
  project_start(world, island);
  begin_kick(world, island);
  if (island.stiffened) {
    if (last_step == 0) rehearse(world, island, h);
    stiffen_bodies(world, island, h, last_step);
  }
  move_velocities(world, island, h, last_step);
  book_kick(world, island, Impulses::euler, h);
  integrate(world, island, h);
  if (island.driven) begin_kick(world, island);
  project_step(world, island, h);
  book_kick(world, island, Impulses::drift, h);
  book_stiffness(world, island);
  island.at_work().slacken();  // tension rows act only within the step
}

template <class S>
void prepare_euler(Island<S>& island) {
  island.flow.pose.resize(island.bodies.size());
  island.flow.velocity.resize(island.bodies.size());
  prepare_turns(island);
}

#define CDOT_INSTANTIATE(S)                                               \
  template void step_euler(WorldData<S>&, Island<S>&, S::Scalar, double); \
  template void prepare_euler(Island<S>&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
