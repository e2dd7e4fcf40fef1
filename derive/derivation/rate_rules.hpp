// The rules of d/dt, once each, over an algebra: time_derivative.cpp computes by them, explain/rates.cpp writes them
// down. The explanation therefore follows the computation.
#pragma once

#include <stdexcept>
#include <utility>

#include "derive/derivation/derivation.hpp"
#include "derive/expression/functions.hpp"

namespace cdot::derive {

template <class Value>
struct Weighted {
  Rational coef;
  Value value;
};

// A term of a sum; x + arm together where an algebra knows them as one point.
struct Addend {
  Rational coef;
  Expr e, arm;
};

// An algebra has values with + - * /, dot, cross, perp, pow and is_zero; and
//   operand(e)                  the expression e as a value
//   nothing(e)                  the rate of an e that stands still
//   rate(e)                     d e/dt, by these rules or by a name that it was given before
//   addends(e)                  the terms of a sum
//   total(e, terms)             terms of the kind of e added up
//   monomial(k, x, n, x_dot)    k x_1^n_1 x_2^n_2 ... x_dot
//   times(f', x_dot)            the product of an expression and a rate
//   rule(words...)              takes note of the rule that is applied
template <class Algebra>
class RateRules {
  using Value = typename Algebra::Value;

 public:
  RateRules(Algebra& algebra, const Joint& joint, const Moving& motion = {})
      : algebra_(algebra), joint_(joint), motion_(motion) {}

  Value of(Expr e) {
    switch (e->kind) {
      case Kind::number: return algebra_.nothing(e);
      case Kind::symbol: return symbol_rule(e);
      case Kind::sum: return sum_rule(e);
      case Kind::product: return product_rule(e);
      case Kind::scale: return scale_rule(e);
      case Kind::dot:
      case Kind::cross: return pair_rule(e);
      case Kind::perp: algebra_.rule("a quarter turn of the rate"); return perp(rate(e->args[0]));
      case Kind::norm:
        algebra_.rule("derivative of a length: |u|_dot = unit(u) · u_dot");
        return dot(operand(unit(e->args[0])), rate(e->args[0]));
      case Kind::unit: return unit_rule(e);
      case Kind::twist: return twist_rule(e);
      case Kind::function: return e->fn == Fn::atan2 ? atan2_rule(e) : chain_rule(e);
      case Kind::tensor: break;  // arises only after differentiation
    }
    throw std::logic_error("no rule for the derivative of " + text(e));
  }

 private:
  Value operand(Expr e) { return algebra_.operand(e); }
  Value rate(Expr e) { return algebra_.rate(e); }

  static bool is_spin(Expr e) { return e->kind == Kind::symbol && e->role == Role::spin; }
  static bool is_fixed(Expr e) { return e->kind == Kind::symbol && e->role == Role::body_vector; }
  bool stretches() const { return motion_.stretched >= 0; }
  bool moves(Expr leaf) const {
    return leaf->body >= 0 && leaf->body != motion_.immovable && !stretches() &&
           (!motion_.only || motion_.only == leaf);
  }
  BodySymbols body_of(Expr leaf) const { return body_symbols(joint_, leaf->body); }
  Value spin_of(Expr leaf) {
    const Expr w = body_of(leaf).w;
    return moves(leaf) ? operand(w) : algebra_.nothing(w);
  }

  Value symbol_rule(Expr e) {
    if (e->role == Role::time && !motion_.only && !stretches()) return operand(e->pool->number(1));
    if (is_fixed(e)) {
      const std::string& body = joint_.bodies[static_cast<std::size_t>(e->body)];
      algebra_.rule("fixed in ", body, ", so it turns with it: s_dot = w_", body, " × s");
      return turned(e);
    }
    if (e->role == Role::position && moves(e)) {
      algebra_.rule("the centre of mass moves with v");
      return operand(body_of(e).v);
    }
    if (e->role == Role::angle && moves(e)) {
      algebra_.rule("the angle of a body grows at its rate w");
      return operand(body_of(e).w);
    }
    return algebra_.nothing(e);
  }

  // ds/dt = w x s for a vector fixed in a body. A(e) is of second degree in the Euler parameters e: ds/de e = 2 s.
  Value turned(Expr s) {
    if (stretches() && s->body == motion_.stretched) return algebra_.total(s, {{Rational(2), operand(s)}});
    return moves(s) ? cross(operand(body_of(s).w), operand(s)) : algebra_.nothing(s);
  }

  Value sum_rule(Expr e) {
    std::vector<Weighted<Value>> terms;
    for (const Addend& addend : algebra_.addends(e)) {
      if (addend.arm) {
        algebra_.rule("a point fixed on a body moves with v + w × r");
        terms.push_back({addend.coef, operand(body_of(addend.e).v)});
        terms.push_back({addend.coef, turned(addend.arm)});
      } else {
        terms.push_back({addend.coef, rate(addend.e)});
      }
    }
    return algebra_.total(e, terms);
  }

  // d(x^k y ...)/dt = k x^(k-1) xdot y ... + ...
  Value product_rule(Expr e) {
    Value total = algebra_.nothing(e);
    int moving = 0;
    for (std::size_t i = 0; i < e->args.size(); ++i) {
      const Value x_dot = rate(e->args[i]);
      if (is_zero(x_dot)) continue;
      ++moving;
      std::vector<int> exponents = e->exponents;
      const int k = exponents[i]--;
      if (k != 1) algebra_.rule("chain rule: (x^n)_dot = n x^(n-1) x_dot");
      total = total + algebra_.monomial(k, e->args, exponents, x_dot);
    }
    algebra_.rule(moving > 1 ? "product rule" : "constant factors stay");
    return total;
  }

