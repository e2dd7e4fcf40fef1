// Gaussian elimination of a dense matrix with row pivots, for numbers and complex numbers.
#pragma once

#include <cmath>
#include <utility>
#include <vector>

namespace cdot {

// std::complex would test each product for infinities.
struct Complex {
  double re = 0, im = 0;
  Complex& operator-=(Complex b) {
    re -= b.re, im -= b.im;
    return *this;
  }
};
constexpr Complex operator+(Complex a, Complex b) { return {a.re + b.re, a.im + b.im}; }
constexpr Complex operator-(Complex a, Complex b) { return {a.re - b.re, a.im - b.im}; }
constexpr Complex operator*(Complex a, Complex b) { return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re}; }
constexpr Complex operator*(double a, Complex b) { return {a * b.re, a * b.im}; }
constexpr Complex inverse_of(Complex a) {
  const double square = a.re * a.re + a.im * a.im;
  return {a.re / square, -a.im / square};
}
constexpr double inverse_of(double a) { return 1 / a; }
inline double size_of(Complex a) { return std::abs(a.re) + std::abs(a.im); }
inline double size_of(double a) { return std::abs(a); }

template <class Number>
class Lu {
 public:
  void reserve(std::size_t n) {
    n_ = n;
    entries_.assign(n * n, Number{});
    pivots_.assign(n, 0);
  }
  std::size_t size() const { return n_; }
  Number& at(std::size_t row, std::size_t column) { return entries_[row * n_ + column]; }

  // P A = L U; false if A is singular or not finite.
  bool factor() {
    for (std::size_t k = 0; k < n_; ++k) {
      std::size_t best = k;
      for (std::size_t r = k + 1; r < n_; ++r)
        if (size_of(at(r, k)) > size_of(at(best, k))) best = r;
      const double size = size_of(at(best, k));
      if (!(size > 0) || !std::isfinite(size)) return false;
      pivots_[k] = best;
      if (best != k) std::swap_ranges(&at(k, 0), &at(k, 0) + n_, &at(best, 0));
      eliminate(k);
    }
    return true;
  }

  // b = A^-1 b
  void solve(Number* b) {
    for (std::size_t k = 0; k < n_; ++k) {
      std::swap(b[k], b[pivots_[k]]);
      for (std::size_t c = 0; c < k; ++c) b[k] -= at(k, c) * b[c];
    }
    for (std::size_t k = n_; k-- > 0;) {
      for (std::size_t c = k + 1; c < n_; ++c) b[k] -= at(k, c) * b[c];
      b[k] = inverse_of(at(k, k)) * b[k];
    }
  }

 private:
  void eliminate(std::size_t k) {
    const Number inverse = inverse_of(at(k, k)), *const pivot_row = &at(k, 0);
    for (std::size_t r = k + 1; r < n_; ++r) {
      Number* const row = &at(r, 0);
      if (size_of(row[k]) == 0) continue;
      const Number factor = row[k] = row[k] * inverse;
      for (std::size_t c = k + 1; c < n_; ++c) row[c] -= factor * pivot_row[c];
    }
  }

  std::size_t n_ = 0;
  std::vector<Number> entries_;  // by rows
  std::vector<std::size_t> pivots_;
};

}  // namespace cdot
