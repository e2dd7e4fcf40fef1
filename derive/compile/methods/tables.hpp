// Numbers that follow tables of time as text, and steps in parts that end where such a number jumps.
#pragma once

#include <string>

#include "derive/compile/methods/contents.hpp"
#include "derive/compile/scene/mechanism.hpp"

namespace cdot::compile {

// table_0() and so on; next_break(), if a table breaks.
std::string tables_of(const Mechanism& mechanism);
// True if steps end at times of a table.
bool breaks(const Mechanism& mechanism);
// step() by advance(), the step of the method.
std::string step_in_parts(Method method, const Contents& has);

}  // namespace cdot::compile
