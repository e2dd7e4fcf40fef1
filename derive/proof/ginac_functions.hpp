// GiNaC, those of its names that stand on almost every line, and our functions as GiNaC's and back.
#pragma once

#include <ginac/ginac.h>
#include <optional>
#include <span>

#include "derive/expression/functions.hpp"

namespace cdot::derive {

using GiNaC::ex;
using GiNaC::ex_to;
using GiNaC::is_a;
using GiNaC::numeric;

// Of those that GiNaC has; the others are written by these (Function::by_others).
ex ginac_function(Fn fn, std::span<const ex> args);
// The function that e is a call of, if it is one.
std::optional<Fn> function_in(const ex& e);

}  // namespace cdot::derive
