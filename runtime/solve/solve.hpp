// Evaluates the rows of an island and their forces, before a solver (runtime/solve/solver.hpp) uses them.
#pragma once

#include "runtime/state/world_data.hpp"

namespace cdot {

// C, J and dC/dt of every row at the present poses, if they have changed.
template <class S>
void evaluate_present(WorldData<S>& world, Island<S>& island);

// C, J and bias of every row at the present poses; softness and bounds of rows under a law.
template <class S>
void evaluate_rows(WorldData<S>& world, Island<S>& island, typename S::Scalar h);

// The whole turns that the rows of an island have counted, into Flow::start_turns and back. A try that is taken back
// leaves no turn behind.
template <class S>
void prepare_turns(Island<S>& island);
template <class S>
void keep_turns(Island<S>& island);
template <class S>
void restore_turns(const Island<S>& island);

// Computes K or, for the sweeps of rigid rows, its factorisation.
template <class S>
void factorize_rows(WorldData<S>& world, Island<S>& island);

// Forces of springs on coordinates from C and its rate, for the slots [begin, end) of a batch; laid out like lambda.
template <class S>
void find_known_forces(WorldData<S>& world, Batch<S>& batch, int begin, int end, typename S::Scalar* force);

// Computes dv/dt without joints, sets every bias to -gamma, and sets both bounds of spring rows to the spring's force.
template <class S>
void ask_for_gamma(WorldData<S>& world, Island<S>& island, typename S::Scalar time);

// Writes dv/dt with joints to Bodies::velocity_rate and the joints' forces to the batches' lambda. C and J must be
// those of the present poses.
template <class S>
void accelerate(WorldData<S>& world, Island<S>& island, typename S::Scalar time);

// Adds `share` times the stiffness of the present impulses to the effective masses and to the rows of the direct
// solver.
template <class S>
void stiffen_masses(WorldData<S>& world, Island<S>& island, typename S::Scalar share);
// The effective masses without it.
template <class S>
void restore_masses(WorldData<S>& world, const Island<S>& island);

// The velocities with which a linearly implicit step starts: (M + h G)^-1 M v, with these effective masses.
template <class S>
void hold_back(WorldData<S>& world, const Island<S>& island);

// Both for a linearly implicit step of h. The present impulses are those of a step of `last_step` [s]; 0: of h.
template <class S>
void stiffen_bodies(WorldData<S>& world, Island<S>& island, typename S::Scalar h, double last_step);

}  // namespace cdot
