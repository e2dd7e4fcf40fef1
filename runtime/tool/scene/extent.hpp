// The size of each mechanism of a scene, the yardstick for the error of its places.
#pragma once

#include <vector>

#include "runtime/tool/scene/scene.hpp"

namespace cdot {

struct Extents {
  // Of the mechanism that each body belongs to [m]: the diagonal of the box around its bodies, their shapes and the
  // points of its joints and springs at the start. 0: a single point.
  std::vector<double> of_body;
  std::vector<int> bodies;  // movable ones in that mechanism, by body
  int mechanisms = 0;       // bodies that joints or springs connect are one; immovable bodies connect nothing
};

Extents extents_of(const Scene& scene);

}  // namespace cdot
