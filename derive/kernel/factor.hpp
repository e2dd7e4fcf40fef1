// The factorisation of K and its solve, as outputs of kernel functions; and the names of array elements.
#pragma once

#include <string>
#include <vector>

#include "derive/derivation/derivation.hpp"
#include "derive/program/program.hpp"

namespace cdot::derive {

std::string element(const std::string& array, std::size_t i);  // "C[0]"
std::string triangle_element(const std::string& array, std::size_t i,
                             std::size_t j);  // of a lower triangle stored row by row

// K = L D L^T column by column: F holds L and, on the diagonal, D^-1.
std::vector<NamedExpr> factor_outputs(const Block& block);
// lambda = K^-1 rhs from F.
std::vector<NamedExpr> solve_outputs(const Block& block);

}  // namespace cdot::derive
