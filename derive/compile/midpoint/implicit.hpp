// step() of the implicit midpoint rule as text.
#pragma once

#include <string>

#include "derive/compile/methods/contents.hpp"
#include "derive/compile/scene/mechanism.hpp"

namespace cdot::compile {

// Of improve(), after those of its poses and velocities.
std::string arguments_of_improve(const Contents& has);
std::string implicit(const Mechanism& mechanism, const Contents& has);

}  // namespace cdot::compile
