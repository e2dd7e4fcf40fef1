// Keeping an island on C = 0 and J v = -dC/dt: Newton on the poses, a projection of the velocities. Shared by the drift
// correction of first-order steps and by the integrators that work with accelerations.
#pragma once

#include "runtime/state/world_data.hpp"

namespace cdot {

// C this small is left alone, in metres and radians, times Island::scale.
template <class T>
inline constexpr T converged = T(by_precision<T>(1e-6, 1e-13));

// C of this size came from outside (a pose that was set, joints that contradict each other), not from the motion of the
// last step: correcting it must not change velocities. Times Island::scale.
template <class T>
inline constexpr T foreign = T(by_precision<T>(1e-4, 1e-8));

// Displacements and their impulses start at 0.
template <class S>
void clear_correction(WorldData<S>& world, Island<S>& island);

// What of C is to be removed at the present poses, into Batch::error. Returns its largest entry.
template <class S>
typename S::Scalar find_errors(WorldData<S>& world, Island<S>& island, typename S::Scalar time);

// Every row's impulse becomes `value`.
template <class S>
void fill_lambda(const Island<S>& island, typename S::Scalar value);
template <class S>
void scale_corrections(const Island<S>& island, typename S::Scalar by);
// Displacements and their impulses become those of velocities.
template <class S>
void add_corrections(WorldData<S>& world, Island<S>& island, typename S::Scalar per_time);

// C and J at the present poses, and the inertias there: of an island in continuous time with w as it is, of others with
// the angular momentum as it is.
template <class S>
void evaluate_anew(WorldData<S>& world, Island<S>& island, typename S::Scalar time);

// The poses were not brought onto the joints, where those of the start of the step were, but for `at_start`: a step too
// far for Newton, or beyond their reach. Of sweeps, which leave what they leave, nothing is said.
template <class S>
bool left_the_joints(const WorldData<S>& world, const Island<S>& island, typename S::Scalar at_start);
// Such a step has failed, where no shorter one takes its place; unless what is left is what the last solve had to
// leave: joints that contradict each other share it.
template <class S>
void fail_if_open(const WorldData<S>& world, Island<S>& island, typename S::Scalar at_start);

// The correction is small beside the motion: 2 |displacement| <= |h v| in the metric of the
// masses. More than that comes of a passage through a singular pose, or of a step far too large.
template <class S>
bool correction_is_small(const WorldData<S>& world, const Island<S>& island, double h);

// Velocities onto J v = -dC/dt, where C and J were just evaluated: exact rows and those that are held. The direct
// solver then has their factor.
template <class S>
void project_velocities(WorldData<S>& world, Island<S>& island);

// Only for Drift::projection: a start that is off C = 0 onto it, where a step of h begins; and its end, the velocities
// with it.
template <class S>
void project_start(WorldData<S>& world, Island<S>& island);
template <class S>
void project_step(WorldData<S>& world, Island<S>& island, typename S::Scalar h);

}  // namespace cdot
