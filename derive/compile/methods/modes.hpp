// Rows with bounds by Runge-Kutta methods, as text: between two events each has a mode.
#pragma once

#include <string>

#include "derive/compile/methods/contents.hpp"

namespace cdot::compile {

// Types of a State's member `modes`, and of what is known of each row.
std::string modes_types(const Contents& has);
// The mode of each row, and accelerations in these modes; waits: of each row whether it waits for an event.
std::string modes_of(const Contents& has, const std::string& waits);
// Those of pull(), after the pose, the time and the velocities of a State.
std::string arguments_of_pull(const Contents& has);

}  // namespace cdot::compile
