// What tension stiffens between bodies: the part of the geometric stiffness -d(J^T lambda)/dq that couples their
// displacements, as a rod or a rope pulls its ends back into line. The part that is about each body's own turning is
// an inertia (stiffen_bodies()); this one is soft rows in the direct solver's system,
//
//   -h d(J^T lambda)/dq = W^T D W + (own turning),   impulse mu = -D W v',
//
// so that K gets the rows W and D^-1 on the diagonal, and M stays as simple as it is. That impulse turns the joint's
// own, J^T lambda, from the direction that it has at the start of the step into that of the end, so it is none beside
// it: with J at the end, where reactions are asked for, J^T lambda is all that the joint exerts.
#pragma once

#include "runtime/state/world_data.hpp"

namespace cdot {

// How many such rows every slot with rows has, in the order of the segments; empty where none has any.
template <class S>
std::vector<int> tension_rows(const WorldData<S>& world, const Island<S>& island);

// W and D from the impulses of the last step, h their share; what they take over leaves Bodies::stiffness. Only for the
// direct solver.
template <class S>
void tighten_tensions(WorldData<S>& world, Island<S>& island, typename S::Scalar h);

}  // namespace cdot
