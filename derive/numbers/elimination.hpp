// Gaussian elimination without a search for pivots, for numbers and for expressions.
#pragma once

#include <vector>

namespace cdot::derive {

// Solves A x = b. `quotient(a, pivot)` divides, and decides what happens at a zero pivot.
template <class T, class Quotient>
std::vector<T> solved(std::vector<std::vector<T>> A, std::vector<T> b, Quotient quotient) {
  const std::size_t n = b.size();
  for (std::size_t k = 0; k < n; ++k) {
    for (std::size_t i = k + 1; i < n; ++i) {
      const T factor = quotient(A[i][k], A[k][k]);
      for (std::size_t j = k; j < n; ++j) A[i][j] = A[i][j] - factor * A[k][j];
      b[i] = b[i] - factor * b[k];
    }
  }
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t j = k + 1; j < n; ++j) b[k] = b[k] - A[k][j] * b[j];
    b[k] = quotient(b[k], A[k][k]);
  }
  return b;
}

}  // namespace cdot::derive
