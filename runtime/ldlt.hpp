// A sparse K = L D L^T whose pattern is analysed once and whose numbers come every step, without
// allocating then. Eigen orders the unknowns; its own factorisation allocates, and does not survive
// dependent rows.
#pragma once

#include <utility>
#include <vector>

namespace cdot {

class Ldlt {
 public:
  // Below this share of its original diagonal a pivot is a dependent row: its unknown is set to 0.
  // Measured on loops with redundant rows: 1e-14 misses some of them, 1e-9 to 1e-12 finds exactly
  // all.
  static constexpr double pivot_tolerance = 1e-10;

  // The pattern of one triangle: (row, column) of every entry that may be nonzero; repetitions do
  // no harm, the diagonal is always there.
  void analyse(int size, const std::vector<std::pair<int, int>>& entries);
  // Where the entry (row, column) or (column, row) lies in values().
  int entry(int row, int column) const;
  std::vector<double>& values() { return values_; }

  // Factors values() with `added` on the diagonal and the unknowns marked in `fixed` taken out
  // (their rows become those of the identity). Returns how many rows depend on others.
  int factor(const double* added, const char* fixed);
  // x = K^-1 b for the last factor(); may be in place.
  void solve(const double* b, double* x);
  // y = K x, with values() alone.
  void multiply(const double* x, double* y) const;

 private:
  void order_by_columns(std::vector<std::pair<int, int>> entries);
  void build_tree();
  int eliminate(int column, const double* added, const char* fixed);

  int size_ = 0;
  std::vector<int> order_, place_;  // order_[k]: unknown eliminated as k-th; place_: its inverse
  std::vector<int> column_start_, row_;  // upper triangle of the permuted K, by columns
  std::vector<double> values_;
  std::vector<int> parent_;  // elimination tree
  std::vector<int> l_start_, l_count_, l_row_;
  std::vector<double> l_value_, inverse_pivot_;
  std::vector<int> mark_, pattern_;  // scratch
  std::vector<double> y_;
};

}  // namespace cdot
