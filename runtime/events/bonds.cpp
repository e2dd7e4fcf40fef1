#include "runtime/events/bonds.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <cdot/spaces.hpp>

#include "runtime/balance/balance.hpp"
#include "runtime/events/latch.hpp"
#include "runtime/solve/projection.hpp"
#include "runtime/solve/solver.hpp"
#include "runtime/state/state_list.hpp"

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

// The norm of number(batch, row) over the joint's own rows.
template <class S, class F>
double norm_over(const WorldData<S>& world, const JointRecord& record, F number) {
  const Place& place = record.places[0];
  const Batch<S>& batch = *world.batches[place.batch];
  const int rows = batch.ops->rows, first = slot_of(world, place) * rows;
  double square = 0;
  for (int i = first; i < first + rows; ++i) square += number(batch, i) * number(batch, i);
  return std::sqrt(square);
}

template <class S>
double impulse_on(const WorldData<S>& world, const JointRecord& record) {
  return norm_over(world, record,
                   [](const Batch<S>& batch, int i) { return double(batch.lambda[i]) + double(batch.correction[i]); });
}

template <class S>
double force_on(const WorldData<S>& world, const JointRecord& record) {
  return norm_over(world, record, [](const Batch<S>& batch, int i) { return double(batch.lambda[i]); });
}

// Infinite if the joint is broken.
template <class S, class Load>
double distance_of(const WorldData<S>& world, const Bond& bond, double time, Load load) {
  const JointRecord& record = world.joints[bond.joint];
  if (record.broken) return std::numeric_limits<double>::infinity();
  return bond.distance(bond.parameters.data(), time, load(world, record));
}

// The joint with the least distance, of those up to `most`; -1 if there is none.
template <class S, class Load>
int nearest(const WorldData<S>& world, const Island<S>& island, double time, double most, Load load) {
  std::pair<double, int> first{most, std::numeric_limits<int>::max()};
  for (const int k : island.bonds) {
    const Bond& bond = world.bonds[k];
    first = std::min(first, {distance_of(world, bond, time, load), bond.joint});
  }
  return first.second == std::numeric_limits<int>::max() ? -1 : first.second;
}

}  // namespace

template <class S>
int overloaded_joint(const WorldData<S>& world, const Island<S>& island, double time, double h) {
  const auto load = [&](const auto&, const JointRecord& record) { return impulse_on(world, record) / h; };
  return nearest(world, island, time, 0, load);
}

template <class S>
double distance_from_break(const WorldData<S>& world, const Bond& bond, double time) {
  const Island<S>& island = world.islands[world.island_of[movable_body(world, world.joints[bond.joint])]];
  const auto load = [&](const auto& of, const JointRecord& record) {  // blows have been judged apart where located
    return (island.flow.locates ? force_on(of, record) : impulse_on(of, record)) / of.last_step;
  };
  return distance_of(world, bond, time, load);
}

template <class S>
bool break_by_lambda(WorldData<S>& world, Island<S>& island, typename S::Scalar time, typename S::Scalar over) {
  if (island.bonds.empty() || !island.solver->exact) return false;
  const auto load = [&](const auto&, const JointRecord& record) { return force_on(world, record) / double(over); };
  const int joint = nearest(world, island, double(time), double(at_event<typename S::Scalar>), load);
  if (joint < 0) return false;
  break_joint(world, island, joint, double(time));
  evaluate_anew(world, island, time);
  return true;
}

// Swaps every slot of the joint with the last one of its segment, and shortens the segment.
template <class S>
void break_joint(WorldData<S>& world, Island<S>& island, int joint, double time) {
  JointRecord& record = world.joints[joint];
  take(world, Source::breaking, potential_of(world, record, time, world.one_slot));
  record.broken = true;
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
  island.system.doubt_redundant_rows();
  island.flow.forget();
  auto& margins = island.flow.margins;
  std::fill(margins.begin(), margins.end(), std::numeric_limits<typename S::Scalar>::infinity());
}

template <class S>
void find_rows(WorldData<S>& world, Island<S>& island) {
  const auto broken = [&](const Batch<S>& batch, int slot) { return bool(world.joints[batch.joint[slot]].broken); };
  for (Segment<S>& segment : island.segments) {
    Batch<S>& batch = *segment.batch;
    for (int slot = segment.begin; slot < segment.whole_end; ++slot) batch.slot_of[batch.home[slot]] = slot;
    segment.end = segment.begin;
    while (segment.end < segment.whole_end && !broken(batch, segment.end)) ++segment.end;
  }
  island.system.find_rows(broken);
}

template <class S>
void measure_margins_of_bonds(const WorldData<S>& world, Island<S>& island, double time) {
  using T = typename S::Scalar;
  Flow<S>& flow = island.flow;
  for (std::size_t k = 0; static_cast<std::size_t>(flow.guarded) + k < flow.margins.size(); ++k) {
    const double distance = distance_of(world, world.bonds[island.bonds[k]], time, force_on<S>);
    flow.margins[static_cast<std::size_t>(flow.guarded) + k] = T(distance) / at_event<T>;
  }
}

#define CDOT_INSTANTIATE(S)                                                             \
  template int overloaded_joint(const WorldData<S>&, const Island<S>&, double, double); \
  template double distance_from_break(const WorldData<S>&, const Bond&, double);        \
  template bool break_by_lambda(WorldData<S>&, Island<S>&, S::Scalar, S::Scalar);       \
  template void break_joint(WorldData<S>&, Island<S>&, int, double);                    \
  template void find_rows(WorldData<S>&, Island<S>&);                                   \
  template void measure_margins_of_bonds(const WorldData<S>&, Island<S>&, double);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
