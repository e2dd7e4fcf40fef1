// Laws with files of their own, and the judgement of any law.
#pragma once

#include <functional>

#include "derive/proof/ginac.hpp"
#include "derive/proof/prove.hpp"

namespace cdot::derive {

// Runs `check`, which may break the law. If it throws, the law is undecided; users never see GiNaC's text.
Law judged(LawId id, const std::function<void(Law&)>& check);

// Requires difference = 0; else the law fails at `where`. The first failure is reported.
void require_zero(Law& law, Algebra& algebra, const ex& difference, const ScalarRow& row, const std::string& where);

// A row of J times a common motion of all bodies: a unit velocity, and a unit spin about the origin.
struct Felt {
  Expr translation;  // sum of J_v, a vector
  Expr rotation;     // sum of J_w + x cross J_v, since v = w cross x; in space a vector
};
Felt felt_by(const std::vector<JacobianEntry>& J, const Joint& joint);

// J v = 0 for a common translation and a common rotation, at C = 0. Authors break this law most often. `names` has the
// route of that name.
void conserves_momentum(Law& law, const Joint& joint, const Block& block, Algebra& names);

// The last three laws of LawId.
std::vector<Law> laws_of_effect(const Derivation& derivation);

// No row is redundant: exact, without GiNaC.
void rows_are_independent(Law& law, const Block& block);

// The laws of specialised blocks. A variant inherits everything else from the block. So a proof of the block and these
// laws cover every function of a kernel.
// C as in the block, J without the body's columns, K with its inverse mass and inertia zero.
Law variants_are_the_block(const Joint& joint, const Block& block);
// K of inverse inertias i and K of inverse inertias i E, of the block and of its variants; in space.
Law isotropic_is_the_block(const Joint& joint, const Block& block);

}  // namespace cdot::derive
