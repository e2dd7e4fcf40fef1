// The mechanisms of a scene: bodies that joints and effects connect.
#pragma once

#include "derive/compile/scene/mechanism.hpp"

namespace cdot::compile {

// By body: the number of its mechanism, from 0; -1 for a body that does not move.
std::vector<int> groups_of(const Mechanism& mechanism);
// Of bodies of one mechanism, some of which move.
int group_of(const std::vector<int>& groups, const std::vector<int>& bodies);
// By row with bounds.
std::vector<int> groups_of_bounds(const Mechanism& mechanism);

}  // namespace cdot::compile
