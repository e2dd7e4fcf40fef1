// Matrices in hand derivations: blocks, sums, products, transposes and small inverses.
#include <algorithm>

#include "derive/evaluate.hpp"

namespace cdot::derive {
namespace {

constexpr int largest_side = 64;

Value wrapped(Matrix m) {
  Value v;
  v.type = Type::matrix;
  v.matrix = std::make_shared<const Matrix>(std::move(m));
  return v;
}

// A number is 1 x 1, a vector a column.
Matrix as_matrix(const Value& v) {
  if (v.type == Type::matrix) return *v.matrix;
  if (v.type == Type::scalar) return {1, 1, {v.e}};
  return {2, 1, {component(v.e, 0), component(v.e, 1)}};
}

// Whether the size is only fixed by the place: the literal 0 and multiples of E.
bool any_size(const Value& v) { return v.zero || (v.type == Type::matrix && v.matrix->any_size()); }

// A value of any size, at that size.
Matrix sized(const Value& v, int rows, int columns, Pool& pool) {
  if (!any_size(v)) return as_matrix(v);
  Matrix m{rows, columns, {}};
  const Expr diagonal = v.zero ? pool.number(0) : v.matrix->entries[0];
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) m.entries.push_back(i == j ? diagonal : pool.number(0));
  return m;
}

std::string size_in_words(const Matrix& m) {
  return std::to_string(m.rows) + " x " + std::to_string(m.columns);
}

Matrix transposed(const Matrix& m) {
  if (m.any_size()) return m;
  Matrix t{m.columns, m.rows, {}};
  for (int j = 0; j < m.columns; ++j)
    for (int i = 0; i < m.rows; ++i) t.entries.push_back(m.at(i, j));
  return t;
}

Matrix scaled_by(const Matrix& m, Expr factor) {
  Matrix r = m;
  for (Expr& e : r.entries) e = factor * e;
  return r;
}

// m without one row and one column.
Matrix minor_of(const Matrix& m, int row, int column) {
  Matrix r{m.rows - 1, m.columns - 1, {}};
  for (int i = 0; i < m.rows; ++i)
    for (int j = 0; j < m.columns; ++j)
      if (i != row && j != column) r.entries.push_back(m.at(i, j));
  return r;
}

Expr determinant(const Matrix& m, Pool& pool) {
  if (m.rows == 1) return m.at(0, 0);
  Expr sum = pool.number(0);
  for (int j = 0; j < m.columns; ++j) {
    const Expr part = m.at(0, j) * determinant(minor_of(m, 0, j), pool);
    sum = j % 2 == 0 ? sum + part : sum - part;
  }
  return sum;
}

Matrix inverse(const Matrix& m, Pool& pool) {
  const Expr factor = pow(determinant(m, pool), -1);
  Matrix r{m.rows, m.columns, {}};
  for (int i = 0; i < m.rows; ++i)
    for (int j = 0; j < m.columns; ++j) {
      const Expr cofactor = m.rows == 1 ? pool.number(1) : determinant(minor_of(m, j, i), pool);
      r.entries.push_back(factor * ((i + j) % 2 == 0 ? cofactor : -cofactor));
    }
  return r;
}

// Sizes of block rows and block columns.
struct Layout {
  std::vector<int> heights, widths;  // widths per block of a row, row after row
};

}  // namespace

Value Evaluator::simplest(Matrix m, bool as_vector) {
  if (m.rows == 1 && m.columns == 1) return scalar(m.at(0, 0), {});
  if (as_vector && m.rows == 2 && m.columns == 1) {
    const Expr x = world_x(pool_);
    return vector(m.at(0, 0) * x + m.at(1, 0) * perp(x), {});
  }
  return wrapped(std::move(m));
}

