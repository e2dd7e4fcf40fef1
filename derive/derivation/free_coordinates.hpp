// Coordinates that a joint does not leave free, because its own rows hold them: a revolute's angle in a weld. Only what
// has been differentiated tells; rows that an include brings do not know of those that stand beside it.
#pragma once

#include "derive/derivation/derivation.hpp"

namespace cdot::derive {

// Fills in `held_by` of the coordinates whose row of J is a combination of the equality and velocity rows, and moves
// those that came with an include to `dropped`. An inequality holds nothing: a limit may stand beside a coordinate.
void drop_held_coordinates(Derivation& derivation);

// The coordinates that the spec itself declares and its rows hold, as errors.
std::vector<Diagnostic> held_errors(const Joint& joint);

// "the row angle holds it"
std::string held_text(const Coordinate& held);

}  // namespace cdot::derive
