// Expressions in the words of the spec, and the places of those words: for messages of proofs and checks.
#pragma once

#include <set>
#include <span>
#include <string>
#include <vector>

#include "derive/language/joint.hpp"

namespace cdot::derive {

// The expression as its author would write it: its name if it has one, else with angle(a) for theta_a, x(a) for x_a.
std::string spec_text(Expr e, const Joint& joint);

// The equation u = 0: `pa = pb` if u is pa - pb, else `u = 0`.
std::string vanishing_vector(Expr u, const Joint& joint);

// The places of these words, as whole words, in a part of the file.
std::vector<Span> occurrences(const SourceFile& file, Span where, const std::set<std::string>& words);

}  // namespace cdot::derive
