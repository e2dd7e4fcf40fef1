// d/dt of an expression, by the rules of the textbook, node by node.
#include <cassert>
#include <map>

#include "derive/derivation/derivation.hpp"

namespace cdot::derive {
namespace {

class TimeDerivative {
 public:
  TimeDerivative(const Joint& joint, Moving motion) : joint_(joint), motion_(motion) {}

  Expr of(Expr e) {
    if (const auto found = done_.find(&*e); found != done_.end()) return found->second;
    const Expr result = e->vector ? vector_rule(e) : scalar_rule(e);
    // Only where everything moves is it the whole u_dot: a part of it must not take the name.
    if (!e->name.empty() && !motion_.only && !stretches() && motion_.immovable < 0) {
      e->pool->name(result, e->name + "_dot", false);
    }
    done_.emplace(&*e, result);
    return result;
  }

 private:
  bool stretches() const { return motion_.stretched >= 0; }
  bool moves(Expr leaf) const {
    return leaf->body >= 0 && leaf->body != motion_.immovable && !stretches() &&
           (!motion_.only || motion_.only == leaf);
  }

  Expr vector_rule(Expr e) {
    Pool& pool = *e->pool;
    switch (e->kind) {
      case Kind::symbol:
        // A(e) is of second degree in the Euler parameters e: ds/de e = 2 s.
        if (stretches() && e->role == Role::body_vector && e->body == motion_.stretched) {
          return Rational(2) * e;
        }
        if (!moves(e)) return zero_vector(pool);
        if (e->role == Role::position) return body_symbols(joint_, e->body).v;
        // ds/dt = w x s for a vector fixed in a body.
        if (e->role == Role::body_vector) return cross(body_symbols(joint_, e->body).w, e);
        return zero_vector(pool);
      case Kind::sum: return sum_rule(e);
      // d(s u)/dt = sdot u + s udot
      case Kind::scale: return of(e->args[0]) * e->args[1] + e->args[0] * of(e->args[1]);
      case Kind::perp: return perp(of(e->args[0]));
      case Kind::cross: return cross(of(e->args[0]), e->args[1]) + cross(e->args[0], of(e->args[1]));
      case Kind::unit: return unit_rule(e);
      default: break;
    }
    assert(false && "not a vector");
    return e;
  }

  Expr scalar_rule(Expr e) {
    Pool& pool = *e->pool;
    switch (e->kind) {
      case Kind::number: return pool.number(0);
      case Kind::symbol:
        if (e->role == Role::angle && moves(e)) return body_symbols(joint_, e->body).w;
        return pool.number(e->role == Role::time && !motion_.only && !stretches() ? 1 : 0);
      case Kind::sum: return sum_rule(e);
      case Kind::product: return product_rule(e);
      // d(u . v)/dt = udot . v + u . vdot, and the same for u x v
      case Kind::dot: return dot(of(e->args[0]), e->args[1]) + dot(e->args[0], of(e->args[1]));
      case Kind::cross: return cross(of(e->args[0]), e->args[1]) + cross(e->args[0], of(e->args[1]));
      // d|u|/dt = n . udot
      case Kind::norm: return dot(unit(e->args[0]), of(e->args[0]));
      case Kind::twist: return twist_rule(e);
      case Kind::function: return chain_rule(e);
      default: break;
    }
    assert(false && "not a scalar");
    return e;
  }

  Expr sum_rule(Expr e) {
    std::vector<Term> terms;
    for (std::size_t i = 0; i < e->args.size(); ++i) terms.push_back({e->coefs[i], of(e->args[i])});
    return sum(*e->pool, terms, e->vector);
  }

  // d(x^k y ...)/dt = k x^(k-1) xdot y ... + ...
  Expr product_rule(Expr e) {
    Expr total = e->pool->number(0);
    for (std::size_t i = 0; i < e->args.size(); ++i) {
      const Expr rate = of(e->args[i]);
      if (is_zero(rate)) continue;
      total = total + Rational(e->exponents[i]) * (without_factor(e, i) * rate);
    }
    return total;
  }

