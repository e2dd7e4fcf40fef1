// `cdot-run diagnose --matrix`: a scene -> D of its start, D v = 0, as text, JSON and a picture.
#pragma once

#include <string>

#include <cdot/jacobian.hpp>

#include "runtime/tool/scene/scene.hpp"

namespace cdot {

SystemMatrix system_matrix(const Scene& scene);

std::string matrix_text(const Scene& scene, const SystemMatrix& system);
std::string matrix_json(const Scene& scene, const SystemMatrix& system);
// The sparsity of K, and the conflict graph of the joints on a circle, each joint in its colour.
std::string matrix_svg(const Scene& scene, const SystemMatrix& system);

}  // namespace cdot
