#include "derive/derivation/forms.hpp"

#include <string>

#include "derive/expression/symbols.hpp"
#include "derive/numbers/modular.hpp"

namespace cdot::derive {
namespace {

Expr member(const Joint& joint, int body, const std::string& name) {
  return joint.pool->symbol(joint.bodies[static_cast<std::size_t>(body)] + "." + name, Role::given, body);
}

// G by its columns.
std::array<std::array<Expr, 3>, 4> rates_of_parameters(const std::array<Expr, 4>& e) {
  return {{{-e[1], -e[2], -e[3]}, {e[0], e[3], -e[2]}, {-e[3], e[0], e[1]}, {e[2], -e[1], e[0]}}};
}

// x = n y with a small whole number n.
bool is_small_multiple(Expr x, Expr y) {
  for (int n = 1; n <= 8; ++n) {
    if (difference_modulo_prime(x, Rational(n) * y) == Nullity::zero) return true;
    if (difference_modulo_prime(x, Rational(-n) * y) == Nullity::zero) return true;
  }
  return false;
}

}  // namespace

std::vector<std::vector<Expr>> rotation_matrix(const Joint& joint, int body) {
  const auto of = [&](const std::string& name) { return member(joint, body, name); };
  if (joint.dimension == 2) return {{of("c"), -of("s")}, {of("s"), of("c")}};
  std::vector<std::vector<Expr>> A(3);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) A[i].push_back(of(std::string{"xyz"[i], "xyz"[j]}));
  }
  return A;
}

std::array<Expr, 4> euler_parameters(const Joint& joint, int body) {
  const std::vector<Expr> e = body_euler_parameters(*joint.pool, body);
  return {e[0], e[1], e[2], e[3]};
}

std::vector<Expr> columns_in(Form form, const std::vector<Expr>& global, const Joint& joint, int body) {
  std::vector<Expr> columns(global.begin(), global.begin() + 3);
  const auto times = [&](const std::array<Expr, 3>& column) {
    return global[3] * column[0] + global[4] * column[1] + global[5] * column[2];
  };
  if (form == Form::global) columns = global;
  if (form == Form::local) {
    const auto A = rotation_matrix(joint, body);
    for (std::size_t k = 0; k < 3; ++k) columns.push_back(times({A[0][k], A[1][k], A[2][k]}));
  }
  if (form == Form::euler) {
    for (const auto& column : rates_of_parameters(euler_parameters(joint, body))) {
      columns.push_back(Rational(2) * times(column));
    }
  }
  return columns;
}

EulerColumns euler_columns(const ScalarRow& row, const Joint& joint, int body) {
  const Expr along = time_derivative(row.C, joint, {.stretched = body});
  if (difference_modulo_prime(along, along->pool->number(0)) == Nullity::zero) return EulerColumns::partial_derivative;
  if (is_small_multiple(along, row.C)) return EulerColumns::where_C_is_zero;
  return EulerColumns::tangent;
}

}  // namespace cdot::derive
