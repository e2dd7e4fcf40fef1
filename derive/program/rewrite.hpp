// The base of all passes over programs: a copy in which some operations become others.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "derive/program/builder.hpp"

namespace cdot::derive {

// Copies the needed operations. `rewrite` receives an operation and the new indices of all operations; it builds a
// replacement, or returns nullopt to leave the operation as it is.
using Rewrite =
    std::function<std::optional<int>(ProgramBuilder&, const Operation&, int index, const std::vector<int>& new_index)>;
Program rewritten(const Program& program, const Rewrite& rewrite);

// Passes that compute a common pair once. Each takes the most frequent pair, the first of equals; nullopt if no pair
// occurs twice.
std::optional<Program> share_terms(const Program& program);    // x + ratio y
std::optional<Program> share_factors(const Program& program);  // x y

}  // namespace cdot::derive
