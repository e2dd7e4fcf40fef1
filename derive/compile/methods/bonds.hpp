// Joints that break, as text.
#pragma once

#include <string>
#include <vector>

#include "derive/compile/methods/contents.hpp"
#include "derive/compile/scene/mechanism.hpp"

namespace cdot::compile {

// The type of State::bonds.
std::string bonds_type(const Mechanism& mechanism, std::size_t borne, const Contents& has);
std::string arguments_of_strain(const Mechanism& mechanism);
// Of bear() and bear_end(), after their velocities.
std::string arguments_of_bear(Method method);
std::string arguments_of_bear_end(const Contents& has);
inline constexpr const char* draws = "d = M^-1 (J^T lambda + R^T mu), R the rows that prescribe a rate";
// After its poses.
std::string arguments_of_draw(const Contents& has);
// The first row of each joint of the mechanism, and the number of all rows; the same of rows of effects, by joints that
// may break.
struct FirstRows {
  const std::vector<std::size_t>&of_joints, &borne;
};
// snap(), and share() in place, where methods share impulses among redundant rows. The arguments of snap() are the
// forces of rows of joints, of rows with bounds and of effects; by Runge-Kutta methods also the distance at which
// joints break. There choose_modes() of a mechanism without rows with bounds follows.
std::string snap_of(const Mechanism& mechanism, const FirstRows& rows, const Contents& has);
// By RATTLE and by the midpoint rule: what such effects do at the start of a step, and at its end. `end`: the array of
// their damping there.
std::string bears_at_start(const Contents& has);
std::string bears_at_end(const Contents& has, const std::string& end);
// By the midpoint rule: in its rounds, and what declares their results.
std::string declares_borne(const Contents& has);
std::string loads_in_round(const Contents& has);
// A line by which impulses are shared among redundant rows.
std::string shares(const Contents& has, const std::string& impulses);
// By Runge-Kutta methods: these forces at the end of a stride, and lines that find the margins of joints.
std::string forces_of_state(const Contents& has);
std::string margins_of_bonds(const Contents& has);

}  // namespace cdot::compile
