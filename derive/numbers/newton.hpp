// Newton's method for equations with more unknowns than equations, in doubles. It finds poses with C = 0, or poses that
// satisfy an author's assumptions.
#pragma once

#include <functional>
#include <vector>

#include "derive/numbers/numeric.hpp"

namespace cdot::derive {

// A row per equation, a column per unknown.
using Gradients = std::vector<std::vector<double>>;

// The shortest dx with values + G dx = 0: dx = -G^T (G G^T + eps E)^-1 values. Redundant rows do no harm.
std::vector<double> shortest_step(const Gradients& G, const std::vector<double>& values);

// The triads of a sample, ordered by name: the order of addresses changes from run to run.
std::vector<const Triad*> triads_of(const Joint& joint, const Sample& sample);

// Moves a sample to where all equations are zero; false if that does not get there.
// With `J`, an entry per column of each body, only bodies move. Else everything may: bodies, parameters, and what is
// fixed in a body; the gradients are then central differences.
bool move_to_zero(const Joint& joint, const std::vector<Expr>& equations, Sample& sample,
                  const std::vector<std::vector<Expr>>& J = {});
// The same for any numbers of a sample, by central differences.
using Residuals = std::function<std::vector<double>(const Sample&)>;
bool move_to_zero(const Joint& joint, const Residuals& residuals, Sample& sample, bool only_bodies);

}  // namespace cdot::derive
