// `cdot-run jacobian`: the system's D with D v = 0 at the start of a scene, as text, as JSON and as
// a picture.
#pragma once

#include <string>

#include <cdot/jacobian.hpp>

#include "runtime/tool/scene/scene.hpp"

namespace cdot {

SystemMatrix system_matrix(const Scene& scene);

std::string jacobian_text(const Scene& scene, const SystemMatrix& system);
std::string jacobian_json(const Scene& scene, const SystemMatrix& system);
// Where K has entries, joint by joint, and beside it the conflict graph of the joints.
std::string jacobian_svg(const Scene& scene, const SystemMatrix& system);

}  // namespace cdot
