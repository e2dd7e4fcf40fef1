// Removes islands at rest from the list of awake islands, and puts them back when a change wakes them.
#include <algorithm>

#include <cdot/spaces.hpp>

#include "runtime/world/islands.hpp"

namespace cdot {
namespace {

template <class S>
void wake_island(WorldData<S>& world, int index) {
  Island<S>& island = world.islands[index];
  island.rested = 0;
  if (!island.asleep) return;
  island.asleep = false;
  // No allocation: the list once had every island.
  world.awake.insert(std::lower_bound(world.awake.begin(), world.awake.end(), index), index);
}

// Wakes the body's island and calls forget(island). A change of an immovable body is rare and wakes every island.
template <class S, class F>
void for_each_island_of(WorldData<S>& world, int body, F forget) {
  if (!world.prepared) return;
  const int island = world.island_of[body];
  const int first = island < 0 ? 0 : island;
  const int last = island < 0 ? static_cast<int>(world.islands.size()) - 1 : island;
  for (int i = first; i <= last; ++i) {
    wake_island(world, i);
    forget(world.islands[i]);
  }
}

}  // namespace

template <class S>
void put_to_sleep(WorldData<S>& world, double h) {
  using T = typename S::Scalar;
  if (world.settings.sleep_after <= 0) return;
  Bodies<S>& all = world.bodies;
  const T speed = T(world.settings.sleep_speed);
  const auto falls_asleep = [&](int index) {
    Island<S>& island = world.islands[index];
    const bool resting = !island.restless && std::all_of(island.bodies.begin(), island.bodies.end(),
                                                         [&](int i) { return S::slower(all.velocity[i], speed); });
    island.rested = resting ? island.rested + h : 0.0;
    if (island.rested < world.settings.sleep_after) return false;
    for (int i : island.bodies) all.velocity[i] = {};
    island.asleep = true;
    return true;
  };
  world.awake.erase(std::remove_if(world.awake.begin(), world.awake.end(), falls_asleep), world.awake.end());
}

template <class S>
void wake_pushed(WorldData<S>& world, int body) {
  for_each_island_of(world, body, [&](Island<S>& island) { island.flow.forget(); });
}

template <class S>
void wake(WorldData<S>& world, int body) {
  for_each_island_of(world, body, [](Island<S>& island) {
    island.evaluated = island.factored = false;
    island.flow.forget();
    island.residual = std::numeric_limits<typename S::Scalar>::infinity();
  });
}

#define CDOT_INSTANTIATE(S)                          \
  template void put_to_sleep(WorldData<S>&, double); \
  template void wake_pushed(WorldData<S>&, int);     \
  template void wake(WorldData<S>&, int);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
