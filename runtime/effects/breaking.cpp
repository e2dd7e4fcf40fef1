// Joints that break by effects of specs. These add no rows: after each substep they read the impulses of the joint's
// own rows.
#include <algorithm>
#include <cmath>

#include <cdot/coordinate/breaking.hpp>
#include <cdot/detail/coordinate_effects.hpp>

#include "runtime/balance/balance.hpp"
#include "runtime/effects/effect.hpp"
#include "runtime/solve/solver.hpp"
#include "runtime/state/add_rows.hpp"
#include "runtime/state/state_list.hpp"
#include "runtime/world/islands.hpp"
#include "runtime/world/rollback.hpp"

namespace cdot {
namespace {

struct SwapSlots {
  int count, i, j;
  void item(const char*, int, bool) {}
  template <class Number>
  void operator()(StateArray<Number>& column) {
    const auto width = static_cast<std::ptrdiff_t>(column.size()) / count;
    std::swap_ranges(column.begin() + i * width, column.begin() + (i + 1) * width, column.begin() + j * width);
  }
};

// Swaps every slot of the joint with the last one of its segment, and shortens the segment. It does not allocate.
template <class S>
void break_joint(WorldData<S>& world, int joint) {
  JointRecord& record = world.joints[joint];
  take(world, Source::breaking, potential_of(world, record, world.one_slot));
  record.broken = true;
  Island<S>& island = world.islands[world.island_of[movable_body(world, record)]];
  for (const Place& place : record.places) {
    Batch<S>& batch = *world.batches[place.batch];
    const int slot = slot_of(world, place);
    for (Segment<S>& segment : island.segments) {
      if (segment.batch != &batch || slot < segment.begin || slot >= segment.end) continue;
      const int last = --segment.end;
      SwapSlots swap{batch.count(), slot, last};
      if (slot != last) StateList::each_slot(batch, 0, true, swap);
      for (int moved : {slot, last}) batch.slot_of[batch.home[moved]] = moved;
    }
  }
  find_rows(world, island);
  island.factored = false;
  compute_again(world, island);
  island.system.doubt_redundant_rows();
  island.flow.forget();
}

template <class S>
double force_of(const WorldData<S>& world, const JointRecord& record, double h) {
  const Place& place = record.places[0];
  const Batch<S>& batch = *world.batches[place.batch];
  double square = 0;
  for (int r = 0; r < batch.ops->rows; ++r) {
    const int i = slot_of(world, place) * batch.ops->rows + r;
    const double impulse = double(batch.lambda[i]) + double(batch.correction[i]);
    square += impulse * impulse;
  }
  return std::sqrt(square) / h;
}

template <class S>
void find_overloads(WorldData<S>& world, double h) {
  auto& overloads = world.overloads;
  overloads.clear();
  for (const Bond& bond : world.bonds) {
    const JointRecord& record = world.joints[bond.joint];
    const int island = world.island_of[movable_body(world, record)];
    if (record.broken || world.islands[island].asleep) continue;
    const double distance = bond.distance(bond.parameters.data(), double(world.time) + h, force_of(world, record, h));
    if (distance <= 0) overloads.push_back({island, distance, bond.joint});
  }
  std::sort(overloads.begin(), overloads.end());
}

template <class S, class F>
void each_first(const WorldData<S>& world, F f) {
  const auto& overloads = world.overloads;
  for (std::size_t k = 0; k < overloads.size(); ++k)
    if (k == 0 || overloads[k].island != overloads[k - 1].island) f(overloads[k]);
}

// Where several joints of an island carry too much, only the most overloaded one breaks: without it the others may
// carry less, as two pins that work against each other. The next substep shows whether they still carry too much.
template <class S>
void break_overloaded(WorldData<S>& world, typename S::Scalar h) {
  find_overloads(world, double(h));
  if (world.overloads.empty()) return;
  each_first(world, [&](const Overload& overload) {
    Island<S>& island = world.islands[overload.island];
    island.solver->share(world, island);
  });
  find_overloads(world, double(h));
  each_first(world, [&](const Overload& overload) { break_joint(world, overload.joint); });
}

}  // namespace

template <class S>
void add_bond(BasicWorld<S>& world, const Bond& bond) {
  auto& data = world.data();
  if (data.joints[bond.joint].places.empty()) return;
  if (data.bonds.empty()) data.after_substep.push_back(break_overloaded<S>);
  data.bonds.push_back(bond);
  if (!data.prepared) return;
  settle_state(data);  // the flag of the joint joins its island's ranges
  watch_bonds(data);
}

template <class S>
void set_breaking_load(BasicWorld<S>& world, int joint, double load) {
  check_joint(world.data(), joint);
  if (!(load > 0)) throw Error("a breaking load must be > 0");
  using Effect = coordinate::breaking;
  add_bond(world, {joint, distance_from_breaking<Effect>, {load}, Effect::in_time});
}

#define CDOT_INSTANTIATE(S)                            \
  template void add_bond(BasicWorld<S>&, const Bond&); \
  template void set_breaking_load(BasicWorld<S>&, int, double);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
