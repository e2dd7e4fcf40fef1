// Islands: their analysis, their sizes and their sleep.
#pragma once

#include "runtime/state/world_data.hpp"

namespace cdot {

// Analyses islands, order of slots and sparsity patterns, which depend on connections and not on poses. Allocates; does
// nothing if they are current.
template <class S>
void prepare_topology(WorldData<S>& world);

// Island::size and ::scale, from the present poses.
template <class S>
void measure_size(WorldData<S>& world, Island<S>& island);

// Puts islands to sleep that have rested long enough.
template <class S>
void put_to_sleep(WorldData<S>& world, double h);
// Call after a change of a force on a body: wakes its island.
template <class S>
void wake_pushed(WorldData<S>& world, int body);
// Call after a change of pose, velocity or joints: wakes the body's island and discards all that was computed for it.
template <class S>
void wake(WorldData<S>& world, int body);

}  // namespace cdot
