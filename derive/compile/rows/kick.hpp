// The kick of joints and effects, as functions of the header: accelerations, and an Euler step.
#pragma once

#include "derive/compile/rows/joint_rows.hpp"

namespace cdot::compile {

// q, v, time, J -> a and lambda: M a = f + J^T lambda with J a = gamma.
Program accelerations_of(const RowBlocks& blocks, const JointRows& joints, Constants& constants);

// q, v, time, J, h -> next: v after an Euler step of h with effects, and lambda of the joints. With rows that have
// bounds, these are without their impulses, and B holds the system that gives them.
Program kick_of(const RowBlocks& blocks, const JointRows& joints, Constants& constants);

// q, time, J -> B.g and B.S for rows with ends, without effects: their part in a projection.
Program reach_of(const RowBlocks& blocks, const JointRows& joints, Constants& constants);

// q, time -> past: errors of rows with bounds.
Program past_of(const RowBlocks& blocks, Constants& constants);

// q, v, time -> along: J v of rows with bounds.
Program along_of(const RowBlocks& blocks, Constants& constants);

}  // namespace cdot::compile
