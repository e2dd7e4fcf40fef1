#include "runtime/direct/system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <cdot/spaces.hpp>

namespace cdot {
namespace {

// Round-off of K lambda, in units of its largest term.
template <class Real>
constexpr Real rounded = 8 * std::numeric_limits<Real>::epsilon();

}  // namespace

template <class S>
void System<S>::load_softness() {
  each_row([&](int row, const Batch<S>& batch, int i) {
    if (batch.law) softness[row] = batch.softness[i];
  });
}

template <class S>
void System<S>::load_laws() {
  load_softness();
  each_row([&](int row, const Batch<S>& batch, int i) {
    if (!batch.law) return;
    lower[row] = batch.lower[i];
    upper[row] = batch.upper[i];
  });
}

template <class S>
int System<S>::factor() {
  char any = 0;
  for (int r = 0; r < rows_; ++r) any |= out_[r] = fixed[r] | broken[r];
  any_out_ = any != 0;
  ++rounds_;
  softened_ = Softened::no;
  dependent_ = ldlt_.factor(softness.data(), any_out_ ? out_.data() : nullptr, lawful_ ? passing_.data() : nullptr);
  if (taut_ && dependent_ > 0)
    each_tension_row([&](const Block&, int, int row) { dependent_ -= ldlt_.dependent(row); });
  return dependent_;
}

template <class S>
bool System<S>::factored_as_selected() const {
  if (dependent_ > 0 || softened_ != Softened::no) return false;
  for (int r = 0; r < rows_; ++r)
    if (out_[r] != (fixed[r] | broken[r])) return false;
  return true;
}

template <class S>
void System<S>::solve_rows() {
  if (softened_ == Softened::no) {
    solve_kept_rows();
    if (!drops_rows_by_round_off()) return;
    soften(Softened::slightly);
  }
  solve_softly();
}

template <class S>
void System<S>::solve_kept_rows() {
  if (!any_out_) return ldlt_.solve(b.data(), lambda.data());
  bool any_fixed = false;
  for (int r = 0; r < rows_; ++r) {
    if (broken[r]) lambda[r] = 0.0;
    right_side_[r] = out_[r] ? lambda[r] : Real(0);
    any_fixed |= right_side_[r] != 0.0;
  }
  if (any_fixed) {
    ldlt_.multiply(right_side_.data(), product_.data());
    for (int r = 0; r < rows_; ++r)
      if (!out_[r]) right_side_[r] = -product_[r];
  }
  for (int r = 0; r < rows_; ++r)
    if (!out_[r]) right_side_[r] += b[r];
  ldlt_.solve(right_side_.data(), lambda.data());
}

template <class S>
typename System<S>::Real System<S>::largest_b(Of rows) const {
  Real largest = 0;
  for (int r = 0; r < rows_; ++r)
    if (!broken[r] && !(rows == Of::free_rows && fixed[r])) largest = std::max(largest, std::abs(b[r]));
  return largest;
}

// The largest sqrt(K_cc) |lambda_c|. By |K_rc| <= sqrt(K_rr K_cc), sqrt(K_rr) times it bounds the terms of (K
// lambda)_r.
template <class S>
typename System<S>::Real System<S>::largest_term() const {
  Real largest = 0;
  for (int c = 0; c < rows_; ++c) largest = std::max(largest, std::sqrt(ldlt_.diagonal(c)) * std::abs(lambda[c]));
  return largest;
}

// The bound at which a free row has to stay: that which it lies beyond, or, for a redundant row, at which elimination
// leaves it (a slack rope beside a rod pulls nothing). `excess`: J v + bias after it.
template <class S>
char System<S>::bound_for(int r, Real excess, Real tolerance) const {
  if (lambda[r] < lower[r] || (ldlt_.dependent(r) && lambda[r] == lower[r] && excess > tolerance)) return at_lower;
  if (lambda[r] > upper[r] || (ldlt_.dependent(r) && lambda[r] == upper[r] && excess < -tolerance)) return at_upper;
  return free;
}

// Fixes rows outside their bounds at the bound, and frees rows whose bound has the wrong sign. True if nothing changed.
// Impulses of nearly redundant rows cancel; by their round-off, two equal ropes would take turns.
template <class S>
bool System<S>::revise_active_set(bool one_by_one) {
  find_excess();
  const Real scale = largest_b(Of::all_rows), term = largest_term();
  bool settled = true;
  for (int r = rows_ - 1; r >= 0; --r) {
    if (broken[r]) continue;
    const Real excess = this->excess(r);
    const Real tolerance = by_precision<Real>(1e-12) * scale + rounded<Real> * std::sqrt(ldlt_.diagonal(r)) * term;
    if (!fixed[r]) {
      fixed[r] = bound_for(r, excess, tolerance);
      if (fixed[r] == free) continue;
      lambda[r] = fixed[r] == at_lower ? lower[r] : upper[r];
    } else {
      const bool holds = fixed[r] == at_lower ? excess >= -tolerance : excess <= tolerance;
      if (holds || lower[r] == upper[r]) continue;
      fixed[r] = free;
    }
    settled = false;
    if (one_by_one) return false;
  }
  return settled;
}

namespace {

// The largest error of a row within its bounds, as a share of the largest b, at poses on C = 0.
template <class Real>
constexpr double missed = by_precision<Real>(1e-9);
// Share of the diagonal that makes a redundant row independent.
template <class T>
constexpr double slight_softness = std::max(1e-8, 10 * Ldlt::pivot_share<T>);

// Joints and limits hold the motors that contradict them: these become soft. Call after share_contradictions(), which
// leaves an error above `slight` in the rows of a contradiction. A limit far away, which does not act, sets no scale.
// True if rows changed.
template <class S, class Real>
bool hold_motors(System<S>& system, Real slight) {
  bool held = false;
  system.find_rivals(slight);
  system.each_row([&](int r, const Batch<S>& batch, int) {
    if (!is_motor(batch) || system.fixed[r] || system.broken[r] || system.softness[r] != 0) return;
    if (!(std::abs(system.unmet(r)) > slight)) return;
    system.softness[r] = system.softness_of_motors * system.diagonal(r);
    held = true;
  });
  return held;
}

}  // namespace

// Where a motor contradicts joints, it alone misses its rate: a joint that shared the error would open.
template <class S>
void System<S>::solve() {
  rivals_ = {};
  solve_rows();
  share_contradictions();
  if (lawful_ && contradicted_ && hold_motors(*this, slight(largest_b(Of::free_rows)))) {
    factor();
    solve_rows();
    share_contradictions();
  }
  share_redundant_loads(Bounds::unknown);
}

// The impulses of contradicting rows grow along their error, without end where no bound is met. True if there are such
// rows with a bound ahead: they become slightly soft, so that the weaker of two clutches on one axle reaches its bound
// and slips. Bounds that loads move are only assumed.
template <class S>
bool System<S>::let_bounds_decide() {
  const Real few = slight(largest_b(Of::free_rows));
  bool any = false;
  each_row([&](int r, const Batch<S>& batch, int) {
    const Real rest = unmet(r);
    if (fixed[r] || broken[r] || !(std::abs(rest) > few) || !std::isfinite(rest > 0 ? upper[r] : lower[r])) return;
    if (batch.law && batch.law->by_load) return;
    softness[r] += slight_softness<T> * ldlt_.diagonal(r);
    any = true;
  });
  return any;
}

// A motor and the limit that it runs into are the same row twice: elimination drops the later one. Bounds decide, or
// joints and limits hold motors of unlimited force. If that leaves a bounded row unsatisfied, all bounded rows become
// slightly soft, so the weaker one reaches its bound. True if rows changed.
template <class S>
bool System<S>::part_contradicting_rows() {
  const auto bounded = [&](int r) { return std::isfinite(lower[r]) || std::isfinite(upper[r]); };
  const Real scale = largest_b(Of::free_rows), most = std::max(Real(missed<Real>), forgiven_share_) * scale + forgiven_;
  bool any = false;
  for (int r = 0; r < rows_; ++r) any |= bounded(r) && !fixed[r] && !broken[r] && std::abs(excess(r)) > most;
  share_contradictions();
  if (let_bounds_decide() || hold_motors(*this, slight(scale))) return yields_ = true;
  for (int r = 0; any && r < rows_; ++r)
    if (bounded(r)) softness[r] += slight_softness<T> * ldlt_.diagonal(r);
  return any;
}

// A bounded row that contradicts a joint's row takes turns with it: free, it makes the joint's row redundant. Of the
// last two choices, the one that drops fewer rows stays. Uses active_set_, which solve_bounded() writes anew.
template <class S>
int System<S>::end_turns() {
  const int dependent = factor();
  solve_rows();
  std::copy(fixed.begin(), fixed.end(), active_set_.begin());
  if (revise_active_set(true)) return dependent;
  if (const int other = factor(); other < dependent) {
    solve_rows();
    return other;
  }
  std::copy(active_set_.begin(), active_set_.end(), fixed.begin());
  for (int r = 0; r < rows_; ++r)
    if (fixed[r]) lambda[r] = fixed[r] == at_lower ? lower[r] : upper[r];
  factor();
  solve_rows();
  return dependent;
}

template <class S>
int System<S>::find_active_set() {
  // Changing all violating rows at once is fast but may cycle. Changing one at a time, always the last, does not cycle
  // (Murty's rule), unless a motor contradicts a limit.
  const int fast = 10, slow = std::min(2 * rows_, 200);
  int dependent = 0;
  bool settled = false;
  circle_.begin(fixed);
  for (int round = 0; round < fast + slow && !settled; ++round) {
    if (round == fast) circle_.begin(fixed);
    dependent = factor();
    solve_rows();
    if (round >= fast && dependent > 0) {
      share_contradictions();
      if (let_bounds_decide() || hold_motors(*this, slight(largest_b(Of::free_rows)))) {
        yields_ = true;
        circle_.begin(fixed);
        continue;
      }
    }
    settled = revise_active_set(round >= fast);
    eased_ |= yields_ && !settled;
    // Whole circles lead nowhere.
    if (const int length = circle_.closes(fixed))
      round += ((round < fast ? fast : fast + slow) - 1 - round) / length * length;
  }
  return settled || rows_ == 0 ? dependent : end_turns();
}

// Parts contradicting rows until none is left; the others share their error, once. eased_: motors yielded, and then a
// row reached or left a bound.
template <class S>
int System<S>::part_and_settle() {
  yields_ = eased_ = false;
  int dependent = find_active_set();
  for (int round = 0; round < 2 && dependent > 0; ++round) {
    if (!part_contradicting_rows()) return dependent;
    dependent = find_active_set();
  }
  share_contradictions();
  return dependent;
}

template <class S>
int System<S>::solve_bounded() {
  std::copy(active_set_.begin(), active_set_.end(), fixed.begin());  // start: the active set of the last step
  each_row([&](int r, const Batch<S>& batch, int) {  // beside a given force that is free, a joint's row is redundant
    if (batch.law && batch.law->force && lower[r] == upper[r]) fixed[r] = at_lower;
  });
  for (int r = 0; r < rows_; ++r) {
    if (broken[r]) fixed[r] = free;
    if (fixed[r]) lambda[r] = fixed[r] == at_lower ? lower[r] : upper[r];
    if (!std::isfinite(lambda[r])) fixed[r] = free;
  }
  rounds_ = 0, rivals_ = {};
  int dependent = part_and_settle();
  // A motor that yielded to a row now at its bound need not yield any more: it pulls a slipping brake with all it has.
  // Bounds are the caller's, as those of changes in the middle of a step.
  if (eased_) {
    load_softness();
    dependent = part_and_settle();
  }
  share_within_bounds();
  std::copy(fixed.begin(), fixed.end(), active_set_.begin());
  for (int r = 0; r < rows_; ++r)  // those of a broken joint keep the bounds that they had
    if (!broken[r]) lambda[r] = std::clamp(lambda[r], lower[r], upper[r]);
  return dependent;
}

#define CDOT_INSTANTIATE(S) template class System<S>;
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
