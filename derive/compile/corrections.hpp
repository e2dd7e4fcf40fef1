// The end of a step as text: C = 0 and J v = -dC/dt; and the impulses of rows with bounds.
#pragma once

#include <string>

#include "derive/compile/methods/contents.hpp"

namespace cdot::compile {

// close() and project(); `renew`: lines that set inertias in the lanes of `renews`.
std::string corrections_of(double tolerance, const Contents& has, const std::string& renew);
// largest(), and for rows with bounds struct Bounded, divide() and settle(). is_rate: "true, false", by row.
std::string bounded_of(const std::string& is_rate, const Contents& has);

}  // namespace cdot::compile
