// Bounds that grow with loads, as text: forces and loads are found together.
#pragma once

#include <string>

#include "derive/compile/methods/contents.hpp"

namespace cdot::compile {

std::string settle_loads_of(const Contents& has);

}  // namespace cdot::compile
