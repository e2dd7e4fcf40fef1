// The dense inside of Ldlt: what happens to one block of A rows. A and B are 1 to 6 where a joint's
// rows are, and 0 for any other number, which is then given at run time.
#pragma once

#include <array>
#include <utility>

namespace cdot::dense {

// The square of a column, its panel, and what eliminating it needs and gives.
struct Column {
  double* square;             // K's, lower triangle; then L's below the diagonal
  double* panel;              // K's; then L's
  double* unscaled;           // L D of the panel
  double* inverse;            // D^-1; 0 where a row is out or depends on others
  const double* original;     // the square as it was before any elimination
  const double* added;        // on the diagonal
  const char* out;            // rows that do not take part
  int width, height;
};

// K = L D L^T of the square, scalar pivot by scalar pivot. Returns how many were round-off beside
// what their row began with.
template <int A>
int factor_square(const Column& column, double tolerance) {
  const int a = A ? A : column.width;
  double* L = column.square;
  int dependent = 0;
  for (int i = 0; i < a; ++i) {
    double* row = L + i * a;
    const double original = column.original[i * a + i] + column.added[i];
    double pivot = row[i] + column.added[i];
    for (int j = 0; j < i; ++j) {
      for (int k = 0; k < j; ++k) row[j] -= row[k] * L[j * a + k];  // row[k] = L_ik D_k
    }
    for (int j = 0; j < i; ++j) {
      const double unscaled = row[j];
      row[j] *= column.inverse[j];
      pivot -= unscaled * row[j];
    }
    const bool out = column.out[i] != 0, independent = pivot > tolerance * original;
    column.inverse[i] = independent && !out ? 1.0 / pivot : 0.0;
    dependent += !independent && !out;
  }
  return dependent;
}

// Panel: K = (L D) L_square^T, so L D by forward substitution in every row.
template <int A>
void factor_panel(const Column& column) {
  const int a = A ? A : column.width;
  const double* L = column.square;
  for (int h = 0; h < column.height; ++h) {
    double* row = column.panel + h * a;
    double* unscaled = column.unscaled + h * a;
    for (int i = 0; i < a; ++i) {
      double sum = row[i];
      for (int j = 0; j < i; ++j) sum -= unscaled[j] * L[i * a + j];
      unscaled[i] = sum;
    }
    for (int i = 0; i < a; ++i) row[i] = unscaled[i] * column.inverse[i];
  }
}

template <int A>
int eliminate(const Column& column, double tolerance) {
  const int dependent = factor_square<A>(column, tolerance);
  factor_panel<A>(column);
  return dependent;
}

// target -= L_left (L D)_above^T: `rows` rows of a panel with B of its rows. With `lower` the rows
// are the same on both sides, and only the lower triangle counts.
template <int A, int B, bool lower>
void update(const double* left, const double* above, int width, int rows, int columns,
            double* __restrict target) {
  const int a = A ? A : width, b = B ? B : columns;
  for (int r = 0; r < (lower ? b : rows); ++r) {
    for (int s = 0; s < (lower ? r + 1 : b); ++s) {
      double sum = left[r * a] * above[s * a];
      for (int k = 1; k < a; ++k) sum += left[r * a + k] * above[s * a + k];
      target[r * b + s] -= sum;
    }
  }
}

// Forward: x_square = L^-1 x, every row of the panel less its share; then D^-1.
template <int A>
void forward(const double* square, const double* panel, const double* inverse, const int* row,
             int width, int height, double* first, double* x) {
  const int a = A ? A : width;
  for (int i = 1; i < a; ++i)
    for (int j = 0; j < i; ++j) first[i] -= square[i * a + j] * first[j];
  double own[A ? A : 1];
  const double* y = first;
  if constexpr (A > 0) {
    for (int i = 0; i < A; ++i) own[i] = first[i];
    y = own;
  }
  for (int h = 0; h < height; ++h) {
    double sum = panel[h * a] * y[0];
    for (int i = 1; i < a; ++i) sum += panel[h * a + i] * y[i];
    x[row[h]] -= sum;
  }
  for (int i = 0; i < a; ++i) first[i] = y[i] * inverse[i];
}

template <int A>
void backward(const double* square, const double* panel, const int* row, int width, int height,
              double* first, const double* x) {
  const int a = A ? A : width;
  for (int h = 0; h < height; ++h)
    for (int i = 0; i < a; ++i) first[i] -= panel[h * a + i] * x[row[h]];
  for (int i = a - 1; i > 0; --i)
    for (int j = 0; j < i; ++j) first[j] -= square[i * a + j] * first[i];
}

// --- tables by size ---

inline constexpr int largest = 6;  // rows of a joint
constexpr int kind(int rows) { return rows <= largest ? rows : 0; }

using Eliminate = int (*)(const Column&, double tolerance);
using Update = void (*)(const double*, const double*, int, int, int, double*);
using Forward = void (*)(const double*, const double*, const double*, const int*, int, int, double*,
                         double*);
using Backward = void (*)(const double*, const double*, const int*, int, int, double*,
                          const double*);

template <int... A>
constexpr std::array<Eliminate, sizeof...(A)> eliminates(std::integer_sequence<int, A...>) {
  return {eliminate<A>...};
}
template <int... A>
constexpr std::array<Forward, sizeof...(A)> forwards(std::integer_sequence<int, A...>) {
  return {forward<A>...};
}
template <int... A>
constexpr std::array<Backward, sizeof...(A)> backwards(std::integer_sequence<int, A...>) {
  return {backward<A>...};
}
template <bool lower, int A, int... B>
constexpr std::array<Update, sizeof...(B)> updates_of(std::integer_sequence<int, B...>) {
  return {update<A, B, lower>...};
}
template <bool lower, int... A>
constexpr std::array<std::array<Update, sizeof...(A)>, sizeof...(A)> updates(
    std::integer_sequence<int, A...> sizes) {
  return {updates_of<lower, A>(sizes)...};
}

using Sizes = std::make_integer_sequence<int, largest + 1>;

}  // namespace cdot::dense
