// Bounds that grow with loads, as text: forces and loads are found together.
#pragma once

#include <string>

#include "derive/compile/methods/contents.hpp"

namespace cdot::compile {

// Of carry(), after its poses.
std::string arguments_of_carry(const Contents& has);
// cones: the first row of the cone of each row with bounds, or -1.
std::string settle_loads_of(const Contents& has, const std::string& cones);
// Its arguments for cones.
std::string corners(const Contents& has, const char* share = "s.share");

}  // namespace cdot::compile
