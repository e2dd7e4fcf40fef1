// Rows with bounds by Runge-Kutta methods, as text: between two events each has a mode.
#pragma once

#include <string>

#include "derive/compile/methods/contents.hpp"

namespace cdot::compile {

// Types of a State's member `modes`, and of what is known of each row.
std::string modes_types(const Contents& has);
// The mode of each row, and accelerations in these modes. Of each row waits: whether it waits for an event; cones: as
// settle_loads_of() has it.
std::string modes_of(const Contents& has, const std::string& waits, const std::string& cones, const std::string& late,
                     double tolerance);
// Those of pull(), after the pose, the time and the velocities of a State.
std::string arguments_of_pull(const Contents& has);
// True if loads may end a row or a joint; the distance from such an event that counts as none.
bool yields_to_loads(const Contents& has);
inline constexpr const char* near_event = "T(single ? 1e-5 : 1e-10)";
// Of rows: the ends on which motors press, and these motors.
inline constexpr const char* pressed_and_standing = "const Mask (&pressed)[bounded], const Mask (&stands)[bounded], ";
// stop_what_hits().
std::string stops_of(const Contents& has);

}  // namespace cdot::compile
