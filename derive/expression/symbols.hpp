// The leaves that stand for the state of a body; each has one name.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "derive/expression/expr.hpp"

namespace cdot::derive {

constexpr int most_bodies = 8;  // a to h

std::string body_name(int body);            // 0: "a"; -1: "world"
int body_of_letter(std::string_view word);  // "a": 0; -1 if it is none

Expr body_position(Pool& pool, int body);
Expr body_velocity(Pool& pool, int body);
Expr body_angle(Pool& pool, int body);
Expr body_spin(Pool& pool, int body);               // a vector in space
std::vector<Expr> body_axes(Pool& pool, int body);  // two or three; the world's for -1
Expr inverse_mass(Pool& pool, int body);
Expr inverse_inertia(Pool& pool, int body);
// The four Euler parameters of a body in space.
std::vector<Expr> body_euler_parameters(Pool& pool, int body);
Expr time_symbol(Pool& pool);
Expr pi_symbol(Pool& pool);
Expr unlimited_symbol(Pool& pool);  // infinity, the default of a bound
// Of sums and products of numbers and pi; empty for all else.
std::optional<double> constant_value(Expr e);

// Names that these leaves and the world's axes reserve.
bool is_symbol_of_tool(std::string_view name);
// Keywords of C++: kernels use the author's names as identifiers.
bool is_word_of_cpp(std::string_view name);
// Members of every kernel: no coordinate may have such a name.
bool is_member_of_kernels(std::string_view name);
// The arm of a point: `ra` of `pa`, `r_q` of `q`; a prefix from an include stays in front.
std::string arm_name(std::string_view prefix, std::string_view point);

}  // namespace cdot::derive
