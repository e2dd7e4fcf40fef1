// step() of the implicit midpoint rule as text.
#pragma once

#include <string>

#include "derive/compile/methods/contents.hpp"
#include "derive/compile/scene/mechanism.hpp"

namespace cdot::compile {

std::string implicit(const Mechanism& mechanism, const Contents& has);

}  // namespace cdot::compile
