// Alternatives to the kernel's own factor and solve for K lambda = rhs. They need only the kernel contract, so they are
// written once here and not generated for every joint.
#pragma once

#include <cdot/kernel.hpp>

namespace cdot {

// K = L D L^T of J M^-1 J^T without K: each row of J is made conjugate to those before it,
//   L_rs = j_r M^-1 j_s / D_s,   j_r -= L_rs j_s,   D_r = j_r M^-1 j_r,
// so no pivot is a difference of large numbers. The relative error of K's pivots grows with the square of the block's
// condition, as for a long arm on a body of little inertia. The error of these pivots grows with the condition. F has
// the layout of the kernel's factor. J and W = J M^-1 are dense, and lost. Compiled once for all blocks of a size.
template <int rows, int columns, class T, int triangle>
[[gnu::noinline]] void factor_conjugate_rows(T (&J)[rows][columns], T (&W)[rows][columns], T (&F)[triangle]) {
  const T round_off = T(64 * std::numeric_limits<typename ScalarOf<T>::type>::epsilon());
  const auto product = [](const T(&x)[columns], const T(&y)[columns]) {
    T sum = x[0] * y[0];
    for (int c = 1; c < columns; ++c) sum = sum + x[c] * y[c];
    return sum;
  };
  for (int r = 0; r < rows; ++r) {
    T* const row = F + r * (r + 1) / 2;
    const T before = product(J[r], W[r]);
    for (int s = 0; s < r; ++s) {
      row[s] = product(J[r], W[s]) * F[s * (s + 3) / 2];
      for (int c = 0; c < columns; ++c) {
        J[r][c] = J[r][c] - row[s] * J[s][c];
        W[r][c] = W[r][c] - row[s] * W[s][c];
      }
    }
    const T left = product(J[r], W[r]);
    // A row that depends on earlier rows leaves the squares of round-off.
    row[r] = select(left > round_off * round_off * before, T(1) / left, T(0));
  }
}

template <int columns, class Block, class Jacobian, class InverseMass, class T, int triangle>
void factor_by_rows(const Block& block, const Jacobian& J, const InverseMass (&m)[Block::bodies], T (&F)[triangle]) {
  T D[Block::rows][columns], W[Block::rows][columns];
  block.dense(J, D);
  block.inverse_mass_jacobian(J, m, W);
  factor_conjugate_rows(D, W, F);
}

// K^-1 of two rows in place of the factors: the solution needs two independent products instead of two dependent
// substitutions. If K is singular, the row with the larger diagonal entry gets the whole impulse.
template <class T>
inline void invert(const T (&K)[3], T (&G)[3]) {
  const T inv_det = pivot(K[0] * K[2] - K[1] * K[1], K[0] * K[2]);
  const bool first = K[0] >= K[2];
  const T alone = inverse(select(first, K[0], K[2])), none(0);
  const bool regular = inv_det > none;
  G[0] = select(regular, K[2] * inv_det, select(first, alone, none));
  G[1] = select(regular, -K[1] * inv_det, none);
  G[2] = select(regular, K[0] * inv_det, select(first, none, alone));
}
template <class T>
inline void multiply(const T (&G)[3], const T (&rhs)[2], T (&lambda)[2]) {
  lambda[0] = G[0] * rhs[0] + G[1] * rhs[1];
  lambda[1] = G[1] * rhs[0] + G[2] * rhs[1];
}

}  // namespace cdot
