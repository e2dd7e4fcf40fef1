// The laws of what is specialised from a block: C, J and K of its variants, K of isotropic bodies. All else a variant
// has from the block itself, so a proof of the block and these laws cover every function of a kernel.
#pragma once

#include "derive/proof/prove.hpp"

namespace cdot::derive {

// C as in the block, J without the body's columns, K with its inverse mass and inertia zero.
Law variants_are_the_block(const Joint& joint, const Block& block);

// K of inverse inertias i and K of inverse inertias i E, of the block and of its variants; in space.
Law isotropic_is_the_block(const Joint& joint, const Block& block);

}  // namespace cdot::derive
