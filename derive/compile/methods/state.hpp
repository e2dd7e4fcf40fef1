// The structs State and Evaluated as text.
#pragma once

#include <string>

#include "derive/compile/methods/contents.hpp"
#include "derive/compile/scene/mechanism.hpp"

namespace cdot::compile {

std::string state_of(const Mechanism& mechanism, const Contents& has, bool inputs);

// Lines of reset(): numbers of a State that begin() keeps.
std::string reset_of(const Contents& has);

}  // namespace cdot::compile
