// The integrator of a scene that fixes its step and names none.
#pragma once

#include "runtime/tool/scene/scene.hpp"

namespace cdot {

// Picks it by what the islands are (<cdot/recommended.hpp>), with Scene::why_integrator. A scene that names one, or
// chooses its method by an accuracy, or needs Euler's for its solver or drift, stays as it is.
Scene with_integrator(Scene scene);

}  // namespace cdot
