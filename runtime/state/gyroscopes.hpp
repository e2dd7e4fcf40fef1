// The bodies whose inertia tensor turns with them.
#pragma once

#include <algorithm>

namespace cdot {

// f(gyroscope) if the body's inertia tensor turns with it. `world` is a WorldData, const or not; Model::turning
// ascends.
template <class World, class F>
void with_gyroscope(World& world, int body, F f) {
  const auto found = std::lower_bound(world.turning.begin(), world.turning.end(), body);
  if (found != world.turning.end() && *found == body)
    f(world.gyroscopes[static_cast<std::size_t>(found - world.turning.begin())]);
}

}  // namespace cdot
