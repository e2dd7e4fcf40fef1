// Steps of Runge-Kutta methods with rows that have bounds, as text: one that passes an event ends there, and goes on
// with other modes.
#pragma once

#include <string>

#include "derive/compile/methods/contents.hpp"

namespace cdot::compile {

// step(), which ends strides at events.
std::string step_by_events(const Contents& has);

}  // namespace cdot::compile