  // d(s u)/dt = sdot u + s udot
  Value scale_rule(Expr e) {
    const Expr s = e->args[0], u = e->args[1];
    if (is_spin(s) && u->kind == Kind::perp) return turned_again(s, u->args[0]);
    algebra_.rule("product rule");
    const Value s_dot = rate(s), u_dot = rate(u);
    return s_dot * operand(u) + operand(s) * u_dot;
  }

  // (w x r)_dot = w x r_dot, w itself constant.
  Value turned_again(Expr w, Expr r) {
    algebra_.rule("s_dot = w × s again");
    return cross(operand(w), is_fixed(r) ? turned(r) : rate(r));
  }

  // d(u . v)/dt = udot . v + u . vdot, and the same for u x v; a direction comes first, as in n . u.
  Value pair_rule(Expr e) {
    Expr u = e->args[0], v = e->args[1];
    const bool scalar_product = e->kind == Kind::dot;
    if (!scalar_product && is_spin(v)) return -turned_again(v, u);
    const bool component = scalar_product && (is_component_axis(u) || is_component_axis(v));
    algebra_.rule(component ? "component by component" : "product rule");
    if (scalar_product && v->unit_length && !u->unit_length) std::swap(u, v);
    const Value u_dot = rate(u), v_dot = rate(v);
    if (scalar_product) return dot(u_dot, operand(v)) + dot(operand(u), v_dot);
    return cross(u_dot, operand(v)) + cross(operand(u), v_dot);
  }

  // Only the part of udot across n = u/|u| turns it.
  Value unit_rule(Expr e) {
    const bool in_space = joint_.dimension == 3;
    algebra_.rule("derivative of a direction n of u: n_dot = ",
                  in_space ? "(u_dot - (n · u_dot) n)/|u|" : "(n × u_dot)/|u| perp(n)");
    const Value n = operand(e), length = operand(norm(e->args[0])), u_dot = rate(e->args[0]);
    if (in_space) return (u_dot - dot(n, u_dot) * n) / length;
    return cross(n, u_dot) / length * perp(n);
  }

  // The rate about the axis halfway between the two x axes.
  Value twist_rule(Expr e) {
    const char* rules[] = {"rate of a twist of g against f: (f.x + g.x) · (w_g - w_f)/(1 + f.x · g.x)",
                           "rate of a twist of g against f about y: (f.y + g.y) · (w_g - w_f)/(1 + f.y · g.y)",
                           "rate of a twist of g against f about z: (f.z + g.z) · (w_g - w_f)/(1 + f.z · g.z)"};
    algebra_.rule(rules[e->pool->axis_of(e->args[0]).index]);
    const auto spin = [this](Expr axis) { return moves(axis) ? body_of(axis).w : zero_vector(*axis->pool); };
    const Expr f = e->args[0], g = e->args[3];
    return operand(dot(f + g, spin(g) - spin(f)) / (e->pool->number(1) + dot(f, g)));
  }

  // d f(x)/dt = f'(x) xdot
  Value chain_rule(Expr e) {
    const Function& f = function_of(e->fn);
    if (f.derivative == nullptr) throw std::logic_error("no derivative of " + std::string(f.name));
    const Value x_dot = rate(e->args[0]);
    algebra_.rule("chain rule: ", f.rule);
    return algebra_.times(f.derivative(e), x_dot);
  }

  Value atan2_rule(Expr e) {
    if (const std::optional<AngleBetween> angle = angle_between(e)) return angle_rule(*angle);
    if (const Expr twist = twist_of(e)) return rate(twist);
    const bool on_unit_circle = !stretches() && is_on_unit_circle(e);
    if (on_unit_circle && is_root(e->args[1])) {
      algebra_.rule("chain rule: atan2(y, x)_dot = y_dot/x, since x^2 + y^2 = 1");
      return rate(e->args[0]) / operand(e->args[1]);
    }
    if (on_unit_circle && is_root(e->args[0])) {
      algebra_.rule("chain rule: atan2(y, x)_dot = -x_dot/y, since x^2 + y^2 = 1");
      return -(rate(e->args[1]) / operand(e->args[0]));
    }
    algebra_.rule("chain rule: atan2(y, x)_dot = ",
                  on_unit_circle ? "x y_dot - y x_dot, since x^2 + y^2 = 1" : "(x y_dot - y x_dot)/(x^2 + y^2)");
    const Value y = operand(e->args[0]), x = operand(e->args[1]);
    const Value y_dot = rate(e->args[0]), x_dot = rate(e->args[1]);
    const Value turned = x * y_dot - y * x_dot;
    return on_unit_circle ? turned : turned / operand(pow(e->args[1], 2) + pow(e->args[0], 2));
  }

  // The angle from u to v grows as v turns and falls as u turns; in space by what turns v against u about their common
  // normal.
  Value angle_rule(const AngleBetween& angle) {
    const bool in_space = joint_.dimension == 3;
    algebra_.rule("derivative of an angle between directions: ",
                  in_space ? "what turns the second against the first, about their common normal"
                           : "how fast the second turns, less how fast the first does");
    const Value to = turning(angle.to), from = turning(angle.from);
    if (!in_space) return to - from;
    return dot(operand(unit(cross(angle.from, angle.to))), to - from);
  }

  // A vector turns at (u x udot)/(u . u); one that is fixed in a body turns with it.
  Value turning(Expr u) {
    if (is_fixed(u)) return spin_of(u);
    const Value speed = cross(operand(u), rate(u));
    return u->unit_length ? speed : speed / dot(operand(u), operand(u));
  }

  Algebra& algebra_;
  const Joint& joint_;
  const Moving& motion_;
};

}  // namespace cdot::derive
