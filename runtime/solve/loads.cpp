#include "runtime/solve/loads.hpp"

#include <algorithm>
#include <limits>

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

template <class S>
int block_of(const Island<S>& island, const Batch<S>* batch, int home) {
  const auto& blocks = island.system.blocks;
  const auto found = std::find_if(blocks.begin(), blocks.end(),
                                  [&](const auto& block) { return block.batch == batch && block.home == home; });
  return found == blocks.end() ? -1 : static_cast<int>(found - blocks.begin());
}

// The row at that place of a joint, with the place that carries its load.
template <class S>
LoadedRow<S> loaded_row(const WorldData<S>& world, const Island<S>& island, const JointRecord& joint,
                        const Place& place) {
  LoadedRow<S> row{};
  row.batch = world.batches[place.batch].get(), row.home = place.home;
  row.block = block_of(island, row.batch, row.home);
  for (const Place& other : joint.places) {
    Batch<S>& carrier = *world.batches[other.batch];
    if (!row.batch->law->by_load || !carries(carrier, *row.batch->law)) continue;
    row.carrier = &carrier, row.carrier_home = other.home;
    row.carrier_block = block_of(island, &carrier, other.home);
    break;
  }
  return row;
}

// True if a turn of the force is decided: at acceleration level, where the rows slip or are held for now.
template <class S>
bool knows_direction(const Island<S>& island, const Batch<S>& batch, int i) {
  return island.acceleration_level && (batch.mode[i] == Mode::pushed || std::isinf(batch.upper[i]));
}

}  // namespace