  // Only the part of udot across n = u/|u| turns it: (n x udot)/|u| perp(n) in the plane, in space
  // (udot - (n . udot) n)/|u|.
  Expr unit_rule(Expr e) {
    const Expr rate = of(e->args[0]), length = norm(e->args[0]);
    if (e->pool->dimension() == 2) return cross(e, rate) / length * perp(e);
    return (rate - dot(e, rate) * e) / length;
  }

  // The twist of g against f grows at (f_x + g_x) . (w_g - w_f) / (1 + f_x . g_x): the rate about the axis halfway
  // between the two x axes.
  Expr twist_rule(Expr e) {
    const Expr f = e->args[0], g = e->args[3];
    const Expr relative = spin_of(g) - spin_of(f);
    return dot(f + g, relative) / (e->pool->number(1) + dot(f, g));
  }

  // The angular velocity of what a triad is fixed in.
  Expr spin_of(Expr axis) { return moves(axis) ? body_symbols(joint_, axis->body).w : zero_vector(*axis->pool); }

  Expr chain_rule(Expr e) {
    const Expr a = e->args[0], rate = of(a);
    switch (e->fn) {
      case Fn::sqrt: return Rational(1, 2) * (rate / e);
      case Fn::sin: return call(Fn::cos, a) * rate;
      case Fn::cos: return -(call(Fn::sin, a) * rate);
      case Fn::tan: return (e->pool->number(1) + pow(e, 2)) * rate;
      case Fn::exp: return e * rate;
      case Fn::log: return rate / a;
      case Fn::abs: return call(Fn::sign, a) * rate;
      case Fn::sign: return e->pool->number(0);
      case Fn::atan2: return atan2_rule(e);
      case Fn::inverse:
      case Fn::select:
      case Fn::pivot: break;  // arise only after differentiation
    }
    assert(false && "no derivative");
    return e;
  }

  Expr atan2_rule(Expr e) {
    const Expr y = e->args[0], x = e->args[1];
    const Term cross_part = split_coefficient(y), dot_part = split_coefficient(x);
    const bool angle_between = cross_part.e->kind == Kind::cross && dot_part.e->kind == Kind::dot &&
                               cross_part.e->args == dot_part.e->args && abs(cross_part.coef) == Rational(1) &&
                               dot_part.coef == Rational(1);
    if (angle_between) {
      // The angle from u to v grows as v turns and falls as u turns; a vector turns at (u x udot)/(u . u).
      const Expr u = cross_part.e->args[0], v = cross_part.e->args[1];
      return cross_part.coef * (turning(v) - turning(u));
    }
    if (y->kind == Kind::norm && y->args[0]->kind == Kind::cross && dot_part.e->kind == Kind::dot &&
        y->args[0]->args == dot_part.e->args && dot_part.coef == Rational(1)) {
      // In space it grows by what turns v against u about their common normal.
      const Expr u = y->args[0]->args[0], v = y->args[0]->args[1];
      return dot(unit(y->args[0]), turning_in_space(v) - turning_in_space(u));
    }
    // d atan2(y, x)/dt = (x ydot - y xdot)/(x^2 + y^2)
    return (x * of(y) - y * of(x)) / (pow(x, 2) + pow(y, 2));
  }

  // An angular velocity with which u turns; what is fixed in a body turns with it.
  Expr turning_in_space(Expr u) {
    const bool fixed = u->kind == Kind::symbol && u->role == Role::body_vector;
    return fixed ? spin_of(u) : cross(u, of(u)) / dot(u, u);
  }

  Expr turning(Expr u) { return cross(u, of(u)) / dot(u, u); }

  const Joint& joint_;
  Moving motion_;
  std::map<const Node*, Expr> done_;
};

}  // namespace

Expr time_derivative(Expr e, const Joint& joint, const Moving& motion) { return TimeDerivative(joint, motion).of(e); }

}  // namespace cdot::derive
