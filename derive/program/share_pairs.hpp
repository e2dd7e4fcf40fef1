// The passes that compute once what occurs in many sums or products: each takes the most frequent pair, the first of
// equals, and says nullopt if no pair occurs twice.
#pragma once

#include <optional>

#include "derive/program/program.hpp"

namespace cdot::derive {

std::optional<Program> share_terms(const Program& program);    // x + ratio y
std::optional<Program> share_factors(const Program& program);  // x y

}  // namespace cdot::derive
