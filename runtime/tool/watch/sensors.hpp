// The sensors of a scene, read from a World.
#pragma once

#include <array>
#include <vector>

#include <cdot/world.hpp>

#include "runtime/tool/scene/scene.hpp"

namespace cdot {

// Of each body in the last step: that of the centre of mass by x, y, z, then the angular one; in the plane the angle's
// is the first of these.
using Accelerations = std::vector<std::array<double, 6>>;

// One value per sensor, in the units of their formulas. Forces are those of the last step, and 0 before the first one.
template <class S>
std::vector<double> sensor_values(const Scene& scene, BasicWorld<S>& world, const Accelerations& accelerations);

}  // namespace cdot
