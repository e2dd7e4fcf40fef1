// Regularises systems in which elimination cannot decide whether a row is redundant. In large systems with many
// redundant rows a small true pivot magnifies the round-off of all later ones, until independent rows are dropped. If
// such a row is not satisfied, K is factored again with a small softness in every row, so that no row is dropped.
// Refinement then removes the softness:
//
//   lambda <- lambda + (K + eps D)^-1 (b - K lambda),   D the diagonal of K
//
// Each round reduces the error along an eigenvector, K x = kappa D x, by the factor eps / (eps + kappa). The error of
// contradicting rows (kappa = 0) stays and adds 1 / eps of itself to lambda in every round, with that much round-off in
// the other rows. For such systems eps is larger and D equal for all rows: the result is the least-squares motion.
#include <algorithm>
#include <cmath>
#include <limits>

#include <cdot/spaces.hpp>

#include "runtime/direct/system.hpp"

namespace cdot {
namespace {

// In small systems round-off grows that much only near singular poses, and there dropped rows are best left dropped.
constexpr int least_rows = 500;
struct Level {
  double eps;
  int rounds;
};
constexpr Level slightly{1e-10, 5}, plainly{1e-7, 12};
template <class Real>
constexpr double refined = by_precision<Real>(1e-13);  // share of the largest b

}  // namespace

template <class S>
bool System<S>::drops_rows_by_round_off() {
  if (dependent_ == 0 || rows_ < least_rows) return false;
  bool any = false;
  for (int r = 0; r < rows_; ++r) any |= ldlt_.dependent(r) && ldlt_.blurred(r);
  return any && misses_rows(shared_[0]);
}

template <class S>
void System<S>::soften(Softened how) {
  auto& softened = shared_[0];
  Real least = std::numeric_limits<Real>::infinity(), most = 0;
  for (int r = 0; r < rows_; ++r) {
    softened[r] = ldlt_.diagonal(r);
    if (out_[r]) continue;
    least = std::min(least, softened[r]), most = std::max(most, softened[r]);
  }
  if (how == Softened::plainly) std::fill(softened.begin(), softened.end(), std::sqrt(least * most));
  const double eps = how == Softened::plainly ? plainly.eps : slightly.eps;
  for (int r = 0; r < rows_; ++r) softened[r] = softness[r] + eps * softened[r];
  ldlt_.factor_definite(softened.data(), any_out_ ? out_.data() : nullptr);
  softened_ = how;
}

// rest = wanted - (K + softness) lambda in the free rows. Returns its largest entry.
template <class S>
typename System<S>::Real System<S>::find_rest(const std::vector<Real>& wanted, std::vector<Real>& rest) {
  ldlt_.multiply(lambda.data(), product_.data());
  Real largest = 0;
  for (int r = 0; r < rows_; ++r) {
    rest[r] = out_[r] ? Real(0) : wanted[r] - product_[r] - softness[r] * lambda[r];
    largest = std::max(largest, std::abs(rest[r]));
  }
  return largest;
}

// Returns the largest remaining error.
template <class S>
typename System<S>::Real System<S>::refine(const std::vector<Real>& wanted, Real scale) {
  auto& [rest, change, aim, unused] = shared_;
  for (int r = 0; r < rows_; ++r)
    if (!out_[r] || broken[r]) lambda[r] = 0.0;
  const int rounds = softened_ == Softened::plainly ? plainly.rounds : slightly.rounds;
  Real left = find_rest(wanted, rest);
  for (int round = 0; round < rounds && left > refined<Real> * scale; ++round) {
    ldlt_.solve(rest.data(), change.data());
    for (int r = 0; r < rows_; ++r)
      if (!out_[r]) lambda[r] += change[r];
    left = find_rest(wanted, rest);
  }
  return left;
}

template <class S>
void System<S>::solve_softly() {
  auto& [rest, change, aim, unused] = shared_;
  Real scale = 0;
  for (int r = 0; r < rows_; ++r)
    if (!out_[r]) scale = std::max(scale, std::abs(b[r]));
  contradicted_ = refine(b, scale) > slight(scale);
  if (!contradicted_) return;
  if (softened_ == Softened::slightly) {
    soften(Softened::plainly);
    refine(b, scale);
  }
  unmet_ = rest;
  for (int r = 0; r < rows_; ++r) aim[r] = b[r] - unmet_[r];
  refine(aim, scale);
}

#define CDOT_INSTANTIATE(S)                                                                    \
  template bool System<S>::drops_rows_by_round_off();                                          \
  template void System<S>::soften(Softened);                                                   \
  template System<S>::Real System<S>::find_rest(const std::vector<Real>&, std::vector<Real>&); \
  template System<S>::Real System<S>::refine(const std::vector<Real>&, Real);                  \
  template void System<S>::solve_softly();
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
