// Loads shared among redundant rows of joints, as a function of the header.
#pragma once

#include "derive/compile/rows/joint_rows.hpp"

namespace cdot::compile {

// J, lambda -> shared: of all impulses that move the bodies as lambda does, those of the least sum of squares. Rows
// count that are redundant at the start. As the World does it: runtime/direct/least_squares.cpp.
Program share_of(const JointRows& joints, Constants& constants);

}  // namespace cdot::compile
