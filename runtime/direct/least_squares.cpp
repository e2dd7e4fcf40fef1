// Contradicting rows: joints that cannot all be satisfied, as in a triangle whose third side is too long. Elimination
// drops the last of these rows. This code distributes its error over all rows of the contradiction, with the least sum
// of squares.
//
//   K lambda = b - Z y,  Z^T Z y = Z^T b,  the columns of Z spanning the left null space of K:
//   z_d = e_d - (K_II^-1 K_Id on the independent rows I), for every dropped row d.
//
// Z^T b is the error of the dropped rows; if it is round-off, there is nothing to do. Conjugate gradients solve the
// small system; each product needs one solve with the factor and one multiplication by K.
#include <algorithm>
#include <cmath>
#include <limits>

#include <cdot/spaces.hpp>

#include "runtime/direct/system.hpp"

namespace cdot {
namespace {

// An error of a row below this, or below this share of the largest b, counts as round-off.
template <class T>
constexpr double least_slight = by_precision<T>(1e-5, 1e-11);
template <class T>
constexpr double least_share = by_precision<T>(1e-4, 1e-9);

constexpr double solved = 1e-24;  // share of the square of the first error
template <class Real>
constexpr Real infinite = std::numeric_limits<Real>::infinity();
// Squares below that have lost their digits, or are 0 beside others that are not.
constexpr double least_square = std::numeric_limits<double>::min() / solved;

template <class Real>
Real product(const std::vector<Real>& x, const std::vector<Real>& y) {
  Real sum = 0;
  for (size_t i = 0; i < x.size(); ++i) sum += x[i] * y[i];
  return sum;
}

// from -= share part, in the rows that take part.
template <class Real>
void take_away(const std::vector<Real>& part, Real share, const std::vector<char>& out, std::vector<Real>& from) {
  for (size_t r = 0; r < from.size(); ++r)
    if (!out[r]) from[r] -= share * part[r];
}

}  // namespace

// w <- Z^T w in the places of the dropped rows; 0 elsewhere.
template <class S>
void System<S>::contract(std::vector<Real>& w) {
  for (int r = 0; r < rows_; ++r) right_side_[r] = kept(r) ? w[r] : Real(0);
  ldlt_.solve(right_side_.data(), right_side_.data());
  ldlt_.multiply(right_side_.data(), product_.data());
  for (int r = 0; r < rows_; ++r) w[r] = ldlt_.dependent(r) ? w[r] - product_[r] : Real(0);
}

// to = Z y, with y in the places of the dropped rows.
template <class S>
void System<S>::expand(const std::vector<Real>& y, std::vector<Real>& to) {
  ldlt_.multiply(y.data(), product_.data());
  for (int r = 0; r < rows_; ++r) to[r] = kept(r) ? product_[r] : Real(0);
  ldlt_.solve(to.data(), to.data());
  for (int r = 0; r < rows_; ++r) to[r] = kept(r) ? -to[r] : y[r];
}

template <class S>
typename System<S>::Real System<S>::slight(Real scale) {
  return std::max(Real(least_slight<T>), least_share<T> * scale);
}

// Writes the error of the dropped rows, Z^T b, to `missed`. False if it is round-off.
template <class S>
bool System<S>::misses_rows(std::vector<Real>& missed) {
  ldlt_.multiply(lambda.data(), product_.data());
  Real largest = 0, scale = 0;
  for (int r = 0; r < rows_; ++r) {
    missed[r] = 0;
    if (out_[r]) continue;
    scale = std::max(scale, std::abs(b[r]));
    if (!ldlt_.dependent(r)) continue;
    missed[r] = b[r] - product_[r] - softness[r] * lambda[r];
    largest = std::max(largest, std::abs(missed[r]));
  }
  return largest > slight(scale);
}

// y = (Z^T Z)^-1 rest by conjugate gradients. Uses up `rest`.
template <class S>
void System<S>::divide_by_null_space(std::vector<Real>& rest, std::vector<Real>& y) {
  auto &step = shared_[1], &image = shared_[2];
  std::fill(y.begin(), y.end(), 0.0);
  step = rest;
  Real left = product(rest, rest);
  const Real enough = std::max(solved * left, Real(least_square));
  for (int round = 0; round < rows_ && left > enough; ++round) {
    expand(step, image);
    contract(image);
    const Real share = left / product(step, image);
    for (int r = 0; r < rows_; ++r) {
      y[r] += share * step[r];
      rest[r] -= share * image[r];
    }
    const Real before = left;
    left = product(rest, rest);
    for (int r = 0; r < rows_; ++r) step[r] = rest[r] + left / before * step[r];
  }
}

template <class S>
void System<S>::share_contradictions() {
  if (softened_ != Softened::no) return;
  auto &missed = shared_[0], &image = shared_[2], &y = shared_[3];
  contradicted_ = dependent_ > 0 && misses_rows(missed);
  if (contradicted_) {
    divide_by_null_space(missed, y);
    expand(y, unmet_);
    for (int r = 0; r < rows_; ++r) image[r] = kept(r) ? unmet_[r] : Real(0);
    ldlt_.solve(image.data(), image.data());
    for (int r = 0; r < rows_; ++r)
      if (kept(r)) lambda[r] -= image[r];
  }
}

// The part of the way from lambda to lambda - image on which no row passes its bound, and the row that would; -1: none.
template <class S>
typename System<S>::Part System<S>::part_within_bounds(const std::vector<Real>& image) const {
  Part part{Real(1), -1};
  for (int r = 0; r < rows_; ++r) {
    if (out_[r] || image[r] == Real(0)) continue;
    const Real left = lambda[r] - (image[r] > Real(0) ? lower[r] : upper[r]);  // as large as image if that passes none
    if (const Real share = std::max(left / image[r], Real(0)); share < part.share) part = {share, r};
  }
  return part;
}

// image = Z y with Z^T Z y = Z^T lambda: lambda - image moves the bodies alike, with the least sum of squares.
template <class S>
const std::vector<typename System<S>::Real>& System<S>::idle_loads() {
  auto &rest = shared_[0], &image = shared_[2], &y = shared_[3];
  for (int r = 0; r < rows_; ++r) rest[r] = out_[r] ? Real(0) : whole(r);
  contract(rest);
  divide_by_null_space(rest, y);
  expand(y, image);
  return image;
}

// Takes them away, or as many as the bounds allow. Loads are shared where joints may break, and where an end holds: by
// elimination alone the impulse of a rope along a rigid frame would be infinite in poses where the frame without the
// dropped row is none. Returns the row whose bound is met on the way; -1: none.
template <class S>
int System<S>::share_redundant_loads(Bounds bounds) {
  if (dependent_ == 0 || softened_ != Softened::no) return -1;
  bool under_laws = false, holds_ends = false;
  each_row([&](int row, const Batch<S>& batch, int) {
    if (!batch.law || out_[row]) return;
    under_laws = true, holds_ends |= batch.law->error != nullptr;
  });
  if (!holds_ends && (!shares_loads_ || (bounds == Bounds::unknown && under_laws))) return -1;
  const std::vector<Real>& idle = idle_loads();
  const Part part = bounds == Bounds::known ? part_within_bounds(idle) : Part{Real(1), -1};
  take_away(idle, part.share, out_, lambda);
  return part.row;
}

// Of rows that are held at acceleration level. Bounds that loads move are only assumed.
template <class S>
void System<S>::load_held_bounds() {
  Guard<T> guards[most_rows];
  each_row([&](int row, const Batch<S>& batch, int i) {
    lower[row] = -infinite<Real>, upper[row] = infinite<Real>;
    if (!batch.law || batch.mode[i] != Mode::held || batch.law->by_load || batch.law->cone_rows > 0) return;
    batch.law->guard(batch, i / batch.ops->rows, guards);
    lower[row] = guards[i % batch.ops->rows].lower, upper[row] = guards[i % batch.ops->rows].upper;
  });
}

// The free row whose lambda is furthest beyond a bound; -1: none.
template <class S>
int System<S>::row_beyond_bounds() const {
  int row = -1;
  Real most = 0;
  for (int r = 0; r < rows_; ++r) {
    if (out_[r]) continue;
    const Real beyond = std::max(lower[r] - lambda[r], lambda[r] - upper[r]);
    if (beyond > slight(std::abs(lambda[r])) && beyond > most) row = r, most = beyond;
  }
  return row;
}

// Where lambda' lambda of the free rows F is least, it has no idle part: lambda_F = J_F w, with w = M^-1 J_F' x.
//
//   lambda_F = K_FF x,  J_r w = K_rF x  for every other row r.
//
// A row at a bound makes the sum smaller inside if J_r w lies there, and it is free to go there if its rate is met and
// it depends on the free ones. Frees the first such row. False if there is none.
template <class S>
bool System<S>::leaves_bound() {
  std::vector<Real>& may_leave = shared_[0];
  find_excess();
  const Real few = slight(largest_b(Of::all_rows));
  Real largest = 0;
  for (int r = 0; r < rows_; ++r) {
    may_leave[r] = fixed[r] && !broken[r] && lower[r] < upper[r] && std::isfinite(lambda[r]) &&
                   (lambda[r] == lower[r] || lambda[r] == upper[r]) && std::abs(excess(r)) <= few;
    right_side_[r] = kept(r) ? whole(r) : Real(0);
    if (!out_[r] || may_leave[r]) largest = std::max(largest, std::abs(whole(r)));
  }
  ldlt_.solve(right_side_.data(), right_side_.data());
  ldlt_.multiply(right_side_.data(), product_.data());
  const int before = dependent_;
  bool changed = false;
  for (int r = 0; r < rows_; ++r) {
    const Real inside = fixed[r] == at_lower ? product_[r] - whole(r) : whole(r) - product_[r];
    if (!may_leave[r] || !(inside > slight(largest))) continue;
    const char bound = fixed[r];
    fixed[r] = free, changed = true;
    if (factor() > before && softened_ == Softened::no) return true;
    fixed[r] = bound;
  }
  if (changed) factor();
  return false;
}

// Rows beyond their bounds stay there one by one, if the others then give them their rates all the same. An event that
// was passed within a step needs what is beyond.
template <class S>
bool System<S>::share_held_loads() {
  if (!shares_loads_ || dependent_ == 0 || softened_ != Softened::no) return false;
  const auto share = [&] { take_away(idle_loads(), Real(1), out_, lambda); };
  const auto solve_again = [&] { factor(), solve_rows(); };
  bool any = false;
  load_held_bounds();
  share();
  for (int r = row_beyond_bounds(); r >= 0; r = row_beyond_bounds()) {
    fixed[r] = lambda[r] < lower[r] ? at_lower : at_upper;
    lambda[r] = fixed[r] == at_lower ? lower[r] : upper[r];
    solve_again(), find_excess();
    const bool moves = std::abs(excess(r)) > slight(largest_b(Of::all_rows));
    if (moves || softened_ != Softened::no || (dependent_ > 0 && misses_rows(shared_[0]))) {
      lower[r] = -infinite<Real>, upper[r] = infinite<Real>, fixed[r] = free;
      solve_again();
    }
    any = true;
    if (softened_ == Softened::no && dependent_ > 0) share();
  }
  return any;
}

// Frees rows at a bound whose rate is met: the load of a pin may rest on a brake that has not slipped.
template <class S>
void System<S>::free_idle_rows() {
  bool any = false;
  find_excess();
  const Real few = slight(largest_b(Of::all_rows));
  for (int r = 0; r < rows_; ++r) {
    if (!fixed[r] || broken[r] || lower[r] == upper[r] || std::abs(excess(r)) > few) continue;
    fixed[r] = free, any = true;
  }
  if (any) factor();
}

// Rows whose bounds contradict are slightly soft until these have decided. If the others then agree, they are rigid
// again: among soft rows, the softness would share the loads. What the soft solution lacks of their rates is slight, so
// it moves no row beyond its bound.
template <class S>
void System<S>::stiffen() {
  auto& soft = shared_[3];
  std::copy(softness.begin(), softness.end(), soft.begin());
  load_softness();
  if (softened_ != Softened::no || soft == softness) return;
  factor(), find_excess();
  for (int r = 0; r < rows_; ++r) right_side_[r] = kept(r) ? -excess(r) : Real(0);
  ldlt_.solve(right_side_.data(), right_side_.data());
  for (int r = 0; r < rows_; ++r)
    if (kept(r)) lambda[r] += right_side_[r];
  if (!(dependent_ > 0 && misses_rows(shared_[0]))) return;
  std::copy(soft.begin(), soft.end(), softness.begin());
  factor(), solve_rows();
}

// Shares until no row passes its bound: one that meets it stays there while the others go on.
template <class S>
void System<S>::stay_at_bounds() {
  for (int met = share_redundant_loads(Bounds::known); met >= 0; met = share_redundant_loads(Bounds::known)) {
    const bool low = lambda[met] - lower[met] < upper[met] - lambda[met];
    fixed[met] = low ? at_lower : at_upper;
    lambda[met] = low ? lower[met] : upper[met];
    factor();
  }
}

// Where something breaks by its load, that must not depend on the order of elimination: rows at a bound whose rate is
// met have a share, too.
template <class S>
void System<S>::share_within_bounds() {
  shared_some_ = false;
  if (shares_loads_) stiffen();
  if (!shares_loads_ || softened_ != Softened::no) return void(share_redundant_loads(Bounds::known));
  free_idle_rows();
  shared_some_ = dependent_ > 0;
  stay_at_bounds();
  for (int turns = rows_; turns > 0 && leaves_bound(); --turns) stay_at_bounds();
}

#define CDOT_INSTANTIATE(S)                                 \
  template System<S>::Real System<S>::slight(Real);         \
  template bool System<S>::misses_rows(std::vector<Real>&); \
  template void System<S>::share_contradictions();          \
  template int System<S>::share_redundant_loads(Bounds);    \
  template void System<S>::load_held_bounds();              \
  template bool System<S>::share_held_loads();              \
  template void System<S>::share_within_bounds();
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
