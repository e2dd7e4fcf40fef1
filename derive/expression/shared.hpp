// Parts of large expressions that deserve a name. Written out, what is shared is repeated for each path that leads to
// it: nested names without names for their slopes double a formula each time.
#pragma once

#include "derive/expression/expr.hpp"

namespace cdot::derive {

// The parts that occur more than once, operands before users, such that these names shorten `roots`; none while all
// roots together are short. `named`: has a name already.
std::vector<Expr> shared_parts(std::span<const Expr> roots, bool (*named)(Expr));

// Parts of poses that stand in several places of short formulas and are long enough to read once, likewise: a divisor.
std::vector<Expr> recurring_parts(std::span<const Expr> roots, bool (*named)(Expr));

// The nodes of e as it is written out, where a part with a name of its own is one.
double written_size(Expr e, bool (*named)(Expr));

}  // namespace cdot::derive
