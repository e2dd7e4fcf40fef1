// Motors of unlimited force whose rates no motion has at once: counted, so that a run can tell.
#pragma once

#include "runtime/state/world_data.hpp"

namespace cdot {

// Lists the pairs of rows over the same bodies that may be rivals. Allocates.
template <class S>
void list_rivals(Island<S>& island);

// Of the last solution of a system.
template <class S>
void count_rivals(WorldData<S>& world, System<S>& system);
// Sweeps have no system: of the listed pairs, by the rates for which they ask.
template <class S>
void count_rivals(WorldData<S>& world, const Island<S>& island);

}  // namespace cdot
