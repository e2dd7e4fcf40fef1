// The rules that lead from Cdot to J, once each, over an algebra: transposition.cpp computes by them,
// explain/velocities.cpp writes them down. The explanation therefore follows the computation.
//
// Transposition reads J off Cdot. A term n . (w x r) shows how w enters; its transpose (r x n) . w shows the factor of
// w. Each rule below is such an identity; "isolating the velocities" is a walk from Cdot to the leaves.
#pragma once

#include "derive/derivation/derivation.hpp"

namespace cdot::derive {

// A part e of Cdot contributes L e to it: L is a row c' in a scalar equation, a matrix in a vector equation.
// An algebra has such maps L, the question moves(e), and
//   pass(e, L)              takes note that e contributes L e
//   scaled(L, k)            x -> L (k x), k a number
//   after_factor(L, s)      u -> L (s u)
//   after_column(L, u)      s -> L (s u)
//   after_row(L, u)         v -> L (u . v)
//   after_cross(L, u)       v -> L (u x v), in space
//   before_cross(L, v)      u -> L (u x v), in space
//   after_perp(L)           u -> L perp(u)
//   after_tensor(L, T)      u -> L (T u)
template <class Algebra>
class TranspositionRules {
  using Map = typename Algebra::Map;

 public:
  explicit TranspositionRules(Algebra& algebra) : algebra_(algebra) {}

  void of(Expr e, const Map& L) {
    switch (e->kind) {
      case Kind::symbol: return;
      case Kind::sum:
        for (std::size_t i = 0; i < e->args.size(); ++i) {
          if (moves(e->args[i])) algebra_.pass(e->args[i], algebra_.scaled(L, e->coefs[i]));
        }
        return;
      case Kind::product: return product_rule(e, L);
      case Kind::tensor: return algebra_.pass(e->args[1], algebra_.after_tensor(L, e->args[0]));
      case Kind::perp: return algebra_.pass(e->args[0], algebra_.after_perp(L));
      case Kind::scale:
      case Kind::dot:
      case Kind::cross: return pair_rule(e, L);
      default: require(false);
    }
  }

 private:
  bool moves(Expr e) const { return algebra_.moves(e); }

  static void require(bool linear) {
    if (!linear) throw NotLinear("the row is not linear in the velocities");
  }

  // In the plane u x v = perp(u) . v = -perp(v) . u.
  void pair_rule(Expr e, const Map& L) {
    const Expr u = e->args[0], v = e->args[1];
    const bool first = moves(u);
    require(!(first && moves(v)));
    if (e->kind == Kind::scale) {
      if (first) algebra_.pass(u, algebra_.after_column(L, v));
      else algebra_.pass(v, algebra_.after_factor(L, u));
    } else if (e->kind == Kind::dot) {
      algebra_.pass(first ? u : v, algebra_.after_row(L, first ? v : u));
    } else if (e->vector) {
      if (first) algebra_.pass(u, algebra_.before_cross(L, v));
      else algebra_.pass(v, algebra_.after_cross(L, u));
    } else {
      if (first) algebra_.pass(u, algebra_.scaled(algebra_.after_row(L, perp(v)), -1));
      else algebra_.pass(v, algebra_.after_row(L, perp(u)));
    }
  }

  void product_rule(Expr e, const Map& L) {
    int found = 0;
    for (std::size_t i = 0; i < e->args.size(); ++i) {
      if (!moves(e->args[i])) continue;
      require(++found == 1 && e->exponents[i] == 1);
      algebra_.pass(e->args[i], algebra_.after_factor(L, without_factor(e, i)));
    }
  }

  Algebra& algebra_;
};

}  // namespace cdot::derive
