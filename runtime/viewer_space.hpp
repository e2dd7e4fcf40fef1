// What is drawn of a scene in space, as the data of its page: faces and lines on bodies, links
// between points, pins, traces and a floor to see the depth by.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "runtime/run_frame.hpp"
#include "runtime/scene.hpp"

namespace cdot {

nlohmann::ordered_json space_marks(const Scene& scene, const std::vector<Frame>& film);

}  // namespace cdot
