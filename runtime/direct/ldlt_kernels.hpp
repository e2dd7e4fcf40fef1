// The dense operations of Ldlt on one column of blocks, A unknowns wide. A and B are numbers of rows of joints with
// unrolled loops; 0: any other number, known only at run time.
#pragma once

#include <algorithm>
#include <array>
#include <type_traits>
#include <utility>

#include "runtime/direct/ldlt.hpp"

namespace cdot::dense {

// --- loops, unrolled where their length is known ---

template <int n>
using Known = std::integral_constant<int, n>;

template <int A>
constexpr auto size(int otherwise) {
  if constexpr (A > 0) return Known<A>{};
  else return otherwise;
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

// A few numbers of an array, in registers if their count is known.
template <class Real, int A>
struct Few {
  Real number[A];
  explicit Few(const Real* from) {
    times(Known<A>{}, [&](auto i) { number[i] = from[i]; });
  }
  Real& operator[](int i) { return number[i]; }
  void store(Real* to) const {
    times(Known<A>{}, [&](auto i) { to[i] = number[i]; });
  }
};
template <class Real>
struct Few<Real, 0> {
  Real* number;
  explicit Few(Real* from) : number(from) {}
  Real& operator[](int i) { return number[i]; }
  void store(Real*) const {}
};

template <class Real, int n>
Few<Real, n> few(Known<n>, Real* from) {
  return Few<Real, n>(from);
}
template <class Real>
Few<Real, 0> few(int, Real* from) {
  return Few<Real, 0>(from);
}

// --- factor ---

// K = L D L^T of the square, by scalar pivots. Returns the number of pivots that are round-off.
template <class Real, int A>
int factor_square(const Column& column, const Numbers<Real>& numbers) {
  const auto a = size<A>(column.width);
  Real* L = numbers.l + column.square;
  const Real* K = numbers.K + column.square;
  Real* inverse = numbers.inverse + column.first;
  Real* noise = numbers.noise + column.first;
  int dependent = 0;
  times(a, [&](auto i) {
    Real* row = L + i * a;
    const Real added = numbers.added[column.first + i];
    times(i, [&](auto j) { times(j, [&](auto k) { row[j] -= row[k] * L[j * a + k]; }); });
    Real pivot = row[i] + added;
    times(i, [&](auto j) {
      const Real unscaled = row[j];
      row[j] *= inverse[j];
      pivot -= unscaled * row[j];
      noise[i] += row[j] * row[j] * noise[j];
    });
    inverse[i] = 0.0;
    if (numbers.out[column.first + i]) return;
    unsigned char& before = numbers.dependent[column.first + i];
    const double share = added != 0 ? numbers.soft_share : before >= lasting_count ? lasting_share : numbers.share;
    const Real least = share * (K[i * a + i] + added);
    if (pivot > std::max(least, noise[i])) {
      inverse[i] = 1.0 / pivot;
      before = 0;
    } else {
      ++dependent;
      numbers.doubtful[column.first + i] = pivot > least ? pivot : Real(0);
      before = static_cast<unsigned char>(std::min(before + numbers.counts, 255));
    }
  });
  return dependent;
}

// K = (L D) L_square^T of the panel: L D by forward substitution in every row.
template <class Real, int A>
void factor_panel(const Column& column, const Numbers<Real>& numbers) {
  const auto a = size<A>(column.width);
  const Real* L = numbers.l + column.square;
  const Real* inverse = numbers.inverse + column.first;
  const Real* noise = numbers.noise + column.first;
  const int* unknown = numbers.panel_row + column.rows;
  for (int h = 0; h < column.height; ++h) {
    Real* panel = numbers.l + column.panel + h * a;
    Real& blurred = numbers.noise[unknown[h]];
    Few<Real, A> row(panel);
    times(a, [&](auto i) { times(i, [&](auto j) { row[i] -= row[j] * L[i * a + j]; }); });
    times(a, [&](auto i) { numbers.unscaled[i * column.height + h] = row[i]; });
    times(a, [&](auto i) {
      panel[i] = row[i] * inverse[i];
      blurred += panel[i] * panel[i] * noise[i];
    });
  }
}

template <class Real, int A>
int eliminate(const Column& column, const Numbers<Real>& numbers) {
  const int dependent = factor_square<Real, A>(column, numbers);
  factor_panel<Real, A>(column, numbers);
  return dependent;
}

// target -= L_left (L D)_above^T for rows `left` and B rows `above` of the panel. `lower`: both are the same rows, and
// only the lower triangle counts.
template <class Real, int A, int B, bool lower>
void update(const Column& column, const Part& part, const Numbers<Real>& numbers) {
  const auto a = size<A>(column.width);
  const auto b = size<B>(part.columns);
  const Real* left = numbers.l + column.panel + part.left * a;
  const Real* above = numbers.unscaled + part.above;
  Real* __restrict target = numbers.l + part.target;
  const auto subtract = [&](int r, auto count) {
    auto row = few(count, target + r * part.stride);
    times(a, [&](auto k) { times(count, [&](auto s) { row[s] -= left[r * a + k] * above[k * column.height + s]; }); });
    row.store(target + r * part.stride);
  };
  if constexpr (lower) times(b, [&](auto r) { subtract(r, next(r)); });
  else
    for (int r = 0; r < part.rows; ++r) subtract(r, b);
}

// --- solve ---

// x = D^-1 L^-1 x of the column; subtracts the column's share from every row of the panel.
template <class Real, int A>
void forward(const Column& column, const Numbers<Real>& numbers, Real* x) {
  const auto a = size<A>(column.width);
  const Real* L = numbers.l + column.square;
  Few<Real, A> own(x + column.first);
  times(a, [&](auto i) { times(i, [&](auto j) { own[i] -= L[i * a + j] * own[j]; }); });
  const Real* row = numbers.l + column.panel;
  const int* to = numbers.panel_row + column.rows;
  for (int h = 0; h < column.height; ++h, row += a) {
    Real sum = row[0] * own[0];
    for (int i = 1; i < a; ++i) sum += row[i] * own[i];
    x[to[h]] -= sum;
  }
  times(a, [&](auto i) { own[i] *= numbers.inverse[column.first + i]; });
  own.store(x + column.first);
}

// x = L^-T x of the column.
template <class Real, int A>
void backward(const Column& column, const Numbers<Real>& numbers, Real* x) {
  const auto a = size<A>(column.width);
  const Real* L = numbers.l + column.square;
  Few<Real, A> own(x + column.first);
  const Real* row = numbers.l + column.panel;
  const int* from = numbers.panel_row + column.rows;
  for (int h = 0; h < column.height; ++h, row += a) {
    const Real known = x[from[h]];
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

template <class Real, int... A>
constexpr std::array<Eliminate<Real>, sizeof...(A)> all_eliminate(std::integer_sequence<int, A...>) {
  return {eliminate<Real, A>...};
}
template <class Real, int... A>
constexpr std::array<Sweep<Real>, sizeof...(A)> all_forward(std::integer_sequence<int, A...>) {
  return {forward<Real, A>...};
}
template <class Real, int... A>
constexpr std::array<Sweep<Real>, sizeof...(A)> all_backward(std::integer_sequence<int, A...>) {
  return {backward<Real, A>...};
}
template <class Real, bool lower, int A, int... B>
constexpr std::array<Update<Real>, sizeof...(B)> all_update_of(std::integer_sequence<int, B...>) {
  return {update<Real, A, B, lower>...};
}
template <class Real, bool lower, int... A>
constexpr auto all_update(std::integer_sequence<int, A...> sizes) {
  return std::array{all_update_of<Real, lower, A>(sizes)...};
}

}  // namespace cdot::dense
