// step() of RATTLE as text, with its ends.
#pragma once

#include <string>
#include <vector>

#include "derive/compile/methods/contents.hpp"

namespace cdot::compile {

// tolerance: of C.
std::string rattle(double tolerance, const Contents& has);
// The lines that leave out these rows, of velocities, in the first half.
std::string frees_of(const std::vector<int>& rows);
// push(), by which ends act in the first half, if there are some.
std::string pushes_of(const Contents& has);

}  // namespace cdot::compile
