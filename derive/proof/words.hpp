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

// The same for messages: the beginning of a long one, and only the size of one that is too large to be written.
std::string brief_spec_text(Expr e, const Joint& joint);

// The same for messages that e vanishes: without a factor, as a sign or 1/2, that makes no difference.
std::string zero_text(Expr e, const Joint& joint);

// In space, u parallel to v by two rows: `cross(f.x, v) = 0 keep 2`, if one of them is an axis of a frame, or a
// direction that may become one (then with the frame to declare). Else empty.
std::string parallel(Expr u, Expr v, const Joint& joint);

// The equation u = 0: `pa = pb` if u is pa - pb, two rows if it is a cross product in space, else `u = 0`.
std::string vanishing_vector(Expr u, const Joint& joint);

// The places of these words, as whole words, in a part of the file.
std::vector<Span> occurrences(const SourceFile& file, Span where, const std::set<std::string>& words);

}  // namespace cdot::derive
