// The rest of C after a projection, row by row: round-off, or the misfits of joints that contradict each other.
#pragma once

#include "runtime/state/world_data.hpp"

namespace cdot {

// A smaller C needs no correction; times Island::scale, in [m] and [rad].
template <class T>
inline constexpr T converged = T(by_precision<T>(1e-6, 1e-13));

// A larger C at the start of a step is not due to motion but to a set pose or to contradicting joints. Its correction
// must not change velocities. Times Island::scale.
template <class T>
inline constexpr T foreign = T(by_precision<T>(1e-4, 1e-8));

// An estimate of the largest round-off in C from the size of the poses.
template <class S>
typename S::Scalar round_off_of(const WorldData<S>& world, const Island<S>& island);

// True if the last projection left round-off in each row, or errors that need no correction. By J as it was last
// evaluated, as the next two.
template <class S>
bool left_round_off(const WorldData<S>& world, const Island<S>& island);
// True if it left a row that misses more than round-off and a share `foreign` of its reach: joints that misfit.
template <class S>
bool left_misfits(const WorldData<S>& world, const Island<S>& island);

// Notes Batch::error as that which a projection leaves: Island::left. reserve_errors() allocates for it.
template <class S>
void note_errors(Island<S>& island);
template <class S>
void reserve_errors(Island<S>& island);

// False if the next projection corrects everything. Doubles correct all but misfits; floats leave round-off at rest
// too.
template <class S>
bool may_stay(const Island<S>& island);

// True if Batch::error, at most `error`, is after a step of h in each row what the last projection has left of joints
// that contradict each other. They would creep, were they corrected again and again.
template <class S>
bool stays_misfit(const WorldData<S>& world, const Island<S>& island, typename S::Scalar error, typename S::Scalar h);

// True if joints whose error was `at_start` at the start of the step may contradict each other at its end: they did
// then, or time, a law or rolling prescribes a motion. A force does not. Others that fitted still fit somewhere near.
template <class S>
bool may_contradict(const Island<S>& island, typename S::Scalar at_start);

// True if the direct solver failed to project the poses onto C = 0 although the start of the step satisfied C = 0 up to
// `at_start`, and the remaining error is not the one that contradicting joints share. The step was too long for Newton,
// or its end is out of the joints' reach. Sweeps always leave an error and never count as failed.
template <class S>
bool left_the_joints(const WorldData<S>& world, const Island<S>& island, typename S::Scalar at_start);
// Marks such a step as failed.
template <class S>
void fail_if_open(const WorldData<S>& world, Island<S>& island, typename S::Scalar at_start);

}  // namespace cdot
