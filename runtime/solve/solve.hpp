// What a step asks of the joints of an island: their rows, the solvers, and the way back onto C = 0.
#pragma once

#include "runtime/state/world_state.hpp"

namespace cdot {

// C, J, bias of every row at the present poses, and of rows under a law its softness and bounds.
template <class S>
void evaluate_rows(WorldState<S>& world, Island<S>& island, typename S::Scalar h);

// Fills K and, where the iterative solver needs it, its factorisation.
template <class S>
void factorize_rows(WorldState<S>& world, Island<S>& island);

// Impulses such that J v = -bias, by the solver of the settings. The iterative one starts from `share` of the impulses
// at hand, unless warm starting is off.
template <class S>
void solve_iterative(WorldState<S>& world, Island<S>& island, typename S::Scalar share);
template <class S>
void solve_direct(WorldState<S>& world, Island<S>& island);

// Forces of springs on coordinates, from C and its rate, become both bounds of their rows: slots [begin, end) of a
// batch under such a law.
template <class S>
void find_known_forces(WorldState<S>& world, Batch<S>& batch, int begin, int end);

// The same, and -gamma for the bias of every row; forces of springs become both bounds of their rows.
template <class S>
void ask_for_gamma(WorldState<S>& world, Island<S>& island, typename S::Scalar time);

// dv/dt with joints, at the present poses (where C and J are evaluated) and velocities: into Bodies::velocity_rate, and
// the forces that hold the joints into the batches' lambda.
template <class S>
void accelerate(WorldState<S>& world, Island<S>& island, typename S::Scalar time);

// Adds to the inertias, and to the rows of the direct solver, what the tension of the last step's impulses stiffens:
// for Integrator::implicit.
template <class S>
void stiffen_bodies(WorldState<S>& world, Island<S>& island, typename S::Scalar h);

// Brings the poses back to C = 0, and the velocities with them. Only for Drift::projection.
template <class S>
void settle_poses(WorldState<S>& world, Island<S>& island);
template <class S>
void correct_drift(WorldState<S>& world, Island<S>& island, typename S::Scalar h);

}  // namespace cdot
