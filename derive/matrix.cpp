#include "derive/matrix.hpp"

#include <algorithm>

#include "derive/value.hpp"

namespace cdot::derive {
namespace {

// m without one row and one column.
Matrix minor_of(const Matrix& m, int row, int column) {
  Matrix r{m.rows - 1, m.columns - 1, {}};
  for (int i = 0; i < m.rows; ++i)
    for (int j = 0; j < m.columns; ++j)
      if (i != row && j != column) r.entries.push_back(m.at(i, j));
  return r;
}

Expr determinant(const Matrix& m) {
  if (m.rows == 1) return m.at(0, 0);
  Expr sum = m.at(0, 0)->pool->number(0);
  for (int j = 0; j < m.columns; ++j) {
    const Expr part = m.at(0, j) * determinant(minor_of(m, 0, j));
    sum = j % 2 == 0 ? sum + part : sum - part;
  }
  return sum;
}

}  // namespace

Matrix inverse(const Matrix& m) {
  const Expr factor = pow(determinant(m), -1), one = m.at(0, 0)->pool->number(1);
  Matrix r{m.rows, m.columns, {}};
  for (int i = 0; i < m.rows; ++i)
    for (int j = 0; j < m.columns; ++j) {
      const Expr cofactor = m.rows == 1 ? one : determinant(minor_of(m, j, i));
      r.entries.push_back(factor * ((i + j) % 2 == 0 ? cofactor : -cofactor));
    }
  return r;
}

Expr tensor_component(Expr tensor, std::size_t i, std::size_t j) {
  const char first = "xyz"[std::min(i, j)], second = "xyz"[std::max(i, j)];
  return tensor->pool->symbol(tensor->symbol + "_" + first + second, tensor->role, tensor->body);
}

Matrix column_of(Expr vector) {
  const int n = vector->pool->dimension();
  Matrix column{n, 1, {}};
  for (int i = 0; i < n; ++i) column.entries.push_back(component(vector, static_cast<std::size_t>(i)));
  return column;
}

Matrix tensor_matrix(Expr tensor) {
  Matrix m{3, 3, {}};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) m.entries.push_back(tensor_component(tensor, i, j));
  }
  return m;
}

}  // namespace cdot::derive
