// The scene whose bodies differ by about `size` of their numbers, each by another share: a run of it shows how errors
// of that size grow, also where a symmetric start hides it.
#pragma once

#include "runtime/tool/scene/scene.hpp"

namespace cdot {

// Masses alone: what is at rest stays there, and starts keep to joints and ends.
Scene with_disturbed_masses(Scene scene, double size);
// Masses and poses.
Scene disturbed(Scene scene, double size);

}  // namespace cdot
