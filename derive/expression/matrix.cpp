#include "derive/expression/matrix.hpp"

#include <algorithm>

#include "derive/expression/symbols.hpp"

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

Expr components_along(Expr u, const std::vector<Expr>& axes) {
  const std::vector<Expr> world = world_axes(*u->pool);
  Expr sum = zero_vector(*u->pool);
  for (std::size_t k = 0; k < axes.size(); ++k) sum = sum + dot(axes[k], u) * world[k];
  return sum;
}

Expr component(Expr u, std::size_t index) {
  Pool& pool = *u->pool;
  const std::vector<Expr> world = world_axes(pool);
  const auto is_axis = [&](Expr e) { return std::find(world.begin(), world.end(), e) != world.end(); };
  std::vector<Term> terms;
  for (const Term& t : terms_of(u)) {
    const bool scaled = t.e->kind == Kind::scale;
    const Expr direction = scaled ? t.e->args[1] : t.e;
    if (!is_axis(direction)) return dot(world[index], u);
    if (direction == world[index]) terms.push_back({t.coef, scaled ? t.e->args[0] : pool.number(1)});
  }
  return sum(pool, terms, false);
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
