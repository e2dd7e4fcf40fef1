// Stiffness from tension between bodies: the part of the geometric stiffness -d(J^T lambda)/dq that couples their
// displacements, as in a taut rod or rope. The part of each body's own rotation adds to the inertias
// (stiffen_bodies()). This part becomes soft rows in the direct solver's system,
//
//   -h d(J^T lambda)/dq = W^T D W + (own rotations),   impulse mu = -D W v',
//
// so K gets the rows W with D^-1 on the diagonal, and M stays block diagonal. This impulse rotates the joint's own
// impulse J^T lambda from its direction at the start of the step to the one at the end. Reactions use J at the end; J^T
// lambda is then the joint's complete impulse.
#pragma once

#include "runtime/state/world_data.hpp"

namespace cdot {

// The number of such rows of every slot with rows, in the order of the segments; empty if all are 0. `at` has the poses
// of the World; those of the island's bodies are changed.
template <class S>
std::vector<int> tension_rows(const WorldData<S>& world, const Island<S>& island, Bodies<S>& at);

// W and D from the last step's impulses, scaled by h; subtracts their stiffness from Bodies::stiffness. Direct solver
// only.
template <class S>
void tighten_tensions(WorldData<S>& world, Island<S>& island, typename S::Scalar h);

}  // namespace cdot
