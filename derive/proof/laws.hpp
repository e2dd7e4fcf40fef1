// The laws that stand in files of their own, and how any law is judged.
#pragma once

#include <functional>

#include "derive/proof/ginac.hpp"
#include "derive/proof/prove.hpp"

namespace cdot::derive {

// A law that `check` may break; undecided if it throws, for GiNaC's text is not for the user.
Law judged(LawId id, const std::function<void(Law&)>& check);

// difference = 0, else the law fails at `where`; the first failure is the one that is told.
void require_zero(Law& law, Algebra& algebra, const ex& difference, const ScalarRow& row, const std::string& where);

// The law that needs a person's attention most often: J v = 0 for a common translation and a common rotation, at C = 0.
// `names` is over the route of that name.
void conserves_momentum(Law& law, const Joint& joint, const Block& block, Algebra& names);

// As many independent rows as are written: exact, without GiNaC.
void rows_are_independent(Law& law, const Block& block);

// The laws of what is specialised from a block. All else a variant has from the block itself, so a proof of the block
// and these laws cover every function of a kernel.
// C as in the block, J without the body's columns, K with its inverse mass and inertia zero.
Law variants_are_the_block(const Joint& joint, const Block& block);
// K of inverse inertias i and K of inverse inertias i E, of the block and of its variants; in space.
Law isotropic_is_the_block(const Joint& joint, const Block& block);

}  // namespace cdot::derive
