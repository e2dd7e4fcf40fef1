#include "derive/language/hand/operators.hpp"

#include "derive/expression/symbols.hpp"

namespace cdot::derive {
namespace {

// w = 2 G de/dt.
Matrix matrix_of_rates(Pool& pool, int body) {
  const std::vector<Expr> e = body_euler_parameters(pool, body);
  return {3, 4, {-e[1], e[0], -e[3], e[2], -e[2], e[3], e[0], -e[1], -e[3], -e[2], e[1], e[0]}};
}

}  // namespace

Value build_mass(Pool& pool, std::span<const Value> a) { return scalar(pow(inverse_mass(pool, a[0].body), -1)); }

// In space the leaves are those of the inverse; I is its inverse.
Value build_inertia(Pool& pool, std::span<const Value> a) {
  const Expr inverse_I = inverse_inertia(pool, a[0].body);
  if (pool.dimension() == 2) return scalar(pow(inverse_I, -1));
  Value v = of_matrix(tensor_matrix(inverse_I));
  v.tensor = inverse_I;
  v.inverted = true;
  return v;
}

Value build_skew(Pool& pool, std::span<const Value> a) {
  if (pool.dimension() == 2) return vector(perp(a[0].e));
  return skew_of(a[0].e);
}

Value build_inverse(Pool&, std::span<const Value> a) {
  if (!a[0].inverted) return of_matrix(inverse(*a[0].matrix));
  Value v = a[0];
  v.inverted = false;
  return v;
}

// Columns are the body's axes.
Value build_rotation(Pool& pool, std::span<const Value> a) {
  const std::vector<Expr> axes = body_axes(pool, a[0].body);
  const int n = pool.dimension();
  Matrix R{n, n, {}};
  for (int i = 0; i < n; ++i) {
    for (const Expr axis : axes) R.entries.push_back(component(axis, static_cast<std::size_t>(i)));
  }
  return of_matrix(std::move(R));
}

Value build_euler_parameters(Pool& pool, std::span<const Value> a) {
  return of_matrix({4, 1, body_euler_parameters(pool, a[0].body)});
}

Value build_matrix_of_rates(Pool& pool, std::span<const Value> a) {
  return of_matrix(matrix_of_rates(pool, a[0].body));
}

// de/dt = 1/2 G^T w, since G G^T is the identity.
Value build_euler_rates(Pool& pool, std::span<const Value> a) {
  const Matrix G = matrix_of_rates(pool, a[0].body);
  const Expr w = body_spin(pool, a[0].body);
  Matrix rates{4, 1, {}};
  for (int k = 0; k < 4; ++k) {
    Expr sum = pool.number(0);
    for (int i = 0; i < 3; ++i) sum = sum + G.at(i, k) * component(w, static_cast<std::size_t>(i));
    rates.entries.push_back(Rational(1, 2) * sum);
  }
  return of_matrix(std::move(rates));
}

}  // namespace cdot::derive