Value Evaluator::transpose(const Ast& ast) {
  const Value v = plain(ast.args[0], "has no transpose");
  if (v.type == Type::poison || v.type == Type::scalar) return v;
  if (v.type == Type::point)
    return error(ast.where, "a point has no transpose", "subtract a point to get a vector");
  Value result = wrapped(transposed(as_matrix(v)));
  if (v.type == Type::matrix) return simplest(*result.matrix, true);
  return result;
}

Value Evaluator::matrix_sum(const std::vector<Value>& terms, const std::string& signs,
                            const std::vector<Span>& parts) {
  const auto first =
      std::find_if(terms.begin(), terms.end(), [](const Value& v) { return !any_size(v); });
  Matrix total{0, 0, {pool_.number(0)}};
  const bool open = first == terms.end();  // nothing but multiples of E and 0
  if (!open) {
    const Matrix size = as_matrix(*first);
    total = sized(scalar(pool_.number(0), {}), 0, 0, pool_);
    total = {size.rows, size.columns, std::vector<Expr>(size.entries.size(), pool_.number(0))};
  }
  for (std::size_t i = 0; i < terms.size(); ++i) {
    if (terms[i].type == Type::point)
      return error(parts[i], "a point cannot be added to a matrix", "subtract a point first");
    const Matrix m = open && terms[i].zero ? Matrix{0, 0, {pool_.number(0)}}
                     : open                ? *terms[i].matrix
                                           : sized(terms[i], total.rows, total.columns, pool_);
    if (m.rows != total.rows || m.columns != total.columns)
      return error(parts[i], "sizes differ: " + size_in_words(total) + " and " + size_in_words(m),
                   "", {parts[static_cast<std::size_t>(first - terms.begin())]});
    for (std::size_t k = 0; k < m.entries.size(); ++k)
      total.entries[k] =
          signs[i] == '-' ? total.entries[k] - m.entries[k] : total.entries[k] + m.entries[k];
  }
  return open ? wrapped(std::move(total)) : simplest(std::move(total), false);
}

std::optional<Matrix> Evaluator::multiply(const Value& a, const Value& b, Span where) {
  if (a.type == Type::scalar) return scaled_by(as_matrix(b), a.e);
  if (b.type == Type::scalar) return scaled_by(as_matrix(a), b.e);
  if (any_size(a)) return scaled_by(as_matrix(b), a.matrix->entries[0]);
  if (any_size(b)) return scaled_by(as_matrix(a), b.matrix->entries[0]);
  const Matrix l = as_matrix(a), r = as_matrix(b);
  if (l.columns != r.rows || l.rows * r.columns > largest_side * largest_side) {
    error(where,
          "matrices of " + size_in_words(l) + " and " + size_in_words(r) + " cannot be multiplied",
          "columns of the left must be rows of the right; perhaps a transpose ' is missing");
    return {};
  }
  Matrix m{l.rows, r.columns, {}};
  for (int i = 0; i < l.rows; ++i)
    for (int j = 0; j < r.columns; ++j) {
      Expr e = pool_.number(0);
      for (int k = 0; k < l.columns; ++k) e = e + l.at(i, k) * r.at(k, j);
      m.entries.push_back(e);
    }
  return m;
}

Value Evaluator::matrix_product(const std::vector<Value>& factors, const Ast& ast) {
  Value total = factors[0];
  for (std::size_t i = 0; i < factors.size(); ++i) {
    Value next = factors[i];
    const Span where = ast.args[i].where;
    if (next.type == Type::point)
      return error(where, "a point cannot be multiplied", "subtract a point first");
    if (ast.ops[i] == '/') {
      if (next.type != Type::scalar)
        return error(where, "nothing can be divided by " + std::string(in_words(next.type)),
                     "for the inverse of a matrix write K^-1");
      if (is_zero(next.e)) return error(where, "division by zero");
      next = scalar(pow(next.e, -1), {});
    }
    if (i == 0) continue;
    const bool as_vector =
        next.type == Type::vector || (total.type == Type::vector && next.type == Type::scalar);
    const auto product = multiply(total, next, {ast.where.begin, where.end});
    if (!product) return {};
    total = simplest(*product, as_vector);
  }
  return total;
}

