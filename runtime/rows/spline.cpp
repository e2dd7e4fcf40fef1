#include "runtime/rows/spline.hpp"

#include <cmath>

namespace cdot {
namespace {

// x of the tridiagonal system lower x[k-1] + diagonal x[k] + upper x[k+1] = right. Replaces `right` by x.
struct Tridiagonal {
  std::vector<double> lower, diagonal, upper;
  explicit Tridiagonal(std::size_t n) : lower(n), diagonal(n), upper(n) {}
  void row(std::size_t k, double l, double d, double u) { lower[k] = l, diagonal[k] = d, upper[k] = u; }
  void solve(std::vector<double>& right) const {
    const std::size_t n = right.size();
    std::vector<double> pivot = diagonal;
    for (std::size_t k = 1; k < n; ++k) {
      const double share = lower[k] / pivot[k - 1];
      pivot[k] -= share * upper[k - 1];
      right[k] -= share * right[k - 1];
    }
    right[n - 1] /= pivot[n - 1];
    for (std::size_t k = n - 1; k-- > 0;) right[k] = (right[k] - upper[k] * right[k + 1]) / pivot[k];
  }
};

struct Rows {
  std::vector<double> h, rise;  // of the pieces: length and slope
};

Rows rows_of(const ProfileTable& table) {
  Rows rows;
  for (std::size_t k = 0; k + 1 < table.times.size(); ++k) {
    rows.h.push_back(table.times[k + 1] - table.times[k]);
    rows.rise.push_back((table.values[k + 1] - table.values[k]) / rows.h[k]);
  }
  return rows;
}

// The slopes of a spline that is the same cubic on both sides of its second row, and of the last but one ("not a
// knot"): C. de Boor, "A Practical Guide to Splines", 1978, chapter IV. Three rows are a parabola.
std::vector<double> slopes(const Rows& rows) {
  const auto& [h, rise] = rows;
  const std::size_t n = h.size() + 1;
  if (n == 2) return {rise[0], rise[0]};
  Tridiagonal system(n);
  std::vector<double> slope(n);
  for (std::size_t k = 1; k + 1 < n; ++k) {
    system.row(k, h[k], 2 * (h[k - 1] + h[k]), h[k - 1]);
    slope[k] = 3 * (h[k] * rise[k - 1] + h[k - 1] * rise[k]);
  }
  if (n == 3) {
    system.row(0, 0, 1, 1), slope[0] = 2 * rise[0];
    system.row(2, 1, 1, 0), slope[2] = 2 * rise[1];
  } else {
    const auto end = [](double near, double next, double rise_near, double rise_next) {
      return ((near + 2 * (near + next)) * next * rise_near + near * near * rise_next) / (near + next);
    };
    system.row(0, 0, h[1], h[0] + h[1]), slope[0] = end(h[0], h[1], rise[0], rise[1]);
    system.row(n - 1, h[n - 2] + h[n - 3], h[n - 3], 0);
    slope[n - 1] = end(h[n - 2], h[n - 3], rise[n - 2], rise[n - 3]);
  }
  system.solve(slope);
  return slope;
}

// The slopes of a periodic spline: a cyclic system as a tridiagonal one and a correction of rank one (Sherman and
// Morrison, 1950).
std::vector<double> periodic_slopes(const Rows& rows) {
  const auto& [h, rise] = rows;
  const std::size_t n = h.size();  // the last row is the first one again
  if (n < 3) return std::vector<double>(n + 1, n == 1 ? 0 : (h[0] * rise[1] + h[1] * rise[0]) / (h[0] + h[1]));
  Tridiagonal system(n);
  std::vector<double> slope(n), corner(n, 0.0);
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t before = k == 0 ? n - 1 : k - 1;
    system.row(k, h[k], 2 * (h[before] + h[k]), h[before]);
    slope[k] = 3 * (h[k] * rise[before] + h[before] * rise[k]);
  }
  const double first = system.lower[0], last = system.upper[n - 1], gamma = -system.diagonal[0];
  system.diagonal[0] -= gamma, system.diagonal[n - 1] -= first * last / gamma;
  corner[0] = gamma, corner[n - 1] = last;
  system.solve(slope), system.solve(corner);
  const double share = (slope[0] + first * slope[n - 1] / gamma) / (1 + corner[0] + first * corner[n - 1] / gamma);
  for (std::size_t k = 0; k < n; ++k) slope[k] -= share * corner[k];
  slope.push_back(slope[0]);
  return slope;
}

}  // namespace

std::vector<Cubic> pieces_of(const ProfileTable& table) {
  const Rows rows = rows_of(table);
  const std::size_t n = rows.h.size();
  std::vector<Cubic> pieces(n);
  std::vector<double> slope;
  if (table.interpolation == Interpolation::cubic)
    slope = table.beyond == Beyond::repeat ? periodic_slopes(rows) : slopes(rows);
  for (std::size_t k = 0; k < n; ++k) {
    const double y = table.values[k], h = rows.h[k], rise = rows.rise[k];
    if (table.interpolation == Interpolation::step) pieces[k] = {y, 0, 0, 0};
    else if (table.interpolation == Interpolation::linear) pieces[k] = {y, rise, 0, 0};
    else
      pieces[k] = {y, slope[k], (3 * rise - 2 * slope[k] - slope[k + 1]) / h,
                   (slope[k] + slope[k + 1] - 2 * rise) / (h * h)};
  }
  return pieces;
}

}  // namespace cdot
