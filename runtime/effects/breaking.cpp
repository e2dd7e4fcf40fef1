// The breaking load. It needs no row: only a look at the joint's own impulses after each substep,
// in Worlds that asked.
#include <algorithm>
#include <cmath>

#include <cdot/effects.hpp>

#include "runtime/state/add_rows.hpp"
#include "runtime/state/world_state.hpp"

namespace cdot {
namespace {

template <class Item>
void swap_slots(std::vector<Item>& array, int count, int i, int j) {
  const auto width = static_cast<std::ptrdiff_t>(array.size()) / count;
  std::swap_ranges(array.begin() + i * width, array.begin() + (i + 1) * width, array.begin() + j * width);
}

template <class S>
void move_place(WorldState<S>& world, const Batch<S>& batch, int from, int to) {
  for (Place& place : world.joints[batch.joint[to]].places)
    if (world.batches[place.batch].get() == &batch && place.slot == from) place.slot = to;
}

// The slot changes places with the last one of its segment, which then ends before it. Nothing is
// allocated.
template <class S>
void remove_slot(WorldState<S>& world, Island<S>& island, Batch<S>& batch, int slot) {
  for (Segment<S>& segment : island.segments) {
    if (segment.batch != &batch || slot < segment.begin || slot >= segment.end) continue;
    const int last = --segment.end;
    if (last != slot) {
      batch.for_each_array([&, count = batch.count()](auto& array) { swap_slots(array, count, slot, last); });
      move_place(world, batch, last, slot);
      move_place(world, batch, slot, last);
    }
    island.system.remove(&batch, slot, last);
  }
}

template <class S>
void break_joint(WorldState<S>& world, int joint) {
  JointRecord& record = world.joints[joint];
  record.broken = true;
  Island<S>& island = world.islands[world.island_of[movable_body(world, record)]];
  for (Place& place : record.places) {
    place.before_breaking = place.slot;
    remove_slot(world, island, *world.batches[place.batch], place.slot);
  }
  world.broken_in_step.push_back(joint);  // there is room for all
  island.factored = false;
  island.flow.forget();
}

// The reverse of remove_slot(), of what it was done to last.
template <class S>
void put_slot_back(WorldState<S>& world, Island<S>& island, Batch<S>& batch, int slot, int last) {
  for (Segment<S>& segment : island.segments) {
    if (segment.batch != &batch || slot < segment.begin || segment.end != last) continue;
    ++segment.end;
    if (last != slot) {
      batch.for_each_array([&, count = batch.count()](auto& array) { swap_slots(array, count, slot, last); });
      move_place(world, batch, last, slot);
      move_place(world, batch, slot, last);
    }
    island.system.put_back(&batch, slot, last);
  }
}

template <class S>
void mend_joints(WorldState<S>& world) {
  for (auto joint = world.broken_in_step.rbegin(); joint != world.broken_in_step.rend(); ++joint) {
    JointRecord& record = world.joints[*joint];
    record.broken = false;
    Island<S>& island = world.islands[world.island_of[movable_body(world, record)]];
    for (auto place = record.places.rbegin(); place != record.places.rend(); ++place)
      put_slot_back(world, island, *world.batches[place->batch], place->before_breaking, place->slot);
  }
  world.broken_in_step.clear();
}

template <class S>
double force_of(const WorldState<S>& world, const JointRecord& record, double h) {
  const Place& place = record.places[0];
  const Batch<S>& batch = *world.batches[place.batch];
  double square = 0;
  for (int r = 0; r < batch.ops->rows; ++r) {
    const int i = place.slot * batch.ops->rows + r;
    const double impulse = double(batch.lambda[i]) + double(batch.correction[i]);
    square += impulse * impulse;
  }
  return std::sqrt(square) / h;
}

template <class S>
void break_overloaded(WorldState<S>& world, typename S::Scalar h) {
  for (const auto& [joint, load] : world.breaking_loads) {
    const JointRecord& record = world.joints[joint];
    if (!record.broken && force_of(world, record, double(h)) > load) break_joint(world, joint);
  }
}

}  // namespace

template <class S>
void set_breaking_load(BasicWorld<S>& world, int joint, double load) {
  auto& state = world.state();
  check_joint(state, joint);
  if (!(load > 0)) throw Error("a breaking load must be > 0");
  if (state.joints[joint].places.empty()) return;
  if (state.breaking_loads.empty()) state.after_substep.push_back({break_overloaded<S>, mend_joints<S>});
  state.breaking_loads.emplace_back(joint, load);
  state.broken_in_step.reserve(state.breaking_loads.size());
}

#define CDOT_INSTANTIATE(S) template void set_breaking_load(BasicWorld<S>&, int, double);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
