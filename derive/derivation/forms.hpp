// The three forms of velocity in space, and J in each: (a) v and the angular velocity w in world axes, as everywhere
// else in Cdot; (b) v and w' = A^T w in the body's axes; (c) v and the rates of the Euler parameters e, w = 2 G de/dt.
#pragma once

#include <array>
#include <vector>

#include "derive/derivation/derivation.hpp"

namespace cdot::derive {

inline std::size_t columns_per_body(Form form) { return form == Form::euler ? 7 : 6; }

// Members of a body's pose: A(e) row by row (in the plane [c -s; s c]), and e0, e1, e2, e3.
std::vector<std::vector<Expr>> rotation_matrix(const Joint& joint, int body);
std::array<Expr, 4> euler_parameters(const Joint& joint, int body);

// One body's columns of J in another form, from its six in form (a): J diag(E, A) or J diag(E, 2 G) with
//   G(e) = [-e1 e0 -e3 e2; -e2 e3 e0 -e1; -e3 -e2 e1 e0].
std::vector<Expr> columns_in(Form form, const std::vector<Expr>& global, const Joint& joint, int body);

// How the columns of the Euler parameters in form (c) stand to C itself. With A(e) of second degree in e, as it is
// written, dC/de = J_c + (dC/de . e) e^T wherever e . e = 1; the second part is nothing to rates with e . de/dt = 0.
enum class EulerColumns {
  partial_derivative,  // dC/de . e = 0: J_c is dC/de
  where_C_is_zero,     // dC/de . e = n C: J_c is dC/de where C = 0
  tangent              // J_c de/dt = dC/de de/dt only for rates that preserve e . e = 1
};
// For one body's columns in a row that has a C.
EulerColumns euler_columns(const ScalarRow& row, const Joint& joint, int body);

}  // namespace cdot::derive
