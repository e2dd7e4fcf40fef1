// The order of the joints in a sweep of the iterative solver.
#pragma once

#include "runtime/state/world_data.hpp"

namespace cdot {

// The place of every joint in a sweep: along each chain from the tips to the roots, joints to immovable bodies last.
// The order of add_joint() does not matter. Measured with 4, 10 and 30 sweeps on trees and on chains of 10 to 40 links,
// hanging, thrown or between two supports. The gap is half that of a shuffled order and a tenth smaller than from the
// roots to the tips. Meshes show no difference.
template <class S>
std::vector<int> sweep_places(const WorldData<S>& world);

}  // namespace cdot
