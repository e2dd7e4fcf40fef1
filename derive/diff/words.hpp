// Names the error in a published expression: its kind, and a sentence with the reason for the right one.
#pragma once

#include <map>
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

// An undeclared condition under which the two are equal: "C = 0", "ratio = 1"; empty if none is found.
std::string hidden_assumption(const Joint& joint, const Poses& on_constraint, Expr hand, Expr generated,
                              const Poses& poses);

}  // namespace cdot::derive
