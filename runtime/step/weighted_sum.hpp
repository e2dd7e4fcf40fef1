// sum_j weights_j rows_j of rows of numbers. Some neighbours are summed at a time, in registers; each in the order of j.
#pragma once

#include <cstddef>

#include "runtime/step/runge_kutta_tables.hpp"

namespace cdot {

// Sums rows of T in A, both floating point numbers; at most `most_stages` rows.
template <class A, class T>
class WeightedSum {
 public:
  void add(A weight, const T* row) {
    if (weight == 0) return;
    weights_[count_] = weight;
    rows_[count_++] = row;
  }
  bool empty() const { return count_ == 0; }

  // f(k, sum) for k = 0 .. n - 1
  template <class F>
  void each(size_t n, F f) const {
    size_t k = 0;
    for (; k + lanes <= n; k += lanes) neighbours<lanes>(k, f);
    for (; k < n; ++k) neighbours<1>(k, f);
  }

 private:
  static constexpr size_t lanes = 4;

  template <size_t count, class F>
  void neighbours(size_t k, F& f) const {
    A sums[count] = {};
    for (int j = 0; j < count_; ++j) {
      const T* const row = rows_[j] + k;
      for (size_t i = 0; i < count; ++i) sums[i] += weights_[j] * A(row[i]);
    }
    for (size_t i = 0; i < count; ++i) f(k + i, sums[i]);
  }

  A weights_[most_stages];
  const T* rows_[most_stages];
  int count_ = 0;
};

}  // namespace cdot
