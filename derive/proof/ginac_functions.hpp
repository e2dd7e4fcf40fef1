// Our functions as GiNaC's, and back.
#pragma once

#include <optional>
#include <span>

#include "derive/expression/functions.hpp"
#include "derive/proof/ginac_names.hpp"

namespace cdot::derive {

// Of those that GiNaC has; the others are written by these (Function::by_others).
ex ginac_function(Fn fn, std::span<const ex> args);
// The function that e is a call of, if it is one.
std::optional<Fn> function_in(const ex& e);

}  // namespace cdot::derive
