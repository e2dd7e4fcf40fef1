// A sparse K = L D L^T in dense blocks, whose pattern is analysed once and whose numbers come every
// step, without allocating then. Its blocks are the rows of joints, where a general library goes
// number by number.
#pragma once

#include <utility>
#include <vector>

#include "runtime/elimination_order.hpp"
#include "runtime/ldlt_kernels.hpp"

namespace cdot {

class Ldlt {
 public:
  // Below this share of its original diagonal a pivot is a dependent row: its unknown is set to 0.
  // Measured on loops with redundant rows: 1e-14 misses some of them, 1e-9 to 1e-12 finds exactly
  // all.
  static constexpr double pivot_tolerance = 1e-10;

  // rows: of each block. coupled: pairs of blocks between which K may be nonzero; repetitions do no
  // harm.
  void analyse(const std::vector<int>& rows, const std::vector<std::pair<int, int>>& coupled);
  int size() const { return static_cast<int>(diagonal_.size()); }
  // Unknowns are numbered in the order of elimination. A block's first one:
  int first(int block) const { return first_[block]; }

  // Where in values() K's numbers from (row, column) on lie, row by row `stride` apart, within the
  // two's blocks. These are coupled, and row >= column; of a block with itself the lower triangle
  // counts.
  struct Place {
    int at, stride;
  };
  Place place(int row, int column) const;
  std::vector<double>& values() { return values_; }
  double diagonal(int unknown) const { return values_[diagonal_[unknown]]; }

  // Factors values() with `added` on the diagonal and the unknowns marked in `out` taken out (their
  // rows become those of the identity); null: none. Returns how many rows depend on others.
  int factor(const double* added, const char* out);
  // x = K^-1 b for the last factor(); may be in place.
  void solve(const double* b, double* x);
  // y = K x, with values() alone.
  void multiply(const double* x, double* y) const;

  // Of one factor() and one solve(): what the order of elimination costs.
  long multiplications() const;

 private:
  struct Column : dense::Column {
    int updates_begin, updates_end;
    dense::Eliminate eliminate;
    dense::Sweep forward, backward;
  };
  struct Update : dense::Part {
    dense::Update run;
  };
  dense::Numbers numbers(const double* added);
  void lay_out(const std::vector<int>& rows, const std::vector<Elimination>& order);
  void list_updates(Column& column);

  std::vector<int> first_;  // by block
  std::vector<int> diagonal_;   // by unknown, into values_
  std::vector<int> column_of_;  // by unknown
  std::vector<Column> columns_;
  std::vector<int> panel_row_;  // unknown of each row of a panel
  std::vector<Update> updates_;
  std::vector<double> values_, l_;
  std::vector<double> inverse_;  // D^-1 by unknown
  std::vector<char> out_;
  bool any_out_ = false;
  std::vector<double> unscaled_, given_;
};

}  // namespace cdot
