// What a step asks of the rows of an island before a solver (runtime/solve/solver.hpp) sees them, and their forces.
#pragma once

#include "runtime/state/world_data.hpp"

namespace cdot {

// C, J, bias of every row at the present poses, and of rows under a law its softness and bounds.
template <class S>
void evaluate_rows(WorldData<S>& world, Island<S>& island, typename S::Scalar h);

// Fills K and, where the iterative solver needs it, its factorisation.
template <class S>
void factorize_rows(WorldData<S>& world, Island<S>& island);

// Forces of springs on coordinates, from C and its rate: of the slots [begin, end) of a batch under such a law, laid
// out as lambda is.
template <class S>
void find_known_forces(WorldData<S>& world, Batch<S>& batch, int begin, int end, typename S::Scalar* force);

// dv/dt without joints, and -gamma for the bias of every row; forces of springs become both bounds of their rows.
template <class S>
void ask_for_gamma(WorldData<S>& world, Island<S>& island, typename S::Scalar time);

// dv/dt with joints, at the present poses (where C and J are evaluated) and velocities: into Bodies::velocity_rate, and
// the forces that hold the joints into the batches' lambda.
template <class S>
void accelerate(WorldData<S>& world, Island<S>& island, typename S::Scalar time);

// Adds to the inertias, and to the rows of the direct solver, what the tension of the impulses at hand stiffens; these
// are those of a step of `last_step` [s]; 0: of h.
template <class S>
void stiffen_bodies(WorldData<S>& world, Island<S>& island, typename S::Scalar h, double last_step);

}  // namespace cdot
