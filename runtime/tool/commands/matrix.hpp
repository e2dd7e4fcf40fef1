// `cdot-run diagnose --matrix`: the system's D with D v = 0 at the start of a scene, as text, as JSON and as a picture.
#pragma once

#include <string>

#include <cdot/jacobian.hpp>

#include "runtime/tool/scene/scene.hpp"

namespace cdot {

SystemMatrix system_matrix(const Scene& scene);

std::string matrix_text(const Scene& scene, const SystemMatrix& system);
std::string matrix_json(const Scene& scene, const SystemMatrix& system);
// Where K has entries, joint by joint, and beside it the conflict graph of the joints.
std::string matrix_svg(const Scene& scene, const SystemMatrix& system);

}  // namespace cdot
