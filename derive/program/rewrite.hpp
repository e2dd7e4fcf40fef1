// The base of all passes over programs: a copy in which some operations become others.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "derive/program/graph.hpp"

namespace cdot::derive {

// The new indices of operations.
struct Moved {
  std::vector<int> to;
  int operator()(int op) const { return to[static_cast<std::size_t>(op)]; }
};
using Made = std::optional<int>;

// Copies the needed operations. `rewrite` receives an operation and its index; it builds a replacement and returns that
// one's index, or nullopt to leave the operation as it is.
using Rewrite = std::function<Made(ProgramBuilder&, const Operation&, int index, const Moved& at)>;
Program rewritten(const Program& program, const Rewrite& rewrite);

// A pass: nullopt where it would give the same program.
using Passed = std::optional<Program>;

// Passes that compute a common pair once. They begin with the most frequent pair, the first of equals, and end where no
// pair occurs twice or the effort is spent.
Passed share_terms(const Program& program, Effort& effort);    // x + ratio y
Passed share_factors(const Program& program, Effort& effort);  // x y
// a x + b x = x (a + b). Begins with the factor that most terms of a sum have.
Passed take_out_factors(const Program& program, Effort& effort);

// Openings cost by themselves, but from there the search may find a cheaper program; nullopt if there is nothing to
// open. 2 x y with the factor 2, which then is shared and taken out as any other: (2 x) y + (2 x) z.
std::optional<Program> with_numbers_as_factors(const Program& program);
// k (x + y) as k x + k y: what is taken out of the terms later may be shared.
std::optional<Program> distributed(const Program& program);
// u . u - k h with h = t . u as u_x^2 - k t_x u_x + u_y^2 - ...: its terms give u_x (u_x - k t_x) + ..., and a gradient
// has those differences.
std::optional<Program> with_products_beside_squares_opened(const Program& program);

}  // namespace cdot::derive
