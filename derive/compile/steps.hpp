// step() of each method as text.
#pragma once

#include <string>

#include "derive/compile/mechanism.hpp"

namespace cdot::compile {

std::string step_of(Method method);

}  // namespace cdot::compile
