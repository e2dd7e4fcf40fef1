// Matrices in hand derivations: blocks, sums, products, transposes and small inverses.
#include <algorithm>

#include "derive/language/evaluate.hpp"

namespace cdot::derive {
namespace {

constexpr int largest_side = 64;

// True if only the place fixes the size: for the literal 0 and multiples of E.
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

std::string size_in_words(const Matrix& m) { return std::to_string(m.rows) + " x " + std::to_string(m.columns); }

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

// In space, so that matrices of a hand derivation print as vectors, like the generated formulas.
Value row_of(Expr n) {
  Value v = of_matrix(transposed(column_of(n)));
  v.row = n;
  return v;
}

// skew(r) u = r x u, n' skew(r) = (n x r)', n' u = n . u, and the like; nothing if the product is none of these.
std::optional<Value> product_in_vectors(const Value& a, const Value& b) {
  const bool vector_follows = b.type == Type::vector && !b.zero, plain = !a.inverted && !b.inverted;
  if (!plain) return std::nullopt;
  if (a.skew && vector_follows) return vector(cross(a.skew, b.e), {});
  if (a.tensor && vector_follows) return vector(apply(a.tensor, b.e), {});
  if (a.row && vector_follows) return scalar(dot(a.row, b.e), {});
  if (a.row && b.skew) return row_of(cross(a.row, b.skew));
  if (a.row && b.tensor) return row_of(apply(b.tensor, a.row));
  if (a.type == Type::scalar && b.skew) return skew_of(a.e * b.skew);
  if (a.type == Type::scalar && b.row) return row_of(a.e * b.row);
  if (b.type == Type::scalar && a.skew) return skew_of(b.e * a.skew);
  if (b.type == Type::scalar && a.row) return row_of(b.e * a.row);
  return std::nullopt;
}

// The sum of skew matrices, or of rows.
std::optional<Value> sum_in_vectors(const std::vector<Value>& terms, const std::string& signs) {
  const bool skew = std::all_of(terms.begin(), terms.end(), [](const Value& v) { return bool(v.skew); });
  const bool rows = std::all_of(terms.begin(), terms.end(), [](const Value& v) { return bool(v.row); });
  if (!skew && !rows) return std::nullopt;
  Expr sum;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const Expr u = skew ? terms[i].skew : terms[i].row, term = signs[i] == '-' ? -u : u;
    sum = i == 0 ? term : sum + term;
  }
  return skew ? skew_of(sum) : row_of(sum);
}

// Adds blocks of equal height, side by side, below m.
void append_rows(Matrix& m, const std::vector<Matrix>& blocks, int columns) {
  const int height = blocks.front().rows;
  for (int i = 0; i < height; ++i)
    for (const Matrix& block : blocks)
      for (int j = 0; j < block.columns; ++j) m.entries.push_back(block.at(i, j));
  m.columns = columns;
  m.rows += height;
}

// Where blocks of a matrix stand, and how large they are.
class Blocks {
 public:
  Blocks(const std::vector<Value>& blocks, const std::vector<int>& row_lengths,
         const std::vector<int>& expected_columns, int dimension)
      : blocks_(blocks), lengths_(row_lengths), dimension_(dimension) {
    aligned_ = std::all_of(lengths_.begin(), lengths_.end(), [&](int n) { return n == lengths_[0]; });
    for (std::size_t i = 0, next = 0; i < lengths_.size(); ++i) {
      starts_.push_back(next);
      next += static_cast<std::size_t>(lengths_[i]);
    }
    for (std::size_t i = 0; i < lengths_.size(); ++i) heights_.push_back(height_of_row(i));
    if (aligned_) shared_widths(expected_columns);
  }

  std::size_t rows() const { return lengths_.size(); }
  int length(std::size_t row) const { return lengths_[row]; }
  std::size_t index(std::size_t row, int column) const { return starts_[row] + static_cast<std::size_t>(column); }
  int height(std::size_t row) const { return heights_[row]; }
  // Widths come from the column's blocks, where rows have equally many.
  int width(std::size_t row, int column) const {
    if (aligned_) return widths_[static_cast<std::size_t>(column)];
    const Value& b = blocks_[index(row, column)];
    if (b.zero) return 1;
    return any_size(b) ? heights_[row] : as_matrix(b).columns;
  }

 private:
  // From the row's blocks; a row of nothing but 0 and E is as high as E, which has the dimension's size.
  int height_of_row(std::size_t row) const {
    bool identity = false;
    for (int j = 0; j < lengths_[row]; ++j) {
      const Value& b = blocks_[index(row, j)];
      if (!any_size(b)) return as_matrix(b).rows;
      identity |= !b.zero;
    }
    return identity ? dimension_ : 1;
  }

  void shared_widths(const std::vector<int>& expected) {
    for (int j = 0; j < lengths_[0]; ++j) {
      const bool hint = expected.size() == static_cast<std::size_t>(lengths_[0]);
      int width = hint ? expected[static_cast<std::size_t>(j)] : 1;
      for (std::size_t i = lengths_.size(); i-- > 0;) {
        const Value& b = blocks_[index(i, j)];
        if (any_size(b) && !b.zero) width = heights_[i];
      }
      for (std::size_t i = lengths_.size(); i-- > 0;) {
        const Value& b = blocks_[index(i, j)];
        if (!any_size(b)) width = as_matrix(b).columns;
      }
      widths_.push_back(width);
    }
  }

  const std::vector<Value>& blocks_;
  const std::vector<int>& lengths_;
  int dimension_;
  bool aligned_ = false;
  std::vector<std::size_t> starts_;
  std::vector<int> heights_, widths_;
};

}  // namespace

