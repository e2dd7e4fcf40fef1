// The rates of effects at the end of a step, as text: by RATTLE and by the midpoint rule.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace cdot::compile {

// The numbers of rows, and find_rates(); effect_of: the effect of each row.
std::string damping_of(std::size_t rows, int effects, std::size_t triangle);
std::string find_rates_of(const std::vector<int>& effect_of);

}  // namespace cdot::compile
