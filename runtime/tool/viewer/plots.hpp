// The sensors of a film as plots over time.
#pragma once

#include <string>
#include <vector>

#include "runtime/tool/run/frame.hpp"
#include "runtime/tool/scene/scene.hpp"

namespace cdot {

// One panel for each unit, with axes, ticks and a legend; light and dark.
std::string plots_svg(const Scene& scene, const std::vector<Frame>& film);

}  // namespace cdot