Value Evaluator::matrix_power(const Value& base, int exponent, const Ast& ast) {
  const Matrix& m = *base.matrix;
  if (m.any_size()) return wrapped({0, 0, {pow(m.entries[0], exponent)}});
  if (m.rows != m.columns || exponent == 0 || exponent < -1 || exponent > 8 || m.rows > 4)
    return error(ast.where, "this power of a matrix of " + size_in_words(m) + " is not supported",
                 "square matrices up to 4 x 4 have an inverse ^-1 and powers up to ^8");
  if (exponent == -1) return wrapped(inverse(m, pool_));
  Value power = base;
  for (int i = 1; i < exponent; ++i) power = wrapped(*multiply(power, base, ast.where));
  return power;
}

// "[" blocks "]": heights come from each row's blocks, widths from those of the column, where rows
// have equally many.
Value Evaluator::matrix(const Ast& ast) {
  std::vector<Value> blocks;
  for (const Ast& a : ast.args) {
    blocks.push_back(plain(a, "cannot be a block"));
    if (blocks.back().type == Type::poison) return {};
    if (blocks.back().type == Type::point)
      return error(a.where, "a point cannot be a block", "subtract a point to get a vector");
  }
  const auto& lengths = ast.row_lengths;
  const bool aligned =
      std::all_of(lengths.begin(), lengths.end(), [&](int n) { return n == lengths[0]; });
  std::vector<int> widths(static_cast<std::size_t>(lengths[0]), 0);
  for (std::size_t i = 0; aligned && i < blocks.size(); ++i)
    if (int& width = widths[i % widths.size()]; !any_size(blocks[i]))
      width = std::max(width, as_matrix(blocks[i]).columns);
  if (aligned && widths.size() == expected_columns_.size())
    for (std::size_t j = 0; j < widths.size(); ++j)
      if (widths[j] == 0) widths[j] = expected_columns_[j];
  Matrix m;
  std::size_t next = 0;
  for (const int length : lengths) {
    int height = 0;
    bool identity = false;
    for (int j = 0; j < length; ++j) {
      const Value& b = blocks[next + static_cast<std::size_t>(j)];
      identity |= any_size(b) && !b.zero;
      if (!any_size(b)) height = std::max(height, as_matrix(b).rows);
    }
    if (height == 0) height = identity ? 2 : 1;
    std::vector<Matrix> row;
    int columns = 0;
    for (int j = 0; j < length; ++j) {
      const Value& b = blocks[next + static_cast<std::size_t>(j)];
      int width = aligned ? widths[static_cast<std::size_t>(j)] : 0;
      if (width == 0) width = b.zero ? 1 : height;
      row.push_back(sized(b, height, width, pool_));
      if (row.back().rows != height || (aligned && row.back().columns != width))
        return error(ast.args[next + static_cast<std::size_t>(j)].where,
                     "this block is " + size_in_words(row.back()) +
                         ", its place in the matrix is " + std::to_string(height) + " x " +
                         std::to_string(width),
                     "perhaps a transpose ' is missing");
      columns += row.back().columns;
    }
    if (m.rows > 0 && columns != m.columns)
      return error(ast.args[next].where,
                   "this row has " + std::to_string(columns) + " columns, the first has " +
                       std::to_string(m.columns),
                   "", {ast.args[0].where});
    for (int i = 0; i < height; ++i)
      for (const Matrix& block : row)
        for (int j = 0; j < block.columns; ++j) m.entries.push_back(block.at(i, j));
    m.columns = columns;
    m.rows += height;
    next += static_cast<std::size_t>(length);
    if (m.rows > largest_side || m.columns > largest_side)
      return error(ast.where, "a matrix with more than 64 rows or columns");
  }
  return wrapped(std::move(m));
}

}  // namespace cdot::derive
