// Ends that get slack as the motion begins.
#pragma once

#include "runtime/state/world_data.hpp"

namespace cdot {

// A rope across joints that are in line with it repeats their rows, but in this pose only: as they bend, it gets slack.
// C, its rate and the accelerations do not tell that, but d2C/dt2 along a motion does: along the present velocities;
// if nothing bends there, along dv/dt; then, as where a brake between the joints still holds them in line, along any
// motion that the joints alone allow. Call it after solve() of the accelerations. Ends that open are let go. True if
// it has looked for some: then solve again.
template <class S>
bool let_go_of_slackening_ends(WorldData<S>& world, Island<S>& island, typename S::Scalar time);

}  // namespace cdot