template <class S>
void list_loads(const WorldData<S>& world, Island<S>& island) {
  island.loads.clear();
  for (const auto& [batch, begin, end, whole] : island.segments) {
    if (!batch->law || !(batch->law->by_load || batch->law->cone_rows > 0) || batch->law->cone_row > 0) continue;
    for (int slot = begin; slot < end; ++slot) {
      const JointRecord& joint = world.joints[batch->joint[slot]];
      const auto first = std::find_if(joint.places.begin(), joint.places.end(), [&, of = batch](const Place& place) {
        return world.batches[place.batch].get() == of && place.home == of->home[slot];
      });
      for (int k = 0; k < std::max(1, batch->law->cone_rows); ++k)
        island.loads.push_back(loaded_row(world, island, joint, first[k]));
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
    const int i = row.place();
    row.by_lower = row.by_upper = T(0);
    if (row.carrier) batch.law->by_load(batch, i, &row.by_lower, &row.by_upper);
    row.before = island.corrections_in_cones * batch.correction[i];
    row.turns = batch.law->cone_rows > 0 && !knows_direction(island, batch, i);
    if (island.acceleration_level && batch.mode[i] == Mode::pushed) {
      if (batch.law->cone_rows > 0) row.by_upper *= row.share;
      row.by_lower = row.by_upper;
    }
    if (island.acceleration_level && batch.mode[i] == Mode::pulled) row.by_upper = row.by_lower;
    if (island.acceleration_level && batch.mode[i] == Mode::off) row.by_upper = row.by_lower = T(0);
    row.by_lower *= island.loads_in_kick, row.by_upper *= island.loads_in_kick;
    row.lower = batch.lower[i], row.upper = batch.upper[i];
    if (row.carrier && !batch.law->load_of) find_arms(world, row);
  }
}

template <class S>
void bound_by_loads(Island<S>& island, typename S::Scalar share) {
  for (LoadedRow<S>& row : island.loads) {
    const int i = row.place();
    row.batch->load[i] = row.load;
    const auto most = std::abs(row.corner);
    row.batch->lower[i] = row.turns ? -most - row.before : row.lower + share * row.by_lower * row.load;
    row.batch->upper[i] = row.turns ? most - row.before : row.upper + share * row.by_upper * row.load;
  }
}

template <class S>
bool run_away(Island<S>& island, bool first) {
  using T = typename S::Scalar;
  constexpr T same = T(by_precision<T>(1e-3, 1e-8));  // of the loads
  T way = 0, along = 0, whole = 0;
  for (LoadedRow<S>& row : island.loads) {
    const T change = row.load - row.corner;
    way += change * change, along += change * (row.found - row.corner_found), whole += row.load * row.load;
    row.corner = row.load, row.corner_found = row.found;
  }
  return !first && way > same * same * whole && along > way;
}

template <class S>
void unload(Island<S>& island) {
  for (LoadedRow<S>& row : island.loads) {
    const int i = row.place();
    row.batch->lower[i] = row.lower, row.batch->upper[i] = row.upper;
  }
}

template <class S>
void turn_corner(std::span<LoadedRow<S>> cone, typename S::Scalar size) {
  using T = typename S::Scalar;
  const T bound = cone[0].upper + cone[0].by_upper * cone[0].found;
  T present = 0;
  for (const LoadedRow<S>& row : cone) present = std::hypot(present, row.corner);
  const T to_bound = bound * inverse(present);
  const bool stays = std::all_of(cone.begin(), cone.end(), [&](const LoadedRow<S>& row) {
    return std::abs(row.corner_found) <= to_bound * std::abs(row.corner);
  });
  for (LoadedRow<S>& row : cone)
    row.corner_found = stays ? to_bound * row.corner : bound * inverse(size) * row.corner_found;
}

template <class S>
void begin_corners(Island<S>& island) {
  using T = typename S::Scalar;
  each_cone(island, [&](std::span<LoadedRow<S>> cone) {
    if (!cone[0].turns) return;
    T size = 0;
    for (const LoadedRow<S>& row : cone) size = std::hypot(size, row.batch->share_of_cone(row.place()));
    for (LoadedRow<S>& row : cone) {
      T& share = row.batch->share_of_cone(row.place());
      share = size > T(0) ? share / size : std::sqrt(T(1) / T(cone.size()));
      row.corner = (row.upper + row.by_upper * row.load) * share;
    }
  });
}

template <class S>
void take_corners(Island<S>& island) {
  using T = typename S::Scalar;
  each_cone(island, [&](std::span<LoadedRow<S>> cone) {
    if (!cone[0].turns) return;
    T size = 0;
    for (const LoadedRow<S>& row : cone) size = std::hypot(size, row.corner_found);
    for (LoadedRow<S>& row : cone) {
      row.corner = row.corner_found, row.load = row.found;
      if (size > T(0)) row.batch->share_of_cone(row.place()) = row.corner / size;
    }
  });
}

template <class S>
bool turns_cones(const Island<S>& island) {
  return std::any_of(island.loads.begin(), island.loads.end(), [](const LoadedRow<S>& row) { return row.turns; });
}

namespace {

// Of the sums that loads are, from the impulses of all rows of the present solution.
template <class S>
typename S::Scalar round_off_of_loads(const Island<S>& island) {
  using T = typename S::Scalar;
  constexpr T of_sums = 16 * std::numeric_limits<T>::epsilon();
  T largest = 0;
  for (const auto lambda : island.at_work().lambda) largest = std::max(largest, T(std::abs(lambda)));
  return of_sums * largest;
}

}  // namespace

template <class S>
typename S::Scalar find_load_changes(Island<S>& island) {
  using T = typename S::Scalar;
  const T round_off = round_off_of_loads(island);
  T worst = 0, largest = 0;
  for (size_t k = 0; k < island.loads.size(); ++k) {
    const LoadedRow<S>& row = island.loads[k];
    const T found = row.turns ? row.corner_found : row.found, change = found - (row.turns ? row.corner : row.load);
    island.load_changes[k] = change;
    if (std::abs(change) > round_off) worst = std::max(worst, std::abs(change));
    largest = std::max(largest, std::abs(found));
  }
  if (largest > T(0)) return worst / largest;
  return worst > T(0) ? std::numeric_limits<T>::infinity() : T(0);  // a contact that is lost has no load
}

namespace {

template <class S>
bool move_load(LoadedRow<S>& row, typename S::Scalar change) {
  using T = typename S::Scalar;
  const T next = row.load + change;
  const bool right = next >= T(0) && std::isfinite(next);
  row.load = right ? next : T(2) * std::max(row.load, row.found);
  return right;
}

template <class S>
bool move_corner(std::span<LoadedRow<S>> cone, const typename S::Scalar* change) {
  using T = typename S::Scalar;
  T along = 0, size = 0, found = 0;
  for (size_t k = 0; k < cone.size(); ++k) {
    along += (cone[k].corner + change[k]) * cone[k].corner_found;
    size = std::hypot(size, cone[k].corner), found = std::hypot(found, cone[k].corner_found);
  }
  const bool right = along >= T(0);  // false for a NaN too
  for (size_t k = 0; k < cone.size(); ++k) {
    if (right) cone[k].corner += change[k];
    else cone[k].corner = found > T(0) ? T(2) * std::max(size, found) / found * cone[k].corner_found : T(0);
  }
  return right;
}

}  // namespace

template <class S>
bool move_on(Island<S>& island) {
  bool right = true;
  for (size_t k = 0; k < island.loads.size(); ++k) {
    LoadedRow<S>& row = island.loads[k];
    if (!row.turns) right &= move_load(row, island.load_changes[k]);
    else if (row.batch->law->cone_row == 0) right &= move_corner(cone_from(island, k), &island.load_changes[k]);
  }
  return right;
}

#define CDOT_INSTANTIATE(S)                                      \
  template void list_loads(const WorldData<S>&, Island<S>&);     \
  template void begin_loads(WorldData<S>&, Island<S>&);          \
  template void bound_by_loads(Island<S>&, S::Scalar);           \
  template bool run_away(Island<S>&, bool);                      \
  template void unload(Island<S>&);                              \
  template void turn_corner(std::span<LoadedRow<S>>, S::Scalar); \
  template void begin_corners(Island<S>&);                       \
  template void take_corners(Island<S>&);                        \
  template bool turns_cones(const Island<S>&);                   \
  template S::Scalar find_load_changes(Island<S>&);              \
  template bool move_on(Island<S>&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
