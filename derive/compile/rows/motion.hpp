// The forces beside those of joints, as functions of the header: gravity, constant forces, drag and effects.
#pragma once

#include "derive/compile/rows/row_blocks.hpp"

namespace cdot::compile {

// Accelerations without joints, by the names of components. `at_rest`: of effects the forces at rates of 0; and no
// gyroscopic torques, for a step that keeps angular momenta.
Values free_accelerations(const RowBlocks& blocks, Algebra& algebra, bool at_rest = false);

// q, v, time -> a: these. Steps of RATTLE take effects at rest; their dampers act at its ends.
Program fall_of(const RowBlocks& blocks, Constants& constants);

// q, time -> E: potential energy of the effects.
Program potential_of(const RowBlocks& blocks, Constants& constants);

// q, time -> angle, turns: angles of effects in space, with their whole turns.
Program angles_of(const RowBlocks& blocks, Constants& constants);

}  // namespace cdot::compile
