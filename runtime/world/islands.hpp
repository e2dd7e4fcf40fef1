// Islands, their sizes, and which of them sleep.
#pragma once

#include "runtime/state/world_data.hpp"

namespace cdot {

// Islands, order of slots, patterns: all that depends on what is connected, not on where it is.
// Allocates; does nothing if nothing was added since.
template <class S>
void prepare_topology(WorldData<S>& world);

// Island::size and ::scale, from the present poses.
template <class S>
void measure_size(WorldData<S>& world, Island<S>& island);

// Islands that have rested long enough fall asleep.
template <class S>
void put_to_sleep(WorldData<S>& world, double h);
// For whoever changes a force on a body: its island wakes, and goes on from where it is.
template <class S>
void wake_pushed(WorldData<S>& world, int body);
// For whoever changes where it is, how it moves, or what holds it: nothing that was computed for its island holds.
template <class S>
void wake(WorldData<S>& world, int body);

}  // namespace cdot
