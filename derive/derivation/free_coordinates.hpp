// Constrained coordinates: the joint's own rows leave them no freedom, as a weld does with the angle of its revolute.
// Only the derivatives show it: an included joint knows none of the rows beside it.
#pragma once

#include "derive/derivation/derivation.hpp"

namespace cdot::derive {

// Fills in `constrained_by` of the coordinates whose row of J is a combination of the equality and velocity rows, and
// moves those that came with an include to `dropped`. An inequality constrains no coordinate: a limit may stand beside
// it.
void drop_constrained_coordinates(Derivation& derivation);

// Errors about constrained coordinates that the spec itself declares.
std::vector<Diagnostic> errors_of_constrained_coordinates(const Joint& joint);

// "the row angle constrains it"
std::string constraint_text(const Coordinate& constrained);

}  // namespace cdot::derive
