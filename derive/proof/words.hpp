// Expressions in the words of the spec, and where those words stand in it: for messages of proofs and checks.
#pragma once

#include <set>
#include <span>
#include <string>
#include <vector>

#include "derive/language/joint.hpp"

namespace cdot::derive {

// As the author would write it: by its own name if it has one, else with angle(a) for theta_a, x(a) for x_a.
std::string said(Expr e, const Joint& joint);

// The equation that holds u at zero: `pa = pb` if u is pa - pb, else `u = 0`.
std::string vanishing_vector(Expr u, const Joint& joint);

// Where the words stand in this part of the file, as whole words, in order.
std::vector<Span> occurrences(const SourceFile& file, Span where, const std::set<std::string>& words);

}  // namespace cdot::derive
