// step() of RATTLE as text.
#pragma once

#include <string>

#include "derive/compile/methods/contents.hpp"

namespace cdot::compile {

// tolerance: of C.
std::string rattle(double tolerance, const Contents& has);

}  // namespace cdot::compile
