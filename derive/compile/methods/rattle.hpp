// step() of RATTLE as text, with its start and its ends.
#pragma once

#include <string>

#include "derive/compile/methods/contents.hpp"

namespace cdot::compile {

// tolerance: of C.
std::string rattle(double tolerance, const Contents& has);
// push(), by which ends act in the first half, if there are some.
std::string pushes_of(const Contents& has);
// start(), if `exerts`.
std::string start_of(const Contents& has);

}  // namespace cdot::compile
