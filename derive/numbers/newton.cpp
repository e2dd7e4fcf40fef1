#include "derive/numbers/newton.hpp"

#include <algorithm>

namespace cdot::derive {
namespace {

// x of A x = b by Gaussian elimination; A is symmetric, positive and, by a little on its diagonal,
// regular.
std::vector<double> solve(Gradients A, std::vector<double> b) {
  const std::size_t n = b.size();
  for (std::size_t k = 0; k < n; ++k) {
    for (std::size_t i = k + 1; i < n; ++i) {
      const double factor = A[k][k] == 0 ? 0 : A[i][k] / A[k][k];
      for (std::size_t j = k; j < n; ++j) A[i][j] -= factor * A[k][j];
      b[i] -= factor * b[k];
    }
  }
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t j = k + 1; j < n; ++j) b[k] -= A[k][j] * b[j];
    b[k] = A[k][k] == 0 ? 0 : b[k] / A[k][k];
  }
  return b;
}

}  // namespace

std::vector<double> shortest_step(const Gradients& G, const std::vector<double>& values) {
  const std::size_t n = G.size();
  if (n == 0) return {};
  Gradients K(n, std::vector<double>(n));
  double largest = 0;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      for (std::size_t k = 0; k < G[i].size(); ++k) K[i][j] += G[i][k] * G[j][k];
    }
    largest = std::max(largest, K[i][i]);
  }
  for (std::size_t i = 0; i < n; ++i) K[i][i] += 1e-13 * largest;
  const std::vector<double> lambda = solve(K, values);
  std::vector<double> step(G[0].size());
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < step.size(); ++k) step[k] -= G[i][k] * lambda[i];
  }
  return step;
}

}  // namespace cdot::derive
