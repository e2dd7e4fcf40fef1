// The sign that an expression has at every pose.
#pragma once

#include "derive/expression/expr.hpp"

namespace cdot::derive {

// True for sums of squares, lengths and positive numbers, and what is made of them. False if that is unknown.
bool is_never_negative(Expr e);

}  // namespace cdot::derive
