// A sparse K = L D L^T in dense blocks. The pattern is analysed once; a step changes the numbers and allocates nothing.
// The blocks are the rows of joints; a general library works number by number.
#pragma once

#include <utility>
#include <vector>

#include <cdot/detail/state_array.hpp>
#include <cdot/precision.hpp>

#include "runtime/direct/elimination_order.hpp"

namespace cdot {

// The data of runtime/direct/ldlt_kernels.hpp.
namespace dense {

// A row that was redundant in lasting_count consecutive factorisations, or in the first, is redundant by design. It
// stays dropped until its pivot exceeds lasting_share of its diagonal. Small errors of C make such a row slightly
// independent: off C = 0, axes that should be parallel are not. It would then lock the mechanism.
inline constexpr double lasting_share = 1e-4;
inline constexpr int lasting_count = 100;

// Round-off of a pivot, relative to the row's diagonal in K. It propagates to later rows as delta(pivot_i) = L_ij^2
// delta(pivot_j).
template <class Real>
inline constexpr double pivot_noise = by_precision<Real>(1e-14);

// A column of L: a square on the diagonal and, below it, the panel of all coupled rows, both row by row.
struct Column {
  int first, width;   // unknowns
  int square, panel;  // into l
  int height;         // rows of the panel
  int rows;           // of the panel, into panel_row
};

// The update of a later column by an eliminated one: numbers at `target` in l, rows `stride` apart.
struct Part {
  int left, rows;      // of the panel
  int above, columns;  // rows of the panel that are columns of the other
  int target, stride;
};

template <class Real>
struct Numbers {
  Real* l;                   // K, overwritten by L
  const Real* K;             // as it was before any elimination
  const Real* added;         // on K's diagonal, by unknown
  const char* out;           // unknowns that do not take part
  Real* inverse;             // D^-1 by unknown; 0 if the row is out or redundant
  Real* unscaled;            // L D of the panel at hand, column by column
  const int* panel_row;      // unknown of each row of each panel
  unsigned char* dependent;  // in how many factorisations on end, by unknown
  int counts;                // for how many this one counts
  double share, soft_share;  // Ldlt's; soft_share: of rows with something added
  Real* noise;               // of each pivot to come
  Real* doubtful;            // pivots that were dropped for their noise alone; 0: for their size
};

template <class Real>
using Eliminate = int (*)(const Column&, const Numbers<Real>&);
template <class Real>
using Update = void (*)(const Column&, const Part&, const Numbers<Real>&);
template <class Real>
using Sweep = void (*)(const Column&, const Numbers<Real>&, Real* x);

}  // namespace dense

// Real is the number type of K.
template <class Real>
class BasicLdlt {
 public:
  // A pivot below this share of its original diagonal, or below the round-off magnified by earlier pivots, counts as
  // zero. The row depends on earlier rows, and its unknown is 0.
  //
  // Let y = K_II^-1 k_i be the shares of row i in the earlier rows I. Round-off eps sqrt(K_aa K_bb) in every entry ab
  // moves the pivot by at most eps (sqrt(K_ii) + sum |y_a| sqrt(K_aa))^2 <= (m + 1) eps (K_ii + sum y_a^2 K_aa) if m
  // rows take part. dense::pivot_noise bounds the last factor from row to row by the sum over earlier pivots, without
  // cancellation. If only this bound rejects a row, y and the exact factor are computed. The share is m + 1 = 10 times
  // pivot_noise: a redundant loop has about that many rows. A larger share would reject good rows: a body 1e10 times
  // lighter than its two neighbours leaves 1e-10 of the second joint's rows. K from floats is less exact. T is the
  // number type of J and of the masses.
  template <class T>
  static constexpr double pivot_share = std::is_same_v<T, float> ? 1e-7 : 10 * dense::pivot_noise<T>;
  // The same where all blocks of K are products of one J from floats: a dependent row keeps the square of its rounding,
  // 4e-15. A body 1000 times lighter than its neighbours leaves 1e-8 and less.
  static constexpr double pivot_share_of_products = 1e-9;
  // The same for a soft row; below it the softness counts as 0. A dropped row is rigid beside the rows that it depends
  // on, an error of 1e-10 of their stiffness. Otherwise its force would have a relative error of pivot_noise / pivot,
  // 1e-4 and more.
  static constexpr double pivot_share_of_soft = by_precision<Real>(1e-10);

  // rows: of each block. coupled: pairs of blocks between which K may be nonzero; repetitions are allowed.
  void analyse(const std::vector<int>& rows, const std::vector<std::pair<int, int>>& coupled,
               double share = pivot_share<Real>);
  int size() const { return static_cast<int>(diagonal_.size()); }
  // Unknowns are numbered in the order of elimination. A block's first one:
  int first(int block) const { return first_[block]; }

