// Removes islands at rest from the list of awake islands, and puts them back when a change wakes them.
#include <algorithm>
#include <cmath>
#include <limits>

#include <cdot/spaces.hpp>

#include "runtime/balance/balance.hpp"
#include "runtime/motion/motion.hpp"
#include "runtime/step/integrators.hpp"
#include "runtime/world/islands.hpp"
#include "runtime/world/rollback.hpp"

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
    if (world.islands[i].floats) world.islands[i].momentum[6] = -1;
    forget(world.islands[i]);
  }
}

template <class S>
bool slower(const WorldData<S>& world, const Island<S>& island, double speed) {
  return std::all_of(island.bodies.begin(), island.bodies.end(),
                     [&](int i) { return S::slower(world.bodies.velocity[i], typename S::Scalar(speed)); });
}

template <class S>
void stop(WorldData<S>& world, Island<S>& island) {
  for (int i : island.bodies) world.bodies.velocity[i] = {};
  island.levelled = false;
  if constexpr (S::has_gyroscopes) set_inertias(world, island);  // L = I w
}

// An island rests only where it would stay by itself: from v = 0, one step must leave |v| = |a| h so small that it
// would take `patience` times sleep_after to reach sleep_speed. A force that nothing balances and a motor that can
// still turn do not pass. Round-off of the forces passes: a float resolves `grain` of them.
constexpr double patience = 1e4;
template <class T>
constexpr double grain = by_precision<T>(1e-5, 1e-14);

template <class S>
bool stays_from_rest(WorldData<S>& world, int index) {
  Island<S>& island = world.islands[index];
  const double h = world.last_step;
  double acceleration = world.settings.sleep_speed / (patience * world.settings.sleep_after);
  for (int i : island.bodies) {
    typename S::Scalar numbers[S::freedom];
    S::write(world.bodies.acceleration[i], numbers);
    for (auto number : numbers)
      acceleration = std::max(acceleration, grain<typename S::Scalar> * std::abs(double(number)));
  }
  save_island(world, index);
  stop(world, island);
  island.flow.forget();
  stepper_of<S>(world.settings.integrator).step(world, island, typename S::Scalar(h));
  const bool stays = island.trouble == StepProblem::none && slower(world, island, acceleration * h);
  roll_back_island(world, index);
  return stays;
}

}  // namespace

template <class S>
void put_to_sleep(WorldData<S>& world, double h) {
  if (world.settings.sleep_after <= 0) return;
  const auto falls_asleep = [&](int index) {
    Island<S>& island = world.islands[index];
    const bool slow = !island.restless && slower(world, island, world.settings.sleep_speed);
    island.rested = slow ? island.rested + h : 0.0;
    if (island.rested < world.settings.sleep_after) return false;
    island.asleep = stays_from_rest(world, index);
    if (!island.asleep) {
      island.rested = 0;  // asks again after another sleep_after
      return false;
    }
    take(world, Source::sleep, kinetic_energy(world, island));
    stop(world, island);
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
    island.gained = 0;  // what it lost in another state is no credit
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
