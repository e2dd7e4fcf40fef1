// Newton's method for equations with more unknowns than equations, in plain doubles: the search for poses where
// equations hold, C = 0 or what an author assumes.
#pragma once

#include <vector>

#include "derive/numbers/numeric.hpp"

namespace cdot::derive {

// A row per equation, a column per unknown.
using Gradients = std::vector<std::vector<double>>;

// The shortest dx with values + G dx = 0: dx = -G^T (G G^T + little)^-1 values. Dependent rows do no harm.
std::vector<double> shortest_step(const Gradients& G, const std::vector<double>& values);

std::vector<double> values_at(const Joint& joint, const std::vector<Expr>& scalars, const Sample& sample);
// The triads of a sample by the order of their names: that of their addresses changes from run to run.
std::vector<const Triad*> triads_of(const Joint& joint, const Sample& sample);

// Moves a sample to where all equations are zero; false if that does not get there.
// With `J`, an entry per column of each body, only bodies move. Else everything may: bodies, parameters, and what is
// fixed in a body; the gradients are then central differences.
bool move_to_zero(const Joint& joint, const std::vector<Expr>& equations, Sample& sample,
                  const std::vector<std::vector<Expr>>& J = {});

}  // namespace cdot::derive
