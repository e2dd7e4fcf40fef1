// Rows that let go as the motion begins: ends that get slack, friction that slips.
#pragma once

#include "runtime/state/world_data.hpp"

namespace cdot {

// Rows that repeat each other, but in this pose only: the motion that begins there bends them apart. C, its rate and
// the accelerations do not tell which of them hold, but d2C/dt2 along a motion does. Call it after solve() of the
// accelerations. True if it has let go of some, or looked for ends: then solve again.
//
// - Of rows that share a load, as two ropes in line, or friction along a rod beside its pin, those hold that lead to
// the
//   motion of dv/dt with the least virtual work: unless the velocities bend the rows already, which accelerations tell.
// - A rope across joints that are in line with it gets slack as they bend: along the present velocities; if nothing
//   bends there, along dv/dt; then, as where a brake between the joints still holds them in line, along any motion that
//   the joints alone allow.
template <class S>
bool let_go_of_slackening_rows(WorldData<S>& world, Island<S>& island, typename S::Scalar time);

}  // namespace cdot
