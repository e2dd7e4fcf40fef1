// The impulses of rows with bounds as text: those at a bound, and those that prescribe their rates.
#pragma once

#include <string>

#include "derive/compile/methods/contents.hpp"

namespace cdot::compile {

// largest(), and for rows with bounds struct Bounded, divide() and settle(). is_rate: "true, false", by row.
std::string bounded_of(const std::string& is_rate, const Contents& has);

}  // namespace cdot::compile
