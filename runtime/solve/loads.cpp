#include "runtime/solve/loads.hpp"

#include <algorithm>

#include <cdot/spaces.hpp>

namespace cdot {
namespace {

template <class S>
bool carries(const Batch<S>& batch, const Law<S>& law) {
  return law.load_of ? batch.law == law.load_of : batch.own;
}

// Linear parts of J on the last body that moves, by row: a variant with an immovable body lacks its columns.
template <class S>
void find_arms(const WorldData<S>& world, LoadedRow<S>& row) {
  using Real = ExactNumber<typename S::Scalar>;
  const Batch<S>& of = *row.carrier;
  const int rows = of.ops->rows, width = S::freedom * of.ops->bodies;
  Real J[most_rows * S::freedom * most_bodies], weighted[most_rows * S::freedom * most_bodies],
      K[most_rows * most_rows];
  of.ops->dense(of, of.slot_of[row.carrier_home], world.bodies, J, weighted, K, rows);
  int last = of.ops->bodies - 1;
  const int* const bodies = of.body.data() + of.slot_of[row.carrier_home] * of.ops->bodies;
  while (last > 0 && world.bodies.immovable(bodies[last])) --last;
  for (int r = 0; r < rows; ++r)
    for (int k = 0; k < 3; ++k)
      row.arms[3 * r + k] =
          k < S::lengths ? typename S::Scalar(J[r * width + last * S::freedom + k]) : typename S::Scalar(0);
}

}  // namespace

template <class S>
void list_loads(const WorldData<S>& world, Island<S>& island) {
  island.loads.clear();
  for (const auto& [batch, begin, end, whole] : island.segments) {
    if (!batch->law || !batch->law->by_load) continue;
    for (int slot = begin; slot < end; ++slot) {
      for (const Place& place : world.joints[batch->joint[slot]].places) {
        Batch<S>& carrier = *world.batches[place.batch];
        if (!carries(carrier, *batch->law)) continue;
        LoadedRow<S> row{};
        row.batch = batch, row.carrier = &carrier;
        row.home = batch->home[slot], row.carrier_home = place.home;
        row.carrier_block = -1;
        const auto& blocks = island.system.blocks;
        for (size_t b = 0; b < blocks.size(); ++b)
          if (blocks[b].batch == &carrier && blocks[b].home == place.home) row.carrier_block = static_cast<int>(b);
        island.loads.push_back(row);
        break;
      }
    }
  }
  island.load_changes.assign(island.loads.size(), typename S::Scalar(0));
  if (!island.loads.empty()) island.load_search.reserve(island.loads.size());
}

template <class S>
void begin_loads(WorldData<S>& world, Island<S>& island) {
  using T = typename S::Scalar;
  for (LoadedRow<S>& row : island.loads) {
    Batch<S>& batch = *row.batch;
    const int i = batch.slot_of[row.home];
    batch.law->by_load(batch, i, &row.by_lower, &row.by_upper);
    if (island.acceleration_level && batch.mode[i] == Mode::pushed) row.by_lower = row.by_upper;
    if (island.acceleration_level && batch.mode[i] == Mode::pulled) row.by_upper = row.by_lower;
    if (island.acceleration_level && batch.mode[i] == Mode::off) row.by_upper = row.by_lower = T(0);
    row.by_lower *= island.loads_in_kick, row.by_upper *= island.loads_in_kick;
    row.lower = batch.lower[i], row.upper = batch.upper[i];
    if (!batch.law->load_of) find_arms(world, row);
  }
}

template <class S>
void bound_by_loads(Island<S>& island) {
  for (LoadedRow<S>& row : island.loads) {
    const int i = row.batch->slot_of[row.home];
    row.batch->load[i] = row.load;
    row.batch->lower[i] = row.lower + row.by_lower * row.load;
    row.batch->upper[i] = row.upper + row.by_upper * row.load;
  }
}

template <class S>
void unload(Island<S>& island) {
  for (LoadedRow<S>& row : island.loads) {
    const int i = row.batch->slot_of[row.home];
    row.batch->lower[i] = row.lower, row.batch->upper[i] = row.upper;
  }
}

#define CDOT_INSTANTIATE(S)                                  \
  template void list_loads(const WorldData<S>&, Island<S>&); \
  template void begin_loads(WorldData<S>&, Island<S>&);      \
  template void bound_by_loads(Island<S>&);                  \
  template void unload(Island<S>&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
