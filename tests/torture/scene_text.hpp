// A Scene as the TOML text that reads back as the same Scene, to the bit: what is drawn (shapes, traces) left out.
#pragma once

#include <string>

#include "runtime/tool/scene/scene.hpp"

namespace cdot::torture {

// The reader knows no -0: no number of the scene may be one (plain_zeros). Frames in space are written by two axes:
// their parameters must have three or six numbers.
std::string text_of(const Scene& scene);

// Every -0 becomes 0.
void plain_zeros(Scene& scene);

}  // namespace cdot::torture
