// Scenes that break, compiled and in the World.
#pragma once

#include <algorithm>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "tests/derive/compile/beside_world.hpp"

namespace cdot {

// Moves as in the World until then, and the joints with the numbers `broken` have ended by then, no others.
template <class Scene>
void breaks_as_in_the_world(const std::string& name, Integrator integrator, const std::vector<int>& broken,
                            double until, double step = 0.001) {
  const std::string file = "tests/derive/compile/bonds/" + name + ".toml";
  SCOPED_TRACE(file + ", step " + std::to_string(step));
  runs_as_the_world<Scene>(file, integrator, 1e-9, until, step);
  typename Scene::State state;
  Scene::reset(state);
  while (state.time < until - step / 2) Scene::step(state, step);
  for (int k = 0; k < Scene::joints; ++k)
    EXPECT_EQ(state.bonds.holds[k], std::ranges::count(broken, k) > 0 ? 0 : 1) << "joint " << k;
}

}  // namespace cdot
