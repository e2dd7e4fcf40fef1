// Broyden's method: solves F(x) = 0 with an old factor B of dF/dx, corrected by a rank-one update after each step. Near
// a singular pose the joints' directions change within a step and B is wrong in one direction. Two or three updates
// correct that. (C. T. Kelley, "Iterative Methods for Linear and Nonlinear Equations", 1995, 7.3.)
#pragma once

#include <cmath>
#include <vector>

namespace cdot {

template <class Real>
class Broyden {
 public:
  static constexpr int most_steps = 24;

  void reserve(size_t unknowns) {
    n_ = unknowns;
    steps_.assign(n_ * (most_steps + 1), Real(0));
    sizes_.assign(most_steps + 1, 0.0);
    weights_.assign(n_, 1.0);
  }
  // weight(i): weight of unknown i in the products <s, z>, which makes unknowns of different units comparable.
  template <class F>
  void begin(F weight) {
    count_ = 0;
    for (size_t i = 0; i < n_; ++i) weights_[i] = weight(i);
  }

  // In: z = -B^-1 F at the present point. Out: the step from there. False if the method has no further step.
  //   z += s_j+1 <s_j, z> / <s_j, s_j> for the steps s_j so far, then s = z / (1 - <s_n, z> / <s_n, s_n>)
  bool next(Real* z) {
    if (count_ > most_steps) return false;
    Real lengthen = 1;
    for (int j = 0; j < count_; ++j) {
      const Real* step = steps_.data() + static_cast<size_t>(j) * n_;
      const Real size = sizes_[static_cast<size_t>(j)], share = size > 0 ? product(step, z) / size : Real(0);
      if (j + 1 < count_)
        for (size_t i = 0; i < n_; ++i) z[i] += step[n_ + i] * share;
      else lengthen = 1 / (1 - share);
    }
    if (!(std::abs(lengthen) < longest)) return false;
    Real* step = steps_.data() + static_cast<size_t>(count_) * n_;
    for (size_t i = 0; i < n_; ++i) step[i] = z[i] *= lengthen;
    sizes_[static_cast<size_t>(count_++)] = product(step, step);
    return true;
  }

 private:
  static constexpr double longest = 1e6;

  Real product(const Real* x, const Real* y) const {
    Real sum = 0;
    for (size_t i = 0; i < n_; ++i) sum += weights_[i] * x[i] * y[i];
    return sum;
  }

  size_t n_ = 0;
  int count_ = 0;
  std::vector<Real> steps_, sizes_, weights_;  // sizes_: <s_j, s_j>
};

}  // namespace cdot
