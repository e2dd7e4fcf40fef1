// GiNaC, its most frequent names, and our functions as GiNaC's and back.
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

// Equality for hash tables. Unlike is_equal(), compare() makes equal parts one, so each pair is compared once.
struct SameExpression {
  bool operator()(const ex& a, const ex& b) const { return a.compare(b) == 0; }
};

// For functions that GiNaC has; the table expresses all others by them (Function::by_others).
ex ginac_function(Fn fn, std::span<const ex> args);
// The function that e is a call of, if it is one.
std::optional<Fn> function_in(const ex& e);

}  // namespace cdot::derive
