#include "runtime/ldlt.hpp"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>

namespace cdot {
namespace {

std::vector<int> minimum_degree_order(int size, const std::vector<std::pair<int, int>>& entries) {
  std::vector<Eigen::Triplet<double>> triplets;
  for (const auto& [row, column] : entries) {
    triplets.emplace_back(row, column, 1.0);
    triplets.emplace_back(column, row, 1.0);
  }
  Eigen::SparseMatrix<double> pattern(size, size);
  pattern.setFromTriplets(triplets.begin(), triplets.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation;
  Eigen::AMDOrdering<int>()(pattern, permutation);
  std::vector<int> order(static_cast<size_t>(size));
  for (int k = 0; k < size; ++k) order[static_cast<size_t>(k)] = permutation.indices()[k];
  return order;
}

}  // namespace

void Ldlt::analyse(int size, const std::vector<std::pair<int, int>>& given) {
  size_ = size;
  const auto n = static_cast<size_t>(size);
  auto entries = given;
  for (int k = 0; k < size; ++k) entries.emplace_back(k, k);
  order_ = minimum_degree_order(size, entries);
  place_.assign(n, 0);
  for (int k = 0; k < size; ++k) place_[order_[k]] = k;
  order_by_columns(std::move(entries));
  build_tree();
  inverse_pivot_.assign(n, 0.0);
  pattern_.assign(n, 0);
  y_.assign(n, 0.0);
}

void Ldlt::order_by_columns(std::vector<std::pair<int, int>> entries) {
  for (auto& [first, second] : entries) {  // column and row of the permuted upper triangle
    const int i = place_[first], j = place_[second];
    first = std::max(i, j);
    second = std::min(i, j);
  }
  std::sort(entries.begin(), entries.end());
  entries.erase(std::unique(entries.begin(), entries.end()), entries.end());
  column_start_.assign(static_cast<size_t>(size_) + 1, 0);
  row_.clear();
  for (const auto& [column, row] : entries) {
    ++column_start_[column + 1];
    row_.push_back(row);
  }
  for (int k = 0; k < size_; ++k) column_start_[k + 1] += column_start_[k];
  values_.assign(row_.size(), 0.0);
}

// Elimination tree and the number of entries in each column of L: row k of L is what the tree
// reaches from K's entries above the diagonal in column k.
void Ldlt::build_tree() {
  const auto n = static_cast<size_t>(size_);
  parent_.assign(n, -1);
  mark_.assign(n, -1);
  l_count_.assign(n, 0);
  for (int k = 0; k < size_; ++k) {
    mark_[k] = k;
    for (int p = column_start_[k]; p < column_start_[k + 1]; ++p) {
      for (int i = row_[p]; mark_[i] != k; i = parent_[i]) {
        if (parent_[i] < 0) parent_[i] = k;
        ++l_count_[i];
        mark_[i] = k;
      }
    }
  }
  l_start_.assign(n + 1, 0);
  for (size_t k = 0; k < n; ++k) l_start_[k + 1] = l_start_[k] + l_count_[k];
  l_row_.assign(static_cast<size_t>(l_start_[n]), 0);
  l_value_.assign(static_cast<size_t>(l_start_[n]), 0.0);
}

int Ldlt::entry(int row, int column) const {
  const int i = std::min(place_[row], place_[column]), j = std::max(place_[row], place_[column]);
  const auto first = row_.begin() + column_start_[j], last = row_.begin() + column_start_[j + 1];
  return static_cast<int>(std::lower_bound(first, last, i) - row_.begin());
}

int Ldlt::factor(const double* added, const char* fixed) {
  std::fill(mark_.begin(), mark_.end(), -1);
  std::fill(l_count_.begin(), l_count_.end(), 0);
  std::fill(y_.begin(), y_.end(), 0.0);
  int dependent = 0;
  for (int k = 0; k < size_; ++k) dependent += eliminate(k, added, fixed);
  return dependent;
}

// Row k of L by a sparse triangular solve with the rows before it (up-looking: Davis, "Algorithm
// 849: LDL").
int Ldlt::eliminate(int k, const double* added, const char* fixed) {
  const bool out = fixed[order_[k]] != 0;
  int top = size_;
  mark_[k] = k;
  for (int p = column_start_[k]; p < column_start_[k + 1]; ++p) {
    int i = row_[p];
    y_[i] = out || fixed[order_[i]] ? 0.0 : values_[p];
    int length = 0;
    for (; mark_[i] != k; i = parent_[i]) {
      pattern_[length++] = i;
      mark_[i] = k;
    }
    while (length > 0) pattern_[--top] = pattern_[--length];
  }
  const double diagonal = out ? 1.0 : y_[k] + added[order_[k]];
  double pivot = diagonal;
  y_[k] = 0.0;
  for (; top < size_; ++top) {
    const int i = pattern_[top];
    const double y = y_[i], l = y * inverse_pivot_[i];
    y_[i] = 0.0;
    const int end = l_start_[i] + l_count_[i];
    for (int p = l_start_[i]; p < end; ++p) y_[l_row_[p]] -= l_value_[p] * y;
    pivot -= l * y;
    l_row_[end] = k;
    l_value_[end] = l;
    ++l_count_[i];
  }
  const bool independent = pivot > pivot_tolerance * diagonal;
  inverse_pivot_[k] = independent ? 1.0 / pivot : 0.0;
  return independent ? 0 : 1;
}

void Ldlt::solve(const double* b, double* x) {
  for (int k = 0; k < size_; ++k) y_[k] = b[order_[k]];
  for (int k = 0; k < size_; ++k)
    for (int p = l_start_[k]; p < l_start_[k + 1]; ++p) y_[l_row_[p]] -= l_value_[p] * y_[k];
  for (int k = 0; k < size_; ++k) y_[k] *= inverse_pivot_[k];
  for (int k = size_ - 1; k >= 0; --k)
    for (int p = l_start_[k]; p < l_start_[k + 1]; ++p) y_[k] -= l_value_[p] * y_[l_row_[p]];
  for (int k = 0; k < size_; ++k) {
    x[order_[k]] = y_[k];
    y_[k] = 0.0;
  }
}

void Ldlt::multiply(const double* x, double* y) const {
  for (int k = 0; k < size_; ++k) y[order_[k]] = 0.0;
  for (int k = 0; k < size_; ++k) {
    for (int p = column_start_[k]; p < column_start_[k + 1]; ++p) {
      const int i = order_[row_[p]], j = order_[k];
      y[i] += values_[p] * x[j];
      if (i != j) y[j] += values_[p] * x[i];
    }
  }
}

}  // namespace cdot
