// The sensors of a scene, read from a World.
#pragma once

#include <vector>

#include <cdot/world.hpp>

#include "runtime/tool/scene/scene.hpp"

namespace cdot {

// One value per sensor, in the units of their formulas. Forces are those of the last step, and 0 before the first one.
template <class S>
std::vector<double> sensor_values(const Scene& scene, BasicWorld<S>& world);

}  // namespace cdot
