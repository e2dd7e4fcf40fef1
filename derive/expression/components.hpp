// Vectors to components: scalar expressions, as a kernel computes them, in an order that depends on names only.
#pragma once

#include <map>
#include <vector>

#include "derive/expression/expr.hpp"

namespace cdot::derive {

// A body's axes as a second system of coordinates: its rotation matrix, and the leaves that are fixed in it by their
// components there.
struct LocalAxes {
  int body = -1;
  std::string name;  // of the body
  std::vector<std::vector<Expr>> A;
  std::map<const Node*, std::vector<Expr>> fixed;
};

// Writes expressions out in components along the world's axes. A vector leaf `t` becomes the scalars `t_x`, `t_y` (and
// `t_z` in space) with the same role and body, a tensor leaf its six; dot, cross, perp, norm and unit vanish; a
// negative power becomes the guarded `inverse`. Components and products of named things get names from them: u_x,
// ra_x_t (ra x t), dot_u_t, u_len, inv_u_len.
//
// With the axes of a body, products with a vector f that is fixed in it are taken there, f · u = f_local · (A' u), and
// sums of such vectors are turned into the world as one: c_1 f_1 + c_2 f_2 = A (c_1 f_1_local + c_2 f_2_local). A
// person does so for a point on a surface of the body, since each axis of a frame costs a rotation otherwise.
class Components {
 public:
  Components() = default;
  explicit Components(const LocalAxes* axes) : axes_(axes) {}

  Expr of(Expr scalar);
  std::vector<Expr> of_vector(Expr vector);  // two in the plane, three in space

 private:
  Expr scalar_rule(Expr e);
  std::vector<Expr> vector_rule(Expr e);
  std::vector<Expr> unit_rule(Expr e);
  std::vector<Expr> direction(Expr unit, const std::vector<Expr>& u, const std::vector<Expr>& world_x);
  std::vector<Expr> sum_rule(Expr e);
  // Those of a vector fixed in the body of `axes_`, or a scalar times it; empty for others.
  std::vector<Expr> fixed_components(Expr v);
  bool is_turned(Expr v);  // it is such a vector, or a sum with one
  std::vector<Expr> local_components(Expr v);
  Expr local_product(Expr product);  // u · v, and u × v in the plane; empty if the world's axes serve as well

  std::map<const Node*, Expr> scalars_;
  std::map<const Node*, std::vector<Expr>> vectors_, locals_;
  const LocalAxes* axes_ = nullptr;
};

// A name for a simple e, made of the names in it: "u", "ra", "rb_u" for rb + u. Empty for other expressions.
std::string spoken_name(Expr e);

}  // namespace cdot::derive
