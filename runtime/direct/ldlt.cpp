#include "runtime/direct/ldlt.hpp"

#include <algorithm>

#include <cdot/spaces.hpp>

#include "runtime/direct/ldlt_kernels.hpp"

namespace cdot {
namespace {

// The part of a passing row in a redundant one that is not round-off.
constexpr double slight_part = 1e-10;
// The number of doubtful rows that one factor() checks. Each row that turns out independent costs another elimination.
// In a large grid thousands are doubtful. If an elimination takes more than `affordable` multiplications, these rows
// stay dropped and refinement reduces their error (direct/regularise.cpp).
constexpr int most_looks = 8;
constexpr long affordable = 1'000'000;

template <class Real>
constexpr auto eliminate = dense::all_eliminate<Real>(dense::Sizes{});
template <class Real>
constexpr auto forward = dense::all_forward<Real>(dense::Sizes{});
template <class Real>
constexpr auto backward = dense::all_backward<Real>(dense::Sizes{});
template <class Real>
constexpr auto update = dense::all_update<Real, false>(dense::Sizes{});
template <class Real>
constexpr auto update_of_square = dense::all_update<Real, true>(dense::Sizes{});

std::vector<std::vector<int>> neighbours_of(int count, const std::vector<std::pair<int, int>>& coupled) {
  std::vector<std::vector<int>> neighbours(static_cast<size_t>(count));
  for (const auto& [i, j] : coupled) {
    if (i == j) continue;
    neighbours[i].push_back(j);
    neighbours[j].push_back(i);
  }
  for (auto& of : neighbours) {
    std::sort(of.begin(), of.end());
    of.erase(std::unique(of.begin(), of.end()), of.end());
  }
  return neighbours;
}

}  // namespace

template <class Real>
void BasicLdlt<Real>::analyse(const std::vector<int>& rows, const std::vector<std::pair<int, int>>& coupled,
                              double share) {
  share_ = share;
  const auto neighbours = neighbours_of(static_cast<int>(rows.size()), coupled);
  lay_out(rows, minimum_degree_order(rows, neighbours, dense::largest));
  updates_.clear();
  for (Column& column : columns_) list_updates(column);
  list_couplings(rows, neighbours);
  const size_t n = diagonal_.size();
  l_.assign(values_.size(), Real(0));
  inverse_.assign(n, 0.0);
  for (auto* numbers : {&noise_, &doubtful_, &overstated_}) numbers->assign(n, 0.0);
  out_.assign(n, 0);
  dependent_.assign(n, 0);
  definite_.assign(n, 0);
  given_.assign(n, 0.0);
  forget();
}

template <class Real>
void BasicLdlt<Real>::forget() {
  std::fill(dependent_.begin(), dependent_.end(), 0);
  factored_ = false;
}

template <class Real>
void BasicLdlt<Real>::doubt_lasting() {
  for (unsigned char& times : dependent_) times = std::min<unsigned char>(times, dense::lasting_count - 1);
}

template <class Real>
bool BasicLdlt<Real>::doubt(int unknown) {
  if (dependent_[unknown] < dense::lasting_count) return false;
  dependent_[unknown] = dense::lasting_count - 1;
  return true;
}

template <class Real>
void BasicLdlt<Real>::lay_out(const std::vector<int>& rows, const std::vector<Elimination>& order) {
  columns_.clear();
  diagonal_.clear();
  column_of_.clear();
  panel_row_.clear();
  first_.assign(rows.size(), 0);
  int unknowns = 0, numbers = 0, largest_panel = 0;
  for (const Elimination& one : order) {
    Column column{{unknowns, 0, numbers, 0, 0, 0}, 0, 0, nullptr, nullptr, nullptr};
    for (int block : one.blocks) {
      first_[block] = unknowns;
      unknowns += rows[block];
    }
    for (int neighbour : one.neighbours) column.height += rows[neighbour];
    const int width = column.width = unknowns - column.first, kind = dense::kind(width);
    column.panel = numbers + width * width;
    column.eliminate = eliminate<Real>[kind];
    column.forward = forward<Real>[kind];
    column.backward = backward<Real>[kind];
    for (int r = 0; r < width; ++r) {
      diagonal_.push_back(numbers + r * (width + 1));
      column_of_.push_back(static_cast<int>(columns_.size()));
    }
    columns_.push_back(column);
    numbers += width * (width + column.height);
    largest_panel = std::max(largest_panel, width * column.height);
  }
  values_.assign(static_cast<size_t>(numbers), 0.0);
  unscaled_.assign(static_cast<size_t>(largest_panel), 0.0);
  for (size_t k = 0; k < order.size(); ++k) {
    columns_[k].rows = static_cast<int>(panel_row_.size());
    for (int neighbour : order[k].neighbours)
      for (int r = 0; r < rows[neighbour]; ++r) panel_row_.push_back(first_[neighbour] + r);
  }
}

// One update for each pair of runs of the panel's rows; a run's unknowns are consecutive within one column.
template <class Real>
void BasicLdlt<Real>::list_updates(Column& column) {
  const int* row = panel_row_.data() + column.rows;
  std::vector<std::pair<int, int>> runs;  // from row to row of the panel
  for (int h = 0; h < column.height; ++h) {
    if (h > 0 && row[h] == row[h - 1] + 1 && column_of_[row[h]] == column_of_[row[h - 1]]) runs.back().second = h + 1;
    else runs.emplace_back(h, h + 1);
  }
  column.updates_begin = static_cast<int>(updates_.size());
  for (size_t j = 0; j < runs.size(); ++j) {
    for (size_t i = j; i < runs.size(); ++i) {
      const auto [left, left_end] = runs[i];
      const auto [above, above_end] = runs[j];
      const Place target = place(row[left], row[above]);
      const auto& table = i == j ? update_of_square<Real> : update<Real>;
      updates_.push_back({{left, left_end - left, above, above_end - above, target.at, target.stride},
                          table[dense::kind(column.width)][dense::kind(above_end - above)]});
    }
  }
  column.updates_end = static_cast<int>(updates_.size());
}

template <class Real>
void BasicLdlt<Real>::list_couplings(const std::vector<int>& rows, const std::vector<std::vector<int>>& neighbours) {
  couplings_.clear();
  for (size_t block = 0; block < rows.size(); ++block) {
    const int row = first_[block];
    couplings_.push_back({row, rows[block], row, rows[block], place(row, row)});
    for (const int other : neighbours[block])
      if (const int column = first_[other]; column < row)
        couplings_.push_back({row, rows[block], column, rows[other], place(row, column)});
  }
}

template <class Real>
typename BasicLdlt<Real>::Place BasicLdlt<Real>::place(int row, int column) const {
  const Column& of = columns_[column_of_[column]];
  const int within = column - of.first;
  if (column_of_[row] == column_of_[column]) return {of.square + (row - of.first) * of.width + within, of.width};
  const auto begin = panel_row_.begin() + of.rows;
  const auto below = std::lower_bound(begin, begin + of.height, row) - begin;
  return {of.panel + static_cast<int>(below) * of.width + within, of.width};
}

template <class Real>
dense::Numbers<Real> BasicLdlt<Real>::numbers(const Real* added) {
  return {l_.data(),
          values_.data(),
          added,
          out_.data(),
          inverse_.data(),
          unscaled_.data(),
          panel_row_.data(),
          dependent_.data(),
          factored_ ? 1 : dense::lasting_count,
          std::max(share_, double(blur_)),
          std::max(share_, pivot_share_of_soft),
          noise_.data(),
          doubtful_.data()};
}

template <class Real>
int BasicLdlt<Real>::eliminate_columns(const dense::Numbers<Real>& all, const char* out) {
  std::copy(values_.begin(), values_.end(), l_.begin());
  any_out_ = out != nullptr;
  if (out) std::copy_n(out, out_.size(), out_.begin());
  else std::fill(out_.begin(), out_.end(), 0);
  int dependent = 0;
  for (const Column& column : columns_) {
    dependent += column.eliminate(column, all);
    for (int k = column.updates_begin; k < column.updates_end; ++k) updates_[k].run(column, updates_[k], all);
  }
  return dependent;
}

template <class Real>
void BasicLdlt<Real>::begin_noise() {
  for (size_t k = 0; k < noise_.size(); ++k)
    noise_[k] = dense::pivot_noise<Real> * values_[diagonal_[k]] - overstated_[k];
}

// The shares (-y, 1) = L^-T e_i of the last elimination, into given_.
template <class Real>
void BasicLdlt<Real>::find_shares(int unknown) {
  std::fill(given_.begin(), given_.end(), Real(0));
  given_[unknown] = Real(1);
  const dense::Numbers<Real> all = numbers(nullptr);
  for (int k = column_of_[unknown]; k >= 0; --k) columns_[k].backward(columns_[k], all, given_.data());
}

// K_ii + sum y_a^2 K_aa
template <class Real>
Real BasicLdlt<Real>::round_off_scale(int unknown) {
  find_shares(unknown);
  Real sum = 0;
  for (int a = 0; a <= unknown; ++a) sum += given_[a] * given_[a] * diagonal(a);
  return sum;
}

// Takes back the count of redundant rows that follow from passing ones: without these they may be independent.
template <class Real>
void BasicLdlt<Real>::keep_doubts(int counts, const char* passing) {
  const auto follows = [&](int i) {
    find_shares(i);
    for (int a = 0; a < i; ++a)
      if (passing[a] && given_[a] * given_[a] * diagonal(a) > slight_part * diagonal(i)) return true;
    return false;
  };
  int looks = 0;
  for (int k = 0; k < size() && looks < most_looks; ++k) {
    if (!dependent(k) || dependent_[k] >= dense::lasting_count + counts) continue;
    ++looks;
    if (follows(k)) dependent_[k] = static_cast<unsigned char>(std::max(dependent_[k] - counts, 0));
  }
}

// Finds the first row that was dropped because of its noise although its pivot exceeds the true round-off. Corrects the
// noise for one more elimination, in which other rows may depend on this one. False if no such row exists.
template <class Real>
bool BasicLdlt<Real>::clears_a_doubt(const Real* added) {
  for (int k = 0; k < size(); ++k) {
    if (!dependent(k) || !(doubtful_[k] > Real(0))) continue;
    const Real scale = round_off_scale(k);
    const double share = added[k] != 0 ? pivot_share_of_soft : pivot_share<Real>;
    if (!(doubtful_[k] > share * scale)) continue;
    overstated_[k] += noise_[k] - dense::pivot_noise<Real> * scale;
    return true;
  }
  return false;
}

template <class Real>
int BasicLdlt<Real>::factor(const Real* added, const char* out, const char* passing) {
  std::fill(overstated_.begin(), overstated_.end(), Real(0));
  begin_noise();
  const dense::Numbers<Real> all = numbers(added);
  int dependent_rows = eliminate_columns(all, out);
  const int looks = dependent_rows > 0 && multiplications() <= affordable ? most_looks : 0;
  for (int look = 0; look < looks && clears_a_doubt(added); ++look) {
    for (int k = 0; k < size(); ++k)  // the next elimination counts them again
      if (dependent(k)) dependent_[k] = static_cast<unsigned char>(std::max(dependent_[k] - all.counts, 0));
    begin_noise();
    dependent_rows = eliminate_columns(all, out);
  }
  if (passing && dependent_rows > 0) keep_doubts(all.counts, passing);
  factored_ = true;
  return dependent_rows;
}

template <class Real>
void BasicLdlt<Real>::factor_definite(const Real* added, const char* out) {
  std::fill(noise_.begin(), noise_.end(), 0.0);
  dense::Numbers<Real> all = numbers(added);
  all.share = all.soft_share = 0;
  all.dependent = definite_.data();
  eliminate_columns(all, out);
}

template <class Real>
void BasicLdlt<Real>::solve(const Real* b, Real* x) {
  const size_t n = diagonal_.size();
  if (any_out_) std::copy_n(b, n, given_.begin());
  if (x != b) std::copy_n(b, n, x);
  const dense::Numbers<Real> all = numbers(nullptr);
  for (const Column& column : columns_) column.forward(column, all, x);
  for (auto column = columns_.rbegin(); column != columns_.rend(); ++column) column->backward(*column, all, x);
  if (!any_out_) return;
  for (size_t k = 0; k < n; ++k)
    if (out_[k]) x[k] = given_[k];
}

template <class Real>
int BasicLdlt<Real>::dominant(const Real* b) {
  std::vector<Real>& x = given_;
  std::copy_n(b, size(), x.begin());
  const dense::Numbers<Real> all = numbers(nullptr);
  for (const Column& column : columns_) column.forward(column, all, x.data());  // D^-1 L^-1 b
  int found = -1;
  Real most = 0;
  for (int k = 0; k < size(); ++k) {
    if (!(inverse_[k] > Real(0)) || !(x[k] * x[k] / inverse_[k] > most)) continue;
    most = x[k] * x[k] / inverse_[k];
    found = k;
  }
  return found;
}

template <class Real>
void BasicLdlt<Real>::multiply(const Real* x, Real* y) const {
  std::fill_n(y, diagonal_.size(), 0.0);
  for (const auto& [row, rows, column, columns, at] : couplings_) {
    const bool triangle = row == column;
    const Real* K = values_.data() + at.at;
    for (int r = 0; r < rows; ++r, K += at.stride) {
      const Real from = x[row + r];
      const int below = triangle ? r : columns;
      Real sum = triangle ? K[r] * from : Real(0);
      for (int c = 0; c < below; ++c) {
        sum += K[c] * x[column + c];
        y[column + c] += K[c] * from;
      }
      y[row + r] += sum;
    }
  }
}

template <class Real>
long BasicLdlt<Real>::multiplications() const {
  long sum = 0;
  for (const Column& column : columns_) {
    const long a = column.width, h = column.height;
    const long square = a * (a - 1) / 2 + (a * (a - 1) * (a - 2)) / 6 + a * (a - 1);
    const long panel = h * (a * (a - 1) / 2 + a), update = a * h * (h + 1) / 2;
    const long solve = 2 * (a * (a - 1) / 2 + a * h) + a;
    sum += square + panel + update + solve;
  }
  return sum;
}

template class BasicLdlt<CDOT_EXACT_NUMBER>;

}  // namespace cdot
