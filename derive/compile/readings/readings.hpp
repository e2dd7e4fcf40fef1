// Readings of a state: the coordinates that joints leave free, and the loads that joints carry.
#pragma once

#include <string>
#include <vector>

#include "derive/compile/rows/joint_rows.hpp"

namespace cdot::compile {

// "hinge.angle": of the joints of the scene that are rows, in their order.
std::vector<std::string> coordinates_of(const Mechanism& mechanism);
// The names of these joints in C++.
std::vector<std::string> joints_of(const Mechanism& mechanism, const Names& names);

// q, v, time -> value, rate: the coordinates and their rates.
Program read_coordinates(const RowBlocks& blocks, Constants& constants);
// q, time, lambda -> load: J^T lambda of each joint on its last body, whose torque is about the centre of mass.
Program read_reactions(const RowBlocks& blocks, const JointRows& joints, Constants& constants);

}  // namespace cdot::compile
