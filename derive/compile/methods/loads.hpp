// Bounds that grow with loads, as text: forces and loads are found together.
#pragma once

#include <string>

#include "derive/compile/methods/contents.hpp"

namespace cdot::compile {

// Of carry(), after its poses.
std::string arguments_of_carry(const Contents& has);
std::string settle_loads_of(const Contents& has);

}  // namespace cdot::compile
