// What moves bodies beside joints, as functions of the header: gravity, constant forces, drag and effects.
#pragma once

#include "derive/compile/rows/joint_rows.hpp"

namespace cdot::compile {

// q, v, time -> a: accelerations without joints.
Program fall_of(const RowBlocks& blocks, Constants& constants);

// q, time -> E: potential energy of the effects.
Program potential_of(const RowBlocks& blocks, Constants& constants);

// q, v, time, J, h -> next: v after an Euler step of h with effects; lambda of the joints.
Program kick_of(const RowBlocks& blocks, const JointRows& joints, Constants& constants);

}  // namespace cdot::compile
