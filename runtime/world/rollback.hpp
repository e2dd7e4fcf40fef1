// From State to State: back to the one before a step that failed, or on from another.
#pragma once

#include "runtime/state/world_data.hpp"

namespace cdot {

// The State of all islands that are awake is saved, with the time and the counts; and is that of the World again.
template <class S>
void save_state(WorldData<S>& world);
template <class S>
void roll_back(WorldData<S>& world);

// The World goes on from these bytes, which are laid out like its own.
template <class S>
void adopt_state(WorldData<S>& world, const std::vector<std::byte>& bytes);

// Where rows stand, after some have changed places: from BatchState::home and the joints that broke.
template <class S>
void find_rows(WorldData<S>& world, Island<S>& island);
// The Workspace that the end of a step leaves for the next one: J at these poses, and the factor of a method that
// begins with it.
template <class S>
void compute_again(WorldData<S>& world, Island<S>& island);

}  // namespace cdot
