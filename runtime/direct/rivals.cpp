// Motors of unlimited force whose rates no motion has: each other's rivals, or held by joints. A null vector z of K,
// with sum_r z_r J_r = 0, tells which rows a contradiction is of. With an end among them it is as meant: the end stops
// motors. So it is with a row of bounded force, as friction: that yields at its bound, or misses its rate by the error
// of a step.
#include <algorithm>
#include <cmath>

#include <cdot/spaces.hpp>

#include "runtime/direct/system.hpp"

namespace cdot {
namespace {

// Of the largest |z_r| sqrt(K_rr): less is round-off.
template <class Real>
constexpr double part_of_sum = by_precision<Real>(1e-6);

}  // namespace

template <class S>
void System<S>::find_rivals(Real slight) {
  auto &one = shared_[0], &z = shared_[2];
  if (!contradicted_) return;
  for (int dropped = 0; dropped < rows_; ++dropped) {
    if (out_[dropped] || !ldlt_.dependent(dropped) || !(std::abs(unmet_[dropped]) > slight)) continue;
    std::fill(one.begin(), one.end(), Real(0));
    one[dropped] = 1;
    expand(one, z);
    Real missed = 0, largest = 0;
    for (int r = 0; r < rows_; ++r) missed += z[r] * unmet_[r];
    if (!(std::abs(missed) > slight)) continue;
    for (int r = 0; r < rows_; ++r) largest = std::max(largest, z[r] = std::abs(z[r]) * std::sqrt(ldlt_.diagonal(r)));
    bool yields = false;
    Rivals found;
    each_row([&](int row, const Batch<S>& batch, int i) {
      if (!(z[row] > part_of_sum<Real> * largest)) return;
      const bool motor = is_motor(batch);
      yields |= motor ? !is_unlimited(batch, i) : batch.law && batch.law->error;
      if (motor) (found.row < 0 ? found.row : found.other) = row;
    });
    if (!yields && found.row >= 0) rivals_ = found;
  }
}

template <class S>
bool System<S>::misses_rate(int row) const {
  return !fixed[row] && !broken[row] && std::abs(softness[row] * lambda[row]) > slight(largest_b(Of::free_rows));
}

template <class S>
typename System<S>::Rivals System<S>::rivals() const {
  const auto [row, other] = rivals_;
  const bool miss = row >= 0 && misses_rate(row) && (other < 0 || misses_rate(other));
  return miss ? rivals_ : Rivals{};
}

#define CDOT_INSTANTIATE(S)                        \
  template void System<S>::find_rivals(Real);      \
  template bool System<S>::misses_rate(int) const; \
  template System<S>::Rivals System<S>::rivals() const;
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
