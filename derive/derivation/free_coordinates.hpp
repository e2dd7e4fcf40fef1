// Coordinates that a joint does not leave free, because its own rows hold them: a revolute's angle
// in a weld.
//
// Only what has been differentiated tells, so this comes after the reader; rows that an include
// brings do not know of those that stand beside it.
#pragma once

#include <vector>

#include "derive/language/joint.hpp"

namespace cdot::derive {

// Those whose row of J is a combination of the equality and velocity rows, with `held_by` filled
// in. An inequality holds nothing: a limit may stand beside a coordinate.
std::vector<Coordinate> held_coordinates(const Joint& joint);

// Moves those that came with an include to `dropped`.
void drop_held_coordinates(Joint& joint);

// What is wrong with a held coordinate that the spec itself declares.
Diagnostic held_error(const Coordinate& held);

// "the row angle holds it"
std::string held_text(const Coordinate& held);

}  // namespace cdot::derive
