// step() of RATTLE as text, and what its effects need.
#pragma once

#include <string>
#include <vector>

#include "derive/compile/methods/contents.hpp"

namespace cdot::compile {

// tolerance: of C.
std::string rattle(double tolerance, const Contents& has);
// push(), by which ends act in the first half, if there are some.
std::string pushes_of(const Contents& has);
// start(), if `exerts`.
std::string start_of(const Contents& has);
// The numbers of rows, and find_rates(); effect_of: the effect of each row.
std::string damping_of(std::size_t rows, int effects, std::size_t triangle);
std::string find_rates_of(const std::vector<int>& effect_of);

}  // namespace cdot::compile
