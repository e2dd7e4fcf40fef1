// A Scene -> TOML text that reads back as the same Scene to the bit, without shapes and traces.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "runtime/tool/scene/scene.hpp"

namespace cdot::torture {

// The reader does not keep -0, so the scene must not contain it (plain_zeros). Frames in space have two axes in the
// text: their parameters must have three or six numbers.
std::string text_of(const Scene& scene);
// The files beside it: name and text of each table that a number follows.
std::vector<std::pair<std::string, std::string>> tables_of(const Scene& scene);
// Both, read back; the tables lie in a folder of their own for that time.
Scene copy_of(const Scene& scene);

// Replaces every -0 by 0.
void plain_zeros(Scene& scene);

}  // namespace cdot::torture
