// The end of a step as text: C = 0 and J v = -dC/dt.
#pragma once

#include <string>

#include "derive/compile/methods/contents.hpp"

namespace cdot::compile {

// close() and project(); `renew`: lines that set inertias in the lanes of `renews`.
std::string corrections_of(double tolerance, const Contents& has, const std::string& renew);

}  // namespace cdot::compile
