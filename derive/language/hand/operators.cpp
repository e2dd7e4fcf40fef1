// The operators of hand derivations: masses, inertias, rotation matrices, skew matrices, Euler parameters.
#include "derive/language/operators.hpp"

#include "derive/expression/functions.hpp"
#include "derive/expression/symbols.hpp"

namespace cdot::derive {
namespace {

using Arguments = std::span<const Value>;

// w = 2 G de/dt.
Matrix matrix_of_rates(Pool& pool, int body) {
  const std::vector<Expr> e = body_euler_parameters(pool, body);
  return {3, 4, {-e[1], e[0], -e[3], e[2], -e[2], e[3], e[0], -e[1], -e[3], -e[2], e[1], e[0]}};
}

Value build_mass(Pool& pool, Arguments a) { return scalar(pow(inverse_mass(pool, a[0].body), -1)); }

// In space the leaves are those of the inverse; I is its inverse.
Value build_inertia(Pool& pool, Arguments a) {
  const Expr inverse_I = inverse_inertia(pool, a[0].body);
  if (pool.dimension() == 2) return scalar(pow(inverse_I, -1));
  Value v = of_matrix(tensor_matrix(inverse_I));
  v.tensor = inverse_I;
  v.inverted = true;
  return v;
}

Value build_skew(Pool& pool, Arguments a) {
  if (pool.dimension() == 2) return vector(perp(a[0].e));
  return skew_of(a[0].e);
}

Value build_inverse(Pool&, Arguments a) {
  if (!a[0].inverted) return of_matrix(inverse(*a[0].matrix));
  Value v = a[0];
  v.inverted = false;
  return v;
}

Value build_sign(Pool&, Arguments a) { return scalar(call(Fn::sign, a[0].e)); }

// Columns are the body's axes.
Value build_rotation(Pool& pool, Arguments a) {
  const std::vector<Expr> axes = body_axes(pool, a[0].body);
  const int n = pool.dimension();
  Matrix R{n, n, {}};
  for (int i = 0; i < n; ++i) {
    for (const Expr axis : axes) R.entries.push_back(component(axis, static_cast<std::size_t>(i)));
  }
  return of_matrix(std::move(R));
}

Value build_euler_parameters(Pool& pool, Arguments a) {
  return of_matrix({4, 1, body_euler_parameters(pool, a[0].body)});
}

Value build_matrix_of_rates(Pool& pool, Arguments a) { return of_matrix(matrix_of_rates(pool, a[0].body)); }

// de/dt = 1/2 G^T w, since G G^T is the identity.
Value build_euler_rates(Pool& pool, Arguments a) {
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

}  // namespace

std::vector<Operator> operators_of_hand_derivations() {
  using enum Operator::Where;
  using Space = Operator::Space;
  using Gives = UnitGiven;
  constexpr UnitRule kept = {UnitNeed::any, Gives::same}, to_number = {UnitNeed::any, Gives::number};
  // clang-format off
  return {
    {"m", "m(a)", {body_}, {UnitNeed::any, Gives::mass}, build_mass, "the mass of a body", hand},
    {"I", "I(a)", {body_}, {UnitNeed::any, Gives::inertia}, build_inertia, "the moment of inertia of a body", hand},
    {"skew", "skew(r)", {vector_}, kept, build_skew, "the matrix with skew(r) w = w x r", hand},
    {"S", "S(r)", {vector_}, kept, build_skew, "the same as skew(r)", hand},
    {"inverse", "inverse(M)", {matrix_}, to_number, build_inverse, "the inverse of a square matrix", hand},
    {"sign", "sign(s)", {number_}, to_number, build_sign, "the slope of abs(s): 1, -1, or 0 at 0", hand},
    {"R", "R(a)", {body_}, to_number, build_rotation, "the rotation matrix of a body", hand},
    {"e", "e(a)", {body_}, to_number, build_euler_parameters, "the Euler parameters of a body, a column of four", hand,
     Space::spatial},
    {"edot", "edot(a)", {body_}, to_number, build_euler_rates, "their rates", hand, Space::spatial},
    {"G", "G(a)", {body_}, to_number, build_matrix_of_rates, "the 3 x 4 matrix with w(a) = 2 G(a) edot(a)", hand,
     Space::spatial},
  };
  // clang-format on
}

}  // namespace cdot::derive
