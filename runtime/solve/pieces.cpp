#include "runtime/solve/pieces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <cdot/spaces.hpp>

#include "runtime/balance/balance.hpp"

namespace cdot {
namespace {

// The numbers of a slot go on within the span `next`. Where they jump, their mover puts in the energy that rows gain.
template <class S>
void begin_span(WorldData<S>& world, Island<S>& island, Batch<S>& batch, int slot, double time, const ProfileSpan& next,
                bool effect) {
  const bool jumps = batch.spans[2 * slot + 1] <= next.from;
  const double before = jumps ? potential_of(world, batch, slot, time, world.one_slot) : 0;
  batch.spans[2 * slot] = next.from, batch.spans[2 * slot + 1] = next.until;
  if (!jumps) return;
  // The rows and the accelerations of the last step hold the numbers before the jump.
  island.evaluated = island.factored = island.flow.known = false;
  if (!effect) island.kinked = static_cast<int>(batch.source);
  const double after = potential_of(world, batch, slot, time, world.one_slot);
  put_in(world, static_cast<Source>(batch.source), after - before);
}

}  // namespace

template <class S>
double begin_piece(WorldData<S>& world, Island<S>& island, double time, double h, int order) {
  double until = unbounded;
  const double near = one_time<typename S::Scalar>(time, h);
  for (const auto& [batch, begin, end, whole] : island.segments) {
    if (!batch->driven()) continue;
    const bool has_ends = batch->law && batch->law->error;
    for (int slot = begin; slot < end; ++slot) {
      const bool effect = joint_types(S::dimension)[world.joints[batch->joint[slot]].type].is_effect;
      double slot_until = unbounded;
      for (const Drive& drive : batch->drives_of(slot)) {
        const int lowest = (effect || drive.of_row) && !has_ends ? 0 : 1;
        slot_until = std::min(slot_until, drive.profile.next_break(time + near, std::max(order, lowest)));
      }
      begin_span(world, island, *batch, slot, time, {time + near, slot_until}, effect);
      until = std::min(until, slot_until);
    }
  }
  return until;
}

template <class S>
double begin_pieces(WorldData<S>& world, double time, double h) {
  double until = unbounded;
  for (int index : world.awake) until = std::min(until, begin_piece(world, world.islands[index], time, h, 0));
  return until;
}

template <class S>
int joint_out_of_range(const Island<S>& island) {
  for (const auto& [batch, begin, end, whole] : island.segments) {
    if (!batch->driven()) continue;
    for (int slot = begin; slot < end; ++slot)
      for (const Drive& drive : batch->drives_of(slot))
        if (!(drive.above < drive.now.value && drive.now.value < drive.below)) return batch->joint[slot];
  }
  return -1;
}

#define CDOT_INSTANTIATE(S)                                                    \
  template double begin_piece(WorldData<S>&, Island<S>&, double, double, int); \
  template double begin_pieces(WorldData<S>&, double, double);                 \
  template int joint_out_of_range(const Island<S>&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
