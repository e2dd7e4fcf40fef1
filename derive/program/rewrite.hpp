// The base of all passes over programs: a copy in which some operations become others.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "derive/program/builder.hpp"

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

// Passes that compute a common pair once. Each takes the most frequent pair, the first of equals; nullopt if no pair
// occurs twice.
std::optional<Program> share_terms(const Program& program);    // x + ratio y
std::optional<Program> share_factors(const Program& program);  // x y

}  // namespace cdot::derive
