// Names the error in a published expression: its kind, and a sentence with the reason for the right one.
#pragma once

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <map>
#include <numeric>
#include <string>
#include <vector>

#include "derive/diff/diff.hpp"
#include "derive/diff/poses.hpp"

namespace cdot::derive {

// The origin of a term of J: one leaf that moves with a body.
struct Contribution {
  Expr leaf, term;
};

// The sentence where no formula fits.
constexpr const char* not_generated = "it is not the generated one";
// Of two columns of J that differ alike.
constexpr const char* and_opposite = " and, with the opposite sign, ";

struct Place {
  std::string what, row, column;      // as in Difference
  std::vector<Contribution> sources;  // of an entry of J, or of Cdot
  std::vector<Expr> elsewhere;        // the generated entries of the other bodies in the same row
  const Joint* joint = nullptr;
};

// A confusion of two bodies, or arms, in one class of symbols: masses, inertias, velocities.
struct Exchange {
  std::map<const Node*, Expr> replacements;  // that undo it, or make it
  std::string words;                         // "rb stands where ra belongs"
};
std::vector<Exchange> exchanges(const Joint& joint);

// "J, row 1, w_b"; "K, row 2, column 1"; "Cdot, row line".
std::string name_of(const Place& place);

// Fills kind, texts and sentence. `poses` decide equality.
Difference describe_difference(const Place& place, Expr hand, Expr generated, const Poses& poses);

// The axis that the spec calls f.x is a leaf f_x.
std::string in_names_of_spec(std::string text, const Joint& joint);

// Component i of a vector formula, as the formula: "-cross(ra, n).x" as "-cross(ra, n)". An axis of the world stays.
std::string without_component(const std::string& text, std::size_t i);

// An undeclared condition under which the two are equal: "C = 0", "ratio = 1"; empty if none is found.
std::string hidden_assumption(const Joint& joint, const Poses& on_constraint, Expr hand, Expr generated,
                              const Poses& poses);

// Orders of rows, columns and bodies.
using Order = std::vector<int>;

// "1 and 2", "1, 2 and 3"
inline std::string joined_by_and(const std::vector<std::string>& names) {
  if (names.size() == 1) return names[0];
  return fmt::format("{} and {}", fmt::join(names.begin(), names.end() - 1, ", "), names.back());
}

// Calls `tried(order)` with all orders of 0 ... n-1 but the first, until it returns true.
template <class Tried>
bool any_order(int n, Tried tried) {
  Order order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), 0);
  while (std::next_permutation(order.begin(), order.end()))
    if (tried(order)) return true;
  return false;
}

// "rows 1 and 2 are exchanged", "the columns of a and b are exchanged", "rows stand in the order 2, 3, 1".
inline std::string words_of(const Order& order, const std::string& what, const std::vector<std::string>& names) {
  std::vector<std::string> moved, all;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const auto from = static_cast<std::size_t>(order[i]);
    all.push_back(names[from]);
    if (from != i) moved.push_back(names[i]);
  }
  if (moved.size() == 2) return fmt::format("{} {} are exchanged", what, joined_by_and(moved));
  return fmt::format("{} stand in the order {}", what, fmt::join(all, ", "));
}

}  // namespace cdot::derive
