// An integrator of order 16 in long double: the modified midpoint rule, extrapolated (Gragg, Bulirsch, Stoer). Shares
// nothing with the runtime's integrators.
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <functional>

namespace cdot::peers {

using Real = long double;
using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
using Slope = std::function<Vector(const Vector&)>;

// n substeps of the modified midpoint rule over H: the error has only even powers of H / n.
inline Vector midpoint(const Slope& f, const Vector& y, Real H, int n) {
  const Real h = H / n;
  Vector before = y, now = y + h * f(y);
  for (int k = 1; k < n; ++k) {
    Vector next = before + 2 * h * f(now);
    before = std::move(now);
    now = std::move(next);
  }
  return (now + before + h * f(now)) / 2;
}

// From y over `time`, with steps whose estimated error stays below `tolerance` of 1 + |y|.
inline Vector extrapolate(const Slope& f, Vector y, Real time, Real tolerance) {
  constexpr int columns = 8;
  Real done = 0, H = time / 64;
  while (done < time) {
    H = std::min(H, time - done);
    Vector table[columns];
    Real error = 0;
    for (int k = 0; k < columns; ++k) {
      Vector last = midpoint(f, y, H, 2 * (k + 1));
      for (int j = 0; j < k; ++j) {
        const Real ratio = Real(k + 1) / Real(k - j);
        Vector next = last + (last - table[j]) / (ratio * ratio - 1);
        table[j] = std::move(last);
        last = std::move(next);
      }
      if (k == columns - 1) error = ((last - table[k - 1]).array().abs() / (1 + y.array().abs())).maxCoeff();
      table[k] = std::move(last);
    }
    const Real scale = std::pow(tolerance / std::max(error, Real(1e-30)), Real(1) / (2 * columns - 1));
    if (error <= tolerance) {
      done += H;
      y = table[columns - 1];
      if (time - done < 1e-15L * time) break;
    }
    H *= std::clamp(Real(0.9) * scale, Real(0.2), Real(3));
  }
  return y;
}

}  // namespace cdot::peers
