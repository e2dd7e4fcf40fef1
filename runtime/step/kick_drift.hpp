// Stages that RATTLE and the implicit midpoint rule share: their steps are kicks by impulses and drifts by velocities.
#pragma once

#include "runtime/events/guarded.hpp"
#include "runtime/solve/misfits.hpp"
#include "runtime/solve/solver.hpp"
#include "runtime/state/world_data.hpp"

namespace cdot {

// True if it has velocity rows, motors or friction, whose impulses of the end act once more at the start of the next
// step, or ends that share loads.
template <class S>
bool repeats_impulses(const Island<S>& island);

// Prepares the start of a step of h. A state that is not the end of a step is projected, and its exact rows are
// factored. Returns the factor that scales the present impulses to this step: h / last step, for sweeps at most 1.
// Flow::motors_struck: motors of unlimited force reach their rates at the start by a blow that loads friction.
template <class S>
typename S::Scalar begin_kick_drift(WorldData<S>& world, Island<S>& island, typename S::Scalar h);

// Keeps poses and velocities in Flow::pose and Flow::velocity.
template <class S>
void note_start(const WorldData<S>& world, Island<S>& island);

// poses = noted start + h velocity; bodies with a turning inertia tensor rotate by their mean spin.
template <class S>
void drift(WorldData<S>& world, Island<S>& island, typename S::Scalar h);

// The same. Leaves J v of all rows in Batch::rate, with the present J and the mean velocity v of the drift.
template <class S>
void drift_with_rates(WorldData<S>& world, Island<S>& island, typename S::Scalar h);

// The impulses by which loads grow the friction of the end: those of the whole step, of which the other half acts at
// the start of the next one; all of them there, after an end was struck; those of the end alone, after a blow of motors
// at the start has taken its friction.
enum class EndLoads : char { half, whole, of_end };

// The velocities at the end of a step of h, after an evaluation of C and J: J v = -dC/dt. Motors, limits and friction
// act with half of their impulse; the other half acts at the start of the next step. Springs have acted as forces.
template <class S>
void solve_end(WorldData<S>& world, Island<S>& island, typename S::Scalar h, EndLoads loads);

// Where a loaded row alone sticks, the impulses s and e of both halves of a step are what stops it, s + e = P. If the
// next step began with s' = e, an error of s would change its sign in each step and never fade, and others that it
// moves let it grow. With s' = e - theta (e - s) the error is multiplied by 2 theta - 1; s lags by theta h / (2 - 2
// theta), which moves a body by an error of order h^3 in a step. A row that slips has its bound, and repeats e: there
// the lag would sum up. Nor does a row that has just stopped: the next step must not repeat a part of its s.
template <class S>
void calm_sticking_rows(Island<S>& island);

// A clutch that drives one way may take back at the end of a step what it gave at the start. One that holds repeats
// half of its impulse over the last step, if it held before; one that slips repeats its bound; one that lets go repeats
// nothing. Where one has just met or stopped, or a motor or friction that acts both ways has just reached its rate, the
// next step finds the forces at its start anew: settle_clutches() is true then. Call it after a direct solver.
// Batch::mode keeps which ones hold.
template <class S>
bool settle_clutches(Island<S>& island);

// True if the row repeats its impulse at the start of the next step. By sweeps a clutch that drives one way does not.
template <class S>
bool acts_at_start(const Island<S>& island, const Batch<S>& batch, int i) {
  if (island.solver->exact || !batch.law || batch.law->error || batch.law->by_load) return true;
  return batch.lower[i] != 0 && batch.upper[i] != 0;
}

// True for a pin, or an end that is met, which presses at the start of a step and repeats its impulse: where loads are
// shared among redundant rows. Else the drift finds it.
template <class S>
bool holds_at_start(const Island<S>& island, const Batch<S>& batch, int i) {
  if (!has_ends(batch) || batch.mode[i] != Mode::gripped) return false;
  const auto guard = guard_of(batch, i);
  return guard.bilateral() || (guard.one_sided() && !(guard.gap() > foreign<typename S::Scalar> * island.scale));
}

}  // namespace cdot
