// Events of rows: a row that waits for its `after`, or acts until its `until`. Batch::happened keeps what happened.
#pragma once

#include "runtime/state/world_data.hpp"

namespace cdot {

// Relative distance from a condition that counts as none.
template <class T>
inline constexpr T at_event = T(by_precision<T>(1e-5, 1e-10));

// Notes the events of the island's rows at the present C, for impulses over h, drift correction included. Batch::rate
// must have J v. True if there was one.
template <class S>
bool latch_by_impulses(Island<S>& island, typename S::Scalar h);

// The same for Batch::lambda alone: forces if `over` is 1, or impulses of a blow that lasts so long.
template <class S>
bool latch_by_lambda(Island<S>& island, typename S::Scalar over);

// True if a hook of Model::after_substep may change the island: joints break there unless the method locates events.
template <class S>
bool changes_after_substeps(const WorldData<S>& world, const Island<S>& island);

// True if a row of the island acts until it carries too much.
template <class S>
bool ends_by_load(const Island<S>& island);

// Lets the World look for events after every substep, if any row has some.
template <class S>
void watch_events(WorldData<S>& world);

}  // namespace cdot
