#include "runtime/rows/laws.hpp"

#include <cmath>
#include <limits>

#include <cdot/spaces.hpp>

namespace cdot {
namespace {

template <class T>
constexpr T unbounded = std::numeric_limits<T>::infinity();

template <class S>
void fill_unilateral(Batch<S>& batch, int begin, int end, typename S::Scalar h, const Settings& settings) {
  using T = typename S::Scalar;
  const int rows = batch.ops->rows;
  const T share = settings.drift == Drift::baumgarte ? T(settings.baumgarte) : T(0);
  for (int i = begin * rows; i < end * rows; ++i) {
    const RowKind kind = batch.kinds[static_cast<size_t>(i % rows)];
    const bool inequality = kind == RowKind::inequality;
    batch.lower[i] = inequality ? T(0) : -unbounded<T>;
    batch.upper[i] = unbounded<T>;
    batch.bias[i] += inequality ? unilateral_bias(batch.C[i], h, settings) : share * batch.C[i] / h;
  }
}

template <class S>
void error_unilateral(const Batch<S>& batch, int slot, typename S::Scalar* error) {
  using T = typename S::Scalar;
  for (int r = 0; r < batch.ops->rows; ++r) {
    const T C = batch.C[slot * batch.ops->rows + r];
    error[r] = batch.kinds[r] == RowKind::inequality && C > T(0) ? T(0) : C;
  }
}

template <class S>
void guard_unilateral(const Batch<S>& batch, int slot, Guard<typename S::Scalar>* guards) {
  using T = typename S::Scalar;
  for (int r = 0; r < batch.ops->rows; ++r) {
    const T low = batch.kinds[r] == RowKind::inequality ? T(0) : -unbounded<T>;
    guards[r] = {batch.C[slot * batch.ops->rows + r], T(0), low, unbounded<T>};
  }
}

// Out of reach (C > 0) a unilateral spring's row is exact, so C cannot jump over 0 within the step.
template <class S>
void fill_soft(Batch<S>& batch, int begin, int end, typename S::Scalar h, const Settings&) {
  using T = typename S::Scalar;
  const int rows = batch.ops->rows;
  for (int i = begin * rows; i < end * rows; ++i) {
    const int slot = i / rows, r = i % rows;
    const T C = batch.C[i], K = batch.factor[slot * batch.triangle() + r * (r + 1) / 2 + r];
    const bool inequality = batch.kinds[static_cast<size_t>(r)] == RowKind::inequality;
    batch.lower[i] = inequality ? T(0) : -unbounded<T>;
    batch.upper[i] = unbounded<T>;
    const SpringRow<T> row = inequality && C > T(0)
                                 ? SpringRow<T>{C / h, T(0)}
                                 : spring_row(C, K, batch.constants.data() + slot * spring_constants_count, h);
    batch.bias[i] += row.bias;
    batch.softness[i] = row.softness;
  }
}

template <class S>
void force_of_soft(const Batch<S>& batch, int slot, const typename S::Scalar* rate, typename S::Scalar* force) {
  using T = typename S::Scalar;
  for (int r = 0; r < batch.ops->rows; ++r) {
    const T C = batch.C[slot * batch.ops->rows + r];
    const bool inequality = batch.kinds[r] == RowKind::inequality;
    const T K = batch.factor[slot * batch.triangle() + r * (r + 1) / 2 + r];
    const T pull = spring_force(C, rate[r], K, batch.constants.data() + slot * spring_constants_count);
    force[r] = inequality && (C > T(0) || pull < T(0)) ? T(0) : pull;
  }
}

// A slack rope is no spring.
template <class S>
void numbers_of_soft(const Batch<S>& batch, int slot, SpringNumbers<typename S::Scalar>* numbers) {
  using T = typename S::Scalar;
  for (int r = 0; r < batch.ops->rows; ++r) {
    const T K = batch.factor[slot * batch.triangle() + r * (r + 1) / 2 + r];
    const bool slack = batch.kinds[r] == RowKind::inequality && batch.C[slot * batch.ops->rows + r] > T(0);
    numbers[r] = slack ? SpringNumbers<T>{T(0), T(0)}
                       : spring_numbers(K, batch.constants.data() + slot * spring_constants_count);
  }
}

template <class S>
double energy_soft(const Batch<S>& batch, int slot) {
  double energy = 0;
  const int rows = batch.ops->rows;
  for (int r = 0; r < rows; ++r) {
    const double C = batch.C[slot * rows + r];
    if (batch.kinds[r] == RowKind::inequality && C > 0) continue;
    const auto K = batch.factor[slot * batch.triangle() + r * (r + 1) / 2 + r];
    const auto* constants = batch.constants.data() + slot * spring_constants_count;
    energy += 0.5 * spring_stiffness(K, constants) * C * C;
  }
  return energy;
}

template <class S>
bool soft_by_frequency(const Batch<S>& batch, int slot) {
  return batch.constants[slot * spring_constants_count] != 0;
}

}  // namespace

template <class S>
const Law<S>& unilateral_law() {
  static constexpr Law<S> law{0, true, fill_unilateral<S>, error_unilateral<S>, nullptr, nullptr, guard_unilateral<S>};
  return law;
}

template <class S>
const Law<S>& soft_law() {
  static constexpr Law<S> law{.constants = spring_constants_count,
                              .reported = false,
                              .fill = fill_soft<S>,
                              .error = nullptr,
                              .energy = energy_soft<S>,
                              .force = force_of_soft<S>,
                              .guard = nullptr,
                              .spring = numbers_of_soft<S>,
                              .by_mass = soft_by_frequency<S>};
  return law;
}

#define CDOT_INSTANTIATE(S)                \
  template const Law<S>& unilateral_law(); \
  template const Law<S>& soft_law();
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
