// The loads of joints and of rows with bounds in steps of Euler's method and of RATTLE, as text: all impulses of a
// step, those of corrections among them.
#pragma once

#include <string>

#include "derive/compile/methods/contents.hpp"

namespace cdot::compile {

// Of close(): the impulses of its displacements, as arguments, as what declares them for a call, and its parameters.
std::string gained(const Contents& has);
std::string declares_gained(const Contents& has);
std::string parameters_of_gained(const Contents& has);
// Lines of its rounds: before rows with ends take part, and after.
std::string gains_of_rows(const Contents& has);
std::string gains_of_ends(const Contents& has);
// The head of project(), which tells the impulses.
std::string project_with_impulses();

// The impulses of rows with bounds in Euler's step, and its end.
std::string settles_impulses(const Contents& has);
std::string euler_weighs(const Contents& has);

// By RATTLE: the first half, its ends, those of a half that fails, rows with bounds before their solution at the end
// and after it, the end of a step, and the start of a run.
std::string weighs_first_half(const Contents& has);
std::string weighs_end_changes(const Contents& has);
std::string weighs_failures(const Contents& has);
std::string sticking_rows(const Contents& has);
std::string sticking_rows_at_start(const Contents& has);
std::string bounds_of_clutches(const Contents& has);
std::string weighs_bounds(const Contents& has);
std::string rattle_weighs(const Contents& has);
std::string repeats_at_start(const Contents& has);
// Impulses of rows with bounds at the start of a run that act in its first half step.
std::string repeats_of_start(const Contents& has);
// Rows whose bounds grow with loads: at the end, and at the start of a run.
std::string settles_end_with_loads(const Contents& has);
std::string settles_start_with_loads(const Contents& has);

}  // namespace cdot::compile
