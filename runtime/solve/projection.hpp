// Projects an island onto C = 0 by Newton on the poses and onto J v = -dC/dt. The drift correction of first-order steps
// and the integrators at acceleration level share these functions.
#pragma once

#include <algorithm>

#include "runtime/state/world_data.hpp"

namespace cdot {

// True for a joint that rolls, slides on a knife edge, or is else written by velocities.
template <class S>
bool has_velocity_rows(const Batch<S>& batch) {
  return !batch.law && std::ranges::count(batch.kinds, RowKind::velocity) > 0;
}

template <class S>
bool rolls(const Island<S>& island) {
  return std::ranges::any_of(island.segments, [](const Segment<S>& s) { return has_velocity_rows(*s.batch); });
}

// Sets displacements and their impulses to 0.
template <class S>
void clear_correction(WorldData<S>& world, Island<S>& island);

// Writes the part of C to remove at the present poses to Batch::error. Returns the largest entry.
template <class S>
typename S::Scalar find_errors(WorldData<S>& world, Island<S>& island, typename S::Scalar time);

// Sets every row's impulse to `value`.
template <class S>
void fill_lambda(const Island<S>& island, typename S::Scalar value);
template <class S>
void scale_corrections(const Island<S>& island, typename S::Scalar by);
// Adds the displacements, times per_time, to the velocities and scales their impulses likewise.
template <class S>
void add_corrections(WorldData<S>& world, Island<S>& island, typename S::Scalar per_time);

// Evaluates C, J and the inertias at the present poses. Keeps w at acceleration level, otherwise the angular momentum.
template <class S>
void evaluate_anew(WorldData<S>& world, Island<S>& island, typename S::Scalar time);
// Restores dC/dt of evaluated rows in the bias, which a law has changed.
template <class S>
void restore_drift(WorldData<S>& world, const Island<S>& island, const Segment<S>& segment);

// Marks a step as failed if the displacement is far beyond `error` and beyond the motion of the step.
template <class S>
void fail_if_moved_far(const WorldData<S>& world, Island<S>& island, double error, double h);

// True if 2 |displacement| <= |h v| in the metric of the masses. A larger correction comes from a singular pose or from
// a step that is far too long.
template <class S>
bool correction_is_small(const WorldData<S>& world, const Island<S>& island, double h);

// Projects the velocities onto J v = -dC/dt after an evaluation of C and J, for exact and held rows. The direct solver
// then has the factor of these rows.
template <class S>
void project_velocities(WorldData<S>& world, Island<S>& island);

// The same at the start of a step. Where the number of a joint in time has a kink, as the length of a rod by a linear
// table, velocities jump, and its mover puts in what the bodies gain.
template <class S>
void project_velocities_at_start(WorldData<S>& world, Island<S>& island);

// With Drift::projection: project_start() projects the poses at the start of a step onto C = 0 if they are off.
// project_step() projects the poses and velocities at the end of a step of h.
template <class S>
void project_start(WorldData<S>& world, Island<S>& island, typename S::Scalar time);
template <class S>
void project_step(WorldData<S>& world, Island<S>& island, typename S::Scalar h);

}  // namespace cdot
