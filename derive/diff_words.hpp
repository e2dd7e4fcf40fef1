// Names what is wrong with a published expression: its kind, and a sentence that says why the right one is right.
#pragma once

#include <string>
#include <vector>

#include "derive/diff.hpp"
#include "derive/diff_poses.hpp"

namespace cdot::derive {

// hand - generated, in the spec's names and as short as expanding and collecting makes it.
Expr difference_of(Expr hand, Expr generated);

// What a term of J may stem from: one leaf that moves with a body.
struct Contribution {
  Expr leaf, term;
};

struct Place {
  std::string what, row, column;       // as in Difference
  std::vector<Contribution> sources;   // of a J entry
  std::vector<Expr> elsewhere;         // the generated entries of the other bodies in the same row
  const Joint* joint = nullptr;
};

// Fills kind, texts and sentence. `poses` decide what equals what.
Difference describe_difference(const Place& place, Expr hand, Expr generated, const Poses& poses);

// A condition that nobody declared and under which the two are equal: "C = 0", "ratio = 1"; empty if none is found.
std::string hidden_assumption(const Joint& joint, const std::vector<Expr>& constraints, Expr hand,
                              Expr generated, const Poses& poses);

}  // namespace cdot::derive
