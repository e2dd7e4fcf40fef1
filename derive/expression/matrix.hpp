// Matrices of scalar expressions, as hand derivations write them.
// One without rows is a multiple of the identity, of the size that its place asks for; its factor is the only entry.
#pragma once

#include <vector>

#include "derive/expression/expr.hpp"

namespace cdot::derive {

struct Matrix {
  int rows = 0, columns = 0;
  std::vector<Expr> entries;  // row by row

  bool any_size() const { return rows == 0; }
  Expr at(int row, int column) const { return entries[static_cast<std::size_t>(row * columns + column)]; }
};

// u along axes, as a vector whose world components are these components.
Expr components_along(Expr u, const std::vector<Expr>& axes);
// Component 0, 1 or 2 along the world's axes.
Expr component(Expr u, std::size_t index);
// The component i, j of a symmetric tensor leaf: inv_I_a_xy.
Expr tensor_component(Expr tensor, std::size_t i, std::size_t j);
// A vector as a column of its components; a symmetric tensor leaf as the matrix of its components.
Matrix column_of(Expr vector);
Matrix tensor_matrix(Expr tensor);
// By cofactors; for small ones.
Matrix inverse(const Matrix& square);

}  // namespace cdot::derive
