// Rows with bounds by Runge-Kutta methods, as text: between two events each has a mode; a step that passes an event
// ends there, and goes on with other modes.
#pragma once

#include <string>

#include "derive/compile/methods/contents.hpp"

namespace cdot::compile {

// The members of a State, and their types.
extern const char* const modes_type;
// The mode of each row, and accelerations in these modes; waits: of each row whether it waits for an event.
std::string modes_of(const Contents& has, const std::string& waits);
// step(), which ends strides at events.
extern const char* const step_by_events;

}  // namespace cdot::compile
