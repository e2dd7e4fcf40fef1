// Symplectic Euler, plain or linearly implicit: solves the velocities with the joints, advances the poses with the new
// velocities, corrects the drift. A step by sweeps that its bodies cannot pay for (sweeps/gain.hpp) starts without
// impulses and then does without the correction, with slower bodies.
#include <algorithm>
#include <array>
#include <cmath>

#include <cdot/spaces.hpp>

#include "runtime/balance/balance.hpp"
#include "runtime/motion/momentum.hpp"
#include "runtime/motion/motion.hpp"
#include "runtime/solve/projection.hpp"
#include "runtime/solve/solve.hpp"
#include "runtime/solve/solver.hpp"
#include "runtime/step/integrators.hpp"
#include "runtime/step/kick_drift.hpp"
#include "runtime/sweeps/gain.hpp"
#include "runtime/sweeps/soft.hpp"

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

// How a step is tried.
struct Try {
  double last_step;  // [s] of the present impulses; 0: sweeps start without impulses
  double speed = 1;  // of the bodies against each other while the poses move, as a share
};

// Poses of the start in Flow::pose. The stiffness of tension holds back the rotation of a free island as well, and
// gives it back.
template <class S>
void advance(WorldData<S>& world, Island<S>& island, typename S::Scalar h, const Try& by) {
  const bool held_back = island.stiffened && island.floats;
  const auto momentum = held_back ? momentum_of(world, island) : MomentumOf<S>{};
  project_start(world, island, typename S::Scalar(world.time));
  begin_kick(world, island);
  if (island.stiffened) {
    if (by.last_step == 0) rehearse(world, island, h);
    stiffen_bodies(world, island, h, by.last_step);
  }
  move_velocities(world, island, h, by.last_step);
  book_kick(world, island, Impulses::euler, h);
  if (by.speed < 1) move_slowly(world, island, h, by.speed);
  else integrate(world, island, h);
  project_step(world, island, h);
  book_kick(world, island, Impulses::drift, h);
  if (held_back) restore_momentum(world, island, momentum, h);
}

// A spring by frequency stores energy by the masses without their stiffness.
template <class S>
void relieve(WorldData<S>& world, Island<S>& island) {
  if (!island.stiffened) return;
  restore_masses(world, island);
  island.factored = false;
}

// False if the energy rises; then the state is to be restored.
template <class S>
bool try_step(WorldData<S>& world, Island<S>& island, typename S::Scalar h, const Try& by) {
  const double at_start = stored_at_start(world, island);
  advance(world, island, h, by);
  relieve(world, island);
  if (!island.evaluated) evaluate_anew(world, island, typename S::Scalar(world.time) + h);
  island.evaluated = true;
  book_stiffness(world, island);
  return take_gain(world, island, double(h), stored(world, island) - at_start);
}

// Sweeps that correct no drift and start without impulses only take energy, the more the slower bodies move into
// springs.
template <class S>
bool try_without_correction(WorldData<S>& world, Island<S>& island, typename S::Scalar h, const Start& start) {
  const Drift drift = world.settings.drift;
  world.settings.drift = Drift::none;
  const bool paid = std::ranges::any_of(std::array{1., 1. / 4, 1. / 16, 1. / 64}, [&](double speed) {
    go_back(world, island, start);
    return try_step(world, island, h, {.last_step = 0, .speed = speed});
  });
  world.settings.drift = drift;
  return paid;
}

template <class S>
void step_gently(WorldData<S>& world, Island<S>& island, typename S::Scalar h, const Start& start) {
  go_back(world, island, start);
  if (try_step(world, island, h, {.last_step = 0})) return;
  if (!try_without_correction(world, island, h, start)) stand(world, island, h, start);
  // C alone is rounded otherwise, by radians near a pose without direction: it may count another turn.
  keep_turns(island);
  island.residual = find_errors(world, island, typename S::Scalar(world.time) + h);
  restore_turns(island);
  island.evaluated = false;
}

template <class S>
void step_by_sweeps(WorldData<S>& world, Island<S>& island, typename S::Scalar h, double last_step) {
  open_level(world, island, h, last_step);
  const Start start = keep_start(world, island);
  const bool paid = try_step(world, island, h, {last_step});
  if (!paid && std::isfinite(start.level) && finite(world, island)) step_gently(world, island, h, start);
}

}  // namespace

template <class S>
void step_euler(WorldData<S>& world, Island<S>& island, typename S::Scalar h, double last_step) {
  if (world.settings.drift == Drift::soft) return step_soft(world, island, h, last_step);
  if (sweeps(world.settings.solver)) step_by_sweeps(world, island, h, last_step);
  else {
    if (island.stiffened) note_start(world, island);
    advance(world, island, h, {last_step});
    relieve(world, island);
    book_stiffness(world, island);
  }
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
