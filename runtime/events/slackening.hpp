// Ends that get slack as the motion begins.
#pragma once

#include "runtime/state/world_data.hpp"

namespace cdot {

// A rope across joints that are in line with it repeats their rows, but in this pose only: as they bend, it gets slack.
// At rest neither C nor its rate nor the accelerations tell that, but their change along the present dv/dt does. Call
// it after solve() of the accelerations. Such ends are let go: true if there are some. Then solve again.
template <class S>
bool let_go_of_slackening_ends(WorldData<S>& world, Island<S>& island, typename S::Scalar time);

}  // namespace cdot
