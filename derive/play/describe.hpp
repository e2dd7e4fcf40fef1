// A scene for the page: bodies with their shapes, joints with their points and motors, sensors with their units.
#pragma once

#include <nlohmann/json.hpp>

#include <cdot/world.hpp>

#include "runtime/tool/scene/scene.hpp"

namespace cdot::play {

// Positions and angle in the plane, a quaternion in space.
std::vector<double> numbers_of(const planar::Place& place);
std::vector<double> numbers_of(const spatial::Place& place);

template <class S>
nlohmann::json description_of(const Scene& scene, const BasicWorld<S>& world);

std::string failure_text(const Scene& scene, const StepResult& result);

}  // namespace cdot::play