  // The place in values() of K's numbers from (row, column) on, rows `stride` apart, within the blocks of both. The
  // blocks are coupled and row >= column. On the diagonal the lower triangle counts.
  struct Place {
    int at, stride;
  };
  Place place(int row, int column) const;
  std::vector<Real>& values() { return values_; }
  Real diagonal(int unknown) const { return values_[diagonal_[unknown]]; }

  // From now on a pivot below this share counts as zero, too.
  void blur(double share) { blur_ = share; }
  // Factors values() plus `added` on the diagonal, without the unknowns marked in `out` (their rows become those of the
  // identity); null: none. `passing` marks rows that may leave, as those of a rope: no row that follows from them is
  // redundant by design. Returns the number of redundant rows.
  int factor(const Real* added, const char* out, const char* passing = nullptr);
  // The same if `added` makes K positive definite: drops no row and counts no row as redundant.
  void factor_definite(const Real* added, const char* out);
  // Treats the next factor() as the first.
  void forget();
  // After the removal of rows: rows that are redundant by design may have depended on the removed rows only.
  void doubt_lasting();
  // The same for one row. False if it did not count as redundant by design.
  bool doubt(int unknown);
  // Treats the row as redundant by design from the next factor() on.
  void presume_redundant(int unknown) { dependent_[unknown] = dense::lasting_count; }
  // The row with the largest part of b^T K^-1 b = sum (L^-1 b)_i^2 / D_i in the last factor(); -1: none.
  int dominant(const Real* b);
  // True if the last factor() found the row redundant.
  bool dependent(int unknown) const { return inverse_[unknown] == 0 && !out_[unknown]; }
  // True if magnified round-off exceeds the threshold of the pivot, so the last factor() could not decide whether the
  // row is redundant.
  bool blurred(int unknown) const { return noise_[unknown] > share_ * diagonal(unknown); }
  // For independent rows only.
  Real pivot(int unknown) const { return 1 / inverse_[unknown]; }
  // x = K^-1 b for the last factor(); may be in place.
  void solve(const Real* b, Real* x);
  // y = K x, from the coupled blocks of values(), without the factor.
  void multiply(const Real* x, Real* y) const;

  // Its State.
  StateArray<unsigned char>& dependent() { return dependent_; }
  StateNumber<bool>& factored() { return factored_; }
  StateNumber<double>& blur() { return blur_; }

  // Of one factor() and one solve(), a measure of the order of elimination.
  long multiplications() const;

 private:
  struct Column : dense::Column {
    int updates_begin, updates_end;
    dense::Eliminate<Real> eliminate;
    dense::Sweep<Real> forward, backward;
  };
  struct Update : dense::Part {
    dense::Update<Real> run;
  };
  // A block of K on the diagonal or below it. values() also has room for the fill of L, several times as much.
  struct Coupling {
    int row, rows, column, columns;
    Place at;
  };
  dense::Numbers<Real> numbers(const Real* added);
  int eliminate_columns(const dense::Numbers<Real>& all, const char* out);
  void begin_noise();
  void find_shares(int unknown);
  Real round_off_scale(int unknown);
  void keep_doubts(int counts, const char* passing);
  bool clears_a_doubt(const Real* added);
  void lay_out(const std::vector<int>& rows, const std::vector<Elimination>& order);
  void list_updates(Column& column);
  void list_couplings(const std::vector<int>& rows, const std::vector<std::vector<int>>& neighbours);

  std::vector<int> first_;      // by block
  std::vector<int> diagonal_;   // by unknown, into values_
  std::vector<int> column_of_;  // by unknown
  std::vector<Column> columns_;
  std::vector<int> panel_row_;  // unknown of each row of a panel
  std::vector<Update> updates_;
  std::vector<Coupling> couplings_;
  std::vector<Real> values_, l_;
  std::vector<Real> inverse_, noise_, doubtful_, overstated_;  // by unknown; overstated_: of noise_, within factor()
  std::vector<char> out_;
  StateArray<unsigned char> dependent_;  // State: in how many factorisations on end, by unknown
  StateNumber<bool> factored_ = false;   // State: not the first
  std::vector<unsigned char> definite_;  // written by factor_definite(), never read
  bool any_out_ = false;
  double share_ = pivot_share<Real>;
  StateNumber<double> blur_ = 0;  // State: of the last projection
  std::vector<Real> unscaled_, given_;
};

using Ldlt = BasicLdlt<double>;

}  // namespace cdot