Value Evaluator::transpose(const Ast& ast) {
  const Value v = plain(ast.args[0], "has no transpose");
  if (v.type == Type::poison || v.type == Type::scalar) return v;
  if (v.skew) return skew_of(-v.skew);
  if (v.row) return vector(v.row, {});
  if (v.tensor) return v;
  if (v.type == Type::vector && pool_.dimension() == 3) return row_of(v.e);
  Value result = of_matrix(transposed(as_matrix(v)));
  if (v.type == Type::matrix) return simplest(*result.matrix, true);
  return result;
}

Value Evaluator::matrix_sum(const std::vector<Value>& terms, const std::string& signs, const std::vector<Span>& parts) {
  if (const std::optional<Value> sum = sum_in_vectors(terms, signs)) return *sum;
  const auto first = std::find_if(terms.begin(), terms.end(), [](const Value& v) { return !any_size(v); });
  Matrix total{0, 0, {pool_.number(0)}};
  const bool open = first == terms.end();  // nothing but multiples of E and 0
  if (!open) {
    const Matrix size = as_matrix(*first);
    total = {size.rows, size.columns, std::vector<Expr>(size.entries.size(), pool_.number(0))};
  }
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const Matrix m = open && terms[i].zero ? Matrix{0, 0, {pool_.number(0)}}
                     : open                ? *terms[i].matrix
                                           : sized(terms[i], total.rows, total.columns, pool_);
    if (m.rows != total.rows || m.columns != total.columns)
      return error(parts[i], "sizes differ: " + size_in_words(total) + " and " + size_in_words(m), "",
                   {parts[static_cast<std::size_t>(first - terms.begin())]});
    for (std::size_t k = 0; k < m.entries.size(); ++k)
      total.entries[k] = signs[i] == '-' ? total.entries[k] - m.entries[k] : total.entries[k] + m.entries[k];
  }
  return open ? of_matrix(std::move(total)) : simplest(std::move(total), false);
}

std::optional<Matrix> Evaluator::multiply(const Value& a, const Value& b, Span where) {
  if (a.type == Type::scalar) return scaled_by(as_matrix(b), a.e);
  if (b.type == Type::scalar) return scaled_by(as_matrix(a), b.e);
  if (any_size(a)) return scaled_by(as_matrix(b), a.matrix->entries[0]);
  if (any_size(b)) return scaled_by(as_matrix(a), b.matrix->entries[0]);
  const Matrix l = as_matrix(a), r = as_matrix(b);
  if (l.columns != r.rows || l.rows * r.columns > largest_side * largest_side) {
    error(where, "matrices of " + size_in_words(l) + " and " + size_in_words(r) + " cannot be multiplied",
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
    if (ast.ops[i] == '/') {
      if (next.type != Type::scalar)
        return error(where, "nothing can be divided by " + std::string(in_words(next.type)),
                     "for the inverse of a matrix write K^-1");
      if (is_zero(next.e)) return error(where, "division by zero");
      next = scalar(pow(next.e, -1), {});
    }
    if (i == 0) continue;
    if (const std::optional<Value> product_of_two = product_in_vectors(total, next)) {
      total = *product_of_two;
      continue;
    }
    const bool as_vector = next.type == Type::vector || (total.type == Type::vector && next.type == Type::scalar);
    const auto product = multiply(total, next, {ast.where.begin, where.end});
    if (!product) return {};
    total = simplest(*product, as_vector);
  }
  return total;
}

Value Evaluator::matrix_power(const Value& base, int exponent, const Ast& ast) {
  const Matrix& m = *base.matrix;
  if (base.inverted && exponent == -1) {
    Value plain = base;
    plain.inverted = false;
    return plain;
  }
  if (m.any_size()) return of_matrix({0, 0, {pow(m.entries[0], exponent)}});
  if (m.rows != m.columns || exponent == 0 || exponent < -1 || exponent > 8 || m.rows > 4)
    return error(ast.where, "this power of a matrix of " + size_in_words(m) + " is not supported",
                 "square matrices up to 4 x 4 have an inverse ^-1 and powers up to ^8");
  if (exponent == -1) return of_matrix(inverse(m));
  Value power = base;
  for (int i = 1; i < exponent; ++i) power = of_matrix(*multiply(power, base, ast.where));
  return power;
}

// "[" blocks "]"
Value Evaluator::matrix(const Ast& ast) {
  std::vector<Value> blocks;
  for (const Ast& a : ast.args) {
    blocks.push_back(plain(a, "cannot be a block"));
    if (blocks.back().type == Type::poison) return {};
  }
  const Blocks layout(blocks, ast.row_lengths, expected_columns_, pool_.dimension());
  Matrix m;
  for (std::size_t i = 0; i < layout.rows(); ++i) {
    std::vector<Matrix> row;
    int columns = 0;
    for (int j = 0; j < layout.length(i); ++j) {
      const std::size_t k = layout.index(i, j);
      row.push_back(sized(blocks[k], layout.height(i), layout.width(i, j), pool_));
      if (row.back().rows != layout.height(i) || row.back().columns != layout.width(i, j))
        return error(ast.args[k].where,
                     "this block is " + size_in_words(row.back()) + ", its place in the matrix is " +
                         std::to_string(layout.height(i)) + " x " + std::to_string(layout.width(i, j)),
                     "perhaps a transpose ' is missing");
      columns += row.back().columns;
    }
    if (i > 0 && columns != m.columns)
      return error(ast.args[layout.index(i, 0)].where,
                   "this row has " + std::to_string(columns) + " columns, the first has " + std::to_string(m.columns),
                   "", {ast.args[0].where});
    append_rows(m, row, columns);
    if (m.rows > largest_side || m.columns > largest_side)
      return error(ast.where, "the matrix has more than 64 rows or columns");
  }
  return of_matrix(std::move(m));
}

}  // namespace cdot::derive
