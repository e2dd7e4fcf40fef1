// One step of Newton's method for equations with more unknowns than equations, in plain doubles.
#pragma once

#include <vector>

namespace cdot::derive {

// A row per equation, a column per unknown.
using Gradients = std::vector<std::vector<double>>;

// The shortest dx with values + G dx = 0: dx = -G^T (G G^T + little)^-1 values. Dependent rows do
// no harm.
std::vector<double> shortest_step(const Gradients& G, const std::vector<double>& values);

}  // namespace cdot::derive
