// Keeping an island on C = 0 and J v = -dC/dt: Newton on the poses, a projection of the velocities. Shared by the drift
// correction of first-order steps and by the integrators that work with accelerations.
#pragma once

#include "runtime/state/world_state.hpp"

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
void clear_correction(WorldState<S>& world, Island<S>& island);

// What of C is to be removed at the present poses, into the batches' scratch. Returns its largest entry.
template <class S>
typename S::Scalar find_errors(WorldState<S>& world, Island<S>& island, typename S::Scalar time);

// K lambda = share * the errors just found, with the factor at hand: into System::lambda.
template <class S>
void solve_errors(Island<S>& island, typename S::Scalar share);
// `to` += M^-1 J^T lambda.
template <class S>
void apply_solution(WorldState<S>& world, Island<S>& island, typename S::Velocity* to);

// Every row's impulse becomes `value`.
template <class S>
void fill_lambda(const Island<S>& island, typename S::Scalar value);
template <class S>
void scale_corrections(const Island<S>& island, typename S::Scalar by);
// Displacements and their impulses become those of velocities.
template <class S>
void add_corrections(WorldState<S>& world, Island<S>& island, typename S::Scalar per_time);

// C and J at the present poses, and the inertias there: of an island in continuous time with w as it is, of others with
// the angular momentum as it is.
template <class S>
void evaluate_anew(WorldState<S>& world, Island<S>& island, typename S::Scalar time);

// Moves the poses onto C = 0: with the factor at hand, or, if `fresh`, with J and K at the present poses; by the solver
// of the settings. Leaves the moves in Bodies::displacement, the rest of C in Island::residual.
template <class S>
void hold_poses(WorldState<S>& world, Island<S>& island, typename S::Scalar time, bool fresh);

// The poses were not brought onto the joints, where those of the start of the step were, but for `at_start`: a step too
// far for Newton, or beyond their reach. Of sweeps, which leave what they leave, nothing is said.
template <class S>
bool left_the_joints(const WorldState<S>& world, const Island<S>& island, typename S::Scalar at_start);
// Such a step has failed, where no shorter one takes its place; unless what is left is what the last solve had to
// leave: joints that contradict each other share it.
template <class S>
void tell_joints_apart(const WorldState<S>& world, Island<S>& island, typename S::Scalar at_start);

// What bends a path back onto its curve is a small part of the way: 2 |displacement| <= |h v| in the metric of the
// masses. More than that comes of a passage through a singular pose, or of a step far too large.
template <class S>
bool bends_the_path(const WorldState<S>& world, const Island<S>& island, double h);

// Velocities onto J v = -dC/dt, where C and J were just evaluated: exact rows and those that are held. The direct
// solver then has their factor.
template <class S>
void hold_velocities(WorldState<S>& world, Island<S>& island);

}  // namespace cdot
