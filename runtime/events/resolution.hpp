// Differences of C, of its rate and of its force that count as 0 for the events of a row.
#pragma once

#include "runtime/state/world_data.hpp"

namespace cdot {

// Raises the resolutions of the rows of one slot to the share `slight` of
//   C       its largest change by a displacement of the island's size or a rotation of 1 rad, by J or, where that is 0,
//           as in the middle of a cone, of C itself: c
//   rate    the largest of the sum of all |J v|; sqrt(c dJv/dt), the rate after the way c; epsilon c / (slight h)
//   force   dJv/dt + rate^2 / c over K
//   hop     6 c a: at the rate v a row goes v^2 / (2 a) far; an end that is met is found up to 3 resolutions late, and
//           closing that gap lets other ends hop by as much, again and again
// where dJv/dt is the larger of two numbers: the sum of all |J dv/dt|, in which angular accelerations are at least
// linear / size, and K lambda of the row's own force. a: the larger of |J dv/dt| and K lambda.
template <class S>
void find_resolution(WorldData<S>& world, const Island<S>& island, Batch<S>& batch, int slot, typename S::Scalar h,
                     Resolution<typename S::Scalar>* resolution);

}  // namespace cdot
