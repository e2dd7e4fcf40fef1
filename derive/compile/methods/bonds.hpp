// Joints that break, as text.
#pragma once

#include <string>
#include <vector>

#include "derive/compile/methods/contents.hpp"
#include "derive/compile/scene/mechanism.hpp"

namespace cdot::compile {

// The type of State::bonds.
std::string bonds_type(const Mechanism& mechanism, const Contents& has);
std::string arguments_of_strain(const Mechanism& mechanism);
inline constexpr const char* draws = "d = M^-1 (J^T lambda + R^T mu), R the rows that prescribe a rate";
// After its poses.
std::string arguments_of_draw(const Contents& has);
// snap(); rows: the first row of each joint of the mechanism, and the number of all rows. Its arguments are the forces
// of these rows and of rows with bounds; by Runge-Kutta methods also the distance at which joints break. There
// choose_modes() of a mechanism without rows with bounds follows.
std::string snap_of(const Mechanism& mechanism, const std::vector<std::size_t>& rows, const Contents& has);
// By Runge-Kutta methods: these forces at the end of a stride, and lines that find the margins of joints.
std::string forces_of_state(const Contents& has);
std::string margins_of_bonds(const Contents& has);

}  // namespace cdot::compile
