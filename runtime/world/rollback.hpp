// Replaces the State: by the one before a failed step, or by a snapshot.
#pragma once

#include "runtime/state/world_data.hpp"

namespace cdot {

// save_state() saves the time, the counts and the State of all awake islands; roll_back() restores them.
template <class S>
void save_state(WorldData<S>& world);
template <class S>
void roll_back(WorldData<S>& world);

// The same for one awake island.
template <class S>
void save_island(WorldData<S>& world, int index);
template <class S>
void roll_back_island(WorldData<S>& world, int index);

// Replaces the State by these bytes, which have the layout of the World's block.
template <class S>
void adopt_state(WorldData<S>& world, const std::vector<std::byte>& bytes);

// Recomputes the Workspace that the last step left for the next one: J and, for methods that begin with it, the factor.
template <class S>
void compute_again(WorldData<S>& world, Island<S>& island);

}  // namespace cdot
