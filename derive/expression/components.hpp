// Vectors to components: scalar expressions, as a kernel computes them, in an order that depends on names only.
#pragma once

#include <map>
#include <vector>

#include "derive/expression/expr.hpp"

namespace cdot::derive {

// Writes expressions out in components along the world's axes. A vector leaf `t` becomes the scalars `t_x`, `t_y` (and
// `t_z` in space) with the same role and body, a tensor leaf its six; dot, cross, perp, norm and unit vanish; a
// negative power becomes the guarded `inverse`. Components and products of named things get names from them: u_x,
// ra_x_t (ra x t), dot_u_t, u_len, inv_u_len.
class Components {
 public:
  Expr of(Expr scalar);
  std::vector<Expr> of_vector(Expr vector);  // two in the plane, three in space

 private:
  Expr scalar_rule(Expr e);
  std::vector<Expr> vector_rule(Expr e);
  std::vector<Expr> unit_rule(Expr e);

  std::map<const Node*, Expr> scalars_;
  std::map<const Node*, std::vector<Expr>> vectors_;
};

// A name for a simple e, made of the names in it: "u", "ra", "rb_u" for rb + u. Empty for other expressions.
std::string spoken_name(Expr e);

}  // namespace cdot::derive
