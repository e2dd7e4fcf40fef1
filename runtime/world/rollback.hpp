// What a step that fails goes back to. Less than a snapshot, since every step pays for it: what is computed from poses
// and velocities is computed again.
#pragma once

#include "runtime/state/world_state.hpp"

namespace cdot {

// Makes room; allocates.
template <class S>
void prepare_to_keep(Island<S>& island);

// Of all islands that are awake, with the time and the counts.
template <class S>
void keep_state(WorldState<S>& world);
template <class S>
void put_state_back(WorldState<S>& world);

}  // namespace cdot
