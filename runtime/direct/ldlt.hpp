// A sparse K = L D L^T in dense blocks, whose pattern is analysed once and whose numbers come every
// step, without allocating then. Its blocks are the rows of joints, where a general library goes
// number by number.
#pragma once

#include <utility>
#include <vector>

#include <cdot/detail/state_array.hpp>
#include <cdot/precision.hpp>

#include "runtime/direct/elimination_order.hpp"

namespace cdot {

// The data of runtime/direct/ldlt_kernels.hpp.
namespace dense {

// A row that depended on others in so many factorisations on end, or in the first of all, is
// redundant by design. It stays dropped until its pivot is above this share of its diagonal: where
// joints are a little open, axes that should be parallel are not, and what says nothing new on the
// joints' manifold would lock the mechanism beside it.
inline constexpr double lasting_share = 1e-4;
inline constexpr int lasting_count = 100;

// Round-off of a pivot beside what its row began with; delta(pivot_i) = L_ij^2 delta(pivot_j) says
// what becomes of it in the rows that follow.
template <class Real>
inline constexpr double pivot_noise = by_precision<Real>(1e-14);

// A column of L: a square on the diagonal and, below it, the panel of all rows that it is coupled
// with, both row by row.
struct Column {
  int first, width;   // unknowns
  int square, panel;  // into l
  int height;         // rows of the panel
  int rows;           // of the panel, into panel_row
};

// What an eliminated column takes from another: numbers at `target` in l, row by row `stride` apart.
struct Part {
  int left, rows;      // of the panel
  int above, columns;  // rows of the panel that are the other's columns
  int target, stride;
};

template <class Real>
struct Numbers {
  Real* l;                   // K; in its place L
  const Real* K;             // as it was before any elimination
  const Real* added;         // on K's diagonal, by unknown
  const char* out;           // unknowns that do not take part
  Real* inverse;             // D^-1 by unknown; 0 where it is out or its row depends on others
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

// Real is what K is formed in.
template <class Real>
class BasicLdlt {
 public:
  // Below this share of its original diagonal, or below what the pivots before it have magnified round-off to, a pivot
  // says nothing: its row depends on those before it, and its unknown is 0.
  //
  // With y = K_II^-1 k_i, what row i has of the rows I before it, round-off eps sqrt(K_aa K_bb) in every entry ab moves
  // its pivot by eps (sqrt(K_ii) + sum |y_a| sqrt(K_aa))^2 at most, which is at most (m + 1) eps (K_ii + sum y_a^2
  // K_aa) where m rows take part. The second factor is what dense::pivot_noise follows from row to row, as the sum of
  // what each pivot before adds, whatever their signs; where only that speaks against a row, y is found, and the factor
  // as it is. The share is m + 1 = 10 times it, as many rows as a loop too many has. More is no round-off: a body 1e10
  // times lighter than the two that it joins leaves 1e-10 of the second joint's rows, and they are as good as any. K
  // from floats is further off. T is what J and the masses are in.
  template <class T>
  static constexpr double pivot_share = std::is_same_v<T, float> ? 1e-7 : 10 * dense::pivot_noise<T>;
  // Of a soft row: below it the softness is not told from none. Dropped, the row is rigid beside those that it depends
  // on, 1e-10 stiffer than it is; kept, its force would be off by pivot_noise over its pivot, 1e-4 and more.
  static constexpr double pivot_share_of_soft = by_precision<Real>(1e-10);

  // rows: of each block. coupled: pairs of blocks between which K may be nonzero; repetitions do no
  // harm.
  void analyse(const std::vector<int>& rows, const std::vector<std::pair<int, int>>& coupled,
               double share = pivot_share<Real>);
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
  std::vector<Real>& values() { return values_; }
  Real diagonal(int unknown) const { return values_[diagonal_[unknown]]; }

  // Factors values() with `added` on the diagonal and the unknowns marked in `out` taken out (their
  // rows become those of the identity); null: none. Returns how many rows depend on others.
  int factor(const Real* added, const char* out);
  // The same where `added` makes K definite, however slightly: no row is dropped, and nothing is learnt about any.
  void factor_definite(const Real* added, const char* out);
  // The next factor() is the first.
  void forget();
  // Rows have gone: others that have depended for long may have depended on these only.
  void doubt_lasting();
  // The last factor() found the row to depend on others.
  bool dependent(int unknown) const { return inverse_[unknown] == 0 && !out_[unknown]; }
  // What it magnified round-off to was above what a pivot may be of the diagonal: whether the row depends on others
  // remains unknown.
  bool blurred(int unknown) const { return noise_[unknown] > share_ * diagonal(unknown); }
  // Of a row that does not depend on others.
  Real pivot(int unknown) const { return 1 / inverse_[unknown]; }
  // x = K^-1 b for the last factor(); may be in place.
  void solve(const Real* b, Real* x);
  // y = K x, with values() alone.
  void multiply(const Real* x, Real* y) const;

  // Its State.
  StateArray<unsigned char>& dependent() { return dependent_; }
  StateNumber<bool>& factored() { return factored_; }

  // Of one factor() and one solve(): what the order of elimination costs.
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
  dense::Numbers<Real> numbers(const Real* added);
  int eliminate_columns(const dense::Numbers<Real>& all, const char* out);
  void begin_noise();
  Real round_off_scale(int unknown);
  bool clears_a_doubt(const Real* added);
  void lay_out(const std::vector<int>& rows, const std::vector<Elimination>& order);
  void list_updates(Column& column);

  std::vector<int> first_;      // by block
  std::vector<int> diagonal_;   // by unknown, into values_
  std::vector<int> column_of_;  // by unknown
  std::vector<Column> columns_;
  std::vector<int> panel_row_;  // unknown of each row of a panel
  std::vector<Update> updates_;
  std::vector<Real> values_, l_;
  std::vector<Real> inverse_, noise_, doubtful_, overstated_;  // by unknown; overstated_: of noise_, within factor()
  std::vector<char> out_;
  StateArray<unsigned char> dependent_;  // State: in how many factorisations on end, by unknown
  StateNumber<bool> factored_ = false;   // State: not the first
  std::vector<unsigned char> definite_;  // nobody asks what factor_definite() says there
  bool any_out_ = false;
  double share_ = pivot_share<Real>;
  std::vector<Real> unscaled_, given_;
};

using Ldlt = BasicLdlt<double>;

}  // namespace cdot
