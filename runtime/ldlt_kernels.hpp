// The dense inside of Ldlt: what happens to one column of blocks, A unknowns wide. A and B are
// numbers of rows that joints have, their loops unrolled; 0 stands for any other, known at run time
// only.
#pragma once

#include <algorithm>
#include <array>
#include <type_traits>
#include <utility>

#include "runtime/ldlt.hpp"

namespace cdot::dense {

// --- loops, unrolled where their length is known ---

template <int n>
using Known = std::integral_constant<int, n>;

template <int A>
constexpr auto size(int otherwise) {
  if constexpr (A > 0)
    return Known<A>{};
  else
    return otherwise;
}
constexpr int next(int i) { return i + 1; }
template <int i>
constexpr Known<i + 1> next(Known<i>) {
  return {};
}

template <class F>
inline void times(int n, F f) {
  for (int i = 0; i < n; ++i) f(i);
}
template <int n, class F>
inline void times(Known<n>, F f) {
  [&]<int... i>(std::integer_sequence<int, i...>) { (f(Known<i>{}), ...); }
  (std::make_integer_sequence<int, n>{});
}

// A few numbers of an array, in registers where their count is known.
template <int A>
struct Few {
  double number[A];
  explicit Few(const double* from) {
    times(Known<A>{}, [&](auto i) { number[i] = from[i]; });
  }
  double& operator[](int i) { return number[i]; }
  void store(double* to) const {
    times(Known<A>{}, [&](auto i) { to[i] = number[i]; });
  }
};
template <>
struct Few<0> {
  double* number;
  explicit Few(double* from) : number(from) {}
  double& operator[](int i) { return number[i]; }
  void store(double*) const {}
};

template <int n>
Few<n> few(Known<n>, double* from) {
  return Few<n>(from);
}
inline Few<0> few(int, double* from) { return Few<0>(from); }

// --- factor ---

// K = L D L^T of the square, scalar pivot by scalar pivot. Returns how many were round-off.
template <int A>
int factor_square(const Column& column, const Numbers& numbers) {
  const auto a = size<A>(column.width);
  double* L = numbers.l + column.square;
  const double* K = numbers.K + column.square;
  double* inverse = numbers.inverse + column.first;
  double* noise = numbers.noise + column.first;
  int dependent = 0;
  times(a, [&](auto i) {
    double* row = L + i * a;
    const double added = numbers.added[column.first + i];
    times(i, [&](auto j) { times(j, [&](auto k) { row[j] -= row[k] * L[j * a + k]; }); });
    double pivot = row[i] + added;
    times(i, [&](auto j) {
      const double unscaled = row[j];
      row[j] *= inverse[j];
      pivot -= unscaled * row[j];
      noise[i] += row[j] * row[j] * noise[j];
    });
    inverse[i] = 0.0;
    if (numbers.out[column.first + i]) return;
    unsigned char& before = numbers.dependent[column.first + i];
    const double share = added != 0 ? numbers.soft_share : before >= lasting_count ? lasting_share : numbers.share;
    if (pivot > std::max(share * (K[i * a + i] + added), noise[i])) {
      inverse[i] = 1.0 / pivot;
      before = 0;
    } else {
      ++dependent;
      before = static_cast<unsigned char>(std::min(before + numbers.counts, 255));
    }
  });
  return dependent;
}

// K = (L D) L_square^T of the panel: L D by forward substitution in every row.
template <int A>
void factor_panel(const Column& column, const Numbers& numbers) {
  const auto a = size<A>(column.width);
  const double* L = numbers.l + column.square;
  const double* inverse = numbers.inverse + column.first;
  const double* noise = numbers.noise + column.first;
  const int* unknown = numbers.panel_row + column.rows;
  for (int h = 0; h < column.height; ++h) {
    double* panel = numbers.l + column.panel + h * a;
    double& blurred = numbers.noise[unknown[h]];
    Few<A> row(panel);
    times(a, [&](auto i) { times(i, [&](auto j) { row[i] -= row[j] * L[i * a + j]; }); });
    times(a, [&](auto i) { numbers.unscaled[i * column.height + h] = row[i]; });
    times(a, [&](auto i) {
      panel[i] = row[i] * inverse[i];
      blurred += panel[i] * panel[i] * noise[i];
    });
  }
}

template <int A>
int eliminate(const Column& column, const Numbers& numbers) {
  const int dependent = factor_square<A>(column, numbers);
  factor_panel<A>(column, numbers);
  return dependent;
}

// target -= L_left (L D)_above^T for some rows of the panel and B others of it. `lower`: they are
// the same, and only the lower triangle counts.
template <int A, int B, bool lower>
void update(const Column& column, const Part& part, const Numbers& numbers) {
  const auto a = size<A>(column.width);
  const auto b = size<B>(part.columns);
  const double* left = numbers.l + column.panel + part.left * a;
  const double* above = numbers.unscaled + part.above;
  double* __restrict target = numbers.l + part.target;
  const auto subtract = [&](int r, auto count) {
    auto row = few(count, target + r * part.stride);
    times(a, [&](auto k) {
      times(count, [&](auto s) { row[s] -= left[r * a + k] * above[k * column.height + s]; });
    });
    row.store(target + r * part.stride);
  };
  if constexpr (lower)
    times(b, [&](auto r) { subtract(r, next(r)); });
  else
    for (int r = 0; r < part.rows; ++r) subtract(r, b);
}

// --- solve ---

// x = D^-1 L^-1 x of the column; every row of the panel loses its share.
template <int A>
void forward(const Column& column, const Numbers& numbers, double* x) {
  const auto a = size<A>(column.width);
  const double* L = numbers.l + column.square;
  Few<A> own(x + column.first);
  times(a, [&](auto i) { times(i, [&](auto j) { own[i] -= L[i * a + j] * own[j]; }); });
  const double* row = numbers.l + column.panel;
  const int* to = numbers.panel_row + column.rows;
  for (int h = 0; h < column.height; ++h, row += a) {
    double sum = row[0] * own[0];
    for (int i = 1; i < a; ++i) sum += row[i] * own[i];
    x[to[h]] -= sum;
  }
  times(a, [&](auto i) { own[i] *= numbers.inverse[column.first + i]; });
  own.store(x + column.first);
}

// x = L^-T x of the column.
template <int A>
void backward(const Column& column, const Numbers& numbers, double* x) {
  const auto a = size<A>(column.width);
  const double* L = numbers.l + column.square;
  Few<A> own(x + column.first);
  const double* row = numbers.l + column.panel;
  const int* from = numbers.panel_row + column.rows;
  for (int h = 0; h < column.height; ++h, row += a) {
    const double known = x[from[h]];
    times(a, [&](auto i) { own[i] -= row[i] * known; });
  }
  for (int i = a - 1; i > 0; --i)
    for (int j = 0; j < i; ++j) own[j] -= L[i * a + j] * own[i];
  own.store(x + column.first);
}

// --- tables by size ---

inline constexpr int largest = 6;  // rows of a joint
constexpr int kind(int rows) { return rows <= largest ? rows : 0; }
using Sizes = std::make_integer_sequence<int, largest + 1>;

template <int... A>
constexpr std::array<Eliminate, sizeof...(A)> all_eliminate(std::integer_sequence<int, A...>) {
  return {eliminate<A>...};
}
template <int... A>
constexpr std::array<Sweep, sizeof...(A)> all_forward(std::integer_sequence<int, A...>) {
  return {forward<A>...};
}
template <int... A>
constexpr std::array<Sweep, sizeof...(A)> all_backward(std::integer_sequence<int, A...>) {
  return {backward<A>...};
}
template <bool lower, int A, int... B>
constexpr std::array<Update, sizeof...(B)> all_update_of(std::integer_sequence<int, B...>) {
  return {update<A, B, lower>...};
}
template <bool lower, int... A>
constexpr auto all_update(std::integer_sequence<int, A...> sizes) {
  return std::array{all_update_of<lower, A>(sizes)...};
}

}  // namespace cdot::dense
