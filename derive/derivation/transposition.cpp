// From Cdot to J: the coefficients of the velocities.
//
// J is read off Cdot by transposition. A term n . (w x r) says how w enters; its transpose (r x n) w says what w is
// multiplied by. Each rule below is such an identity, so "isolating the velocities" is a walk from Cdot to the leaves.
#include <map>

#include "derive/derivation/derivation.hpp"

namespace cdot::derive {
namespace {

// Walks from an expression that is linear in the velocities to v and w, carrying what each node is multiplied by.
class Transposition {
 public:
  explicit Transposition(Expr root) : order_(topological(std::span(&root, 1))) {
    for (const Expr e : order_) {
      bool moving = e->kind == Kind::symbol && (e->role == Role::velocity || e->role == Role::spin);
      for (const Expr arg : e->args) moving = moving || moving_.at(&*arg);
      moving_.emplace(&*e, moving);
    }
    factor_.emplace(&*root, root->pool->number(1));
    for (auto e = order_.rbegin(); e != order_.rend(); ++e) {
      const auto found = factor_.find(&**e);
      if (found != factor_.end() && moving_.at(&**e)) pass_on(*e, found->second);
    }
  }

  Expr coefficient(Expr velocity) const {
    const auto found = factor_.find(&*velocity);
    if (found != factor_.end()) return found->second;
    return velocity->vector ? zero_vector(*velocity->pool) : velocity->pool->number(0);
  }

 private:
  bool moving(Expr e) const { return moving_.at(&*e); }

  void add(Expr e, Expr factor) {
    if (!moving(e)) return;
    const auto [at, fresh] = factor_.emplace(&*e, factor);
    if (!fresh) at->second = at->second + factor;
  }

  void pass_on(Expr e, Expr c) {
    switch (e->kind) {
      case Kind::symbol: return;
      case Kind::sum:
        for (std::size_t i = 0; i < e->args.size(); ++i) add(e->args[i], e->coefs[i] * c);
        return;
      case Kind::product: return pass_on_product(e, c);
      case Kind::scale:  // c . (s u) = (c . u) s
        require(!(moving(e->args[0]) && moving(e->args[1])));
        add(e->args[0], dot(c, e->args[1]));
        add(e->args[1], e->args[0] * c);
        return;
      case Kind::dot:
        require(!(moving(e->args[0]) && moving(e->args[1])));
        add(e->args[0], c * e->args[1]);
        add(e->args[1], c * e->args[0]);
        return;
      case Kind::cross: require(!(moving(e->args[0]) && moving(e->args[1]))); return pass_on_cross(e, c);
      case Kind::tensor:  // c . (T u) = (T c) . u
        return add(e->args[1], apply(e->args[0], c));
      case Kind::perp:  // c . perp(u) = -perp(c) . u
        return add(e->args[0], -perp(c));
      default: require(false);
    }
  }

  void pass_on_cross(Expr e, Expr c) {
    const Expr u = e->args[0], v = e->args[1];
    if (e->vector) {  // c . (u x v) = u . (v x c) = v . (c x u)
      if (moving(u)) add(u, cross(v, c));
      if (moving(v)) add(v, cross(c, u));
    } else {  // u x v = u . (-perp v) = perp(u) . v
      if (moving(u)) add(u, -(c * perp(v)));
      if (moving(v)) add(v, c * perp(u));
    }
  }

  void pass_on_product(Expr e, Expr c) {
    int found = 0;
    for (std::size_t i = 0; i < e->args.size(); ++i) {
      if (!moving(e->args[i])) continue;
      require(++found == 1 && e->exponents[i] == 1);
      add(e->args[i], c * without_factor(e, i));
    }
  }

  static void require(bool linear) {
    if (!linear) throw NotLinear("the row is not linear in the velocities");
  }

  std::vector<Expr> order_;
  std::map<const Node*, bool> moving_;
  std::map<const Node*, Expr> factor_;
};

// A term coef * rest * op(u, v), op being dot or cross.
struct PairTerm {
  Rational coef;
  Expr rest;  // scalar
  Kind kind = Kind::number;
  Expr u, v;
};

PairTerm pair_term(const Term& term) {
  PairTerm out{term.coef, term.e, Kind::number, {}, {}};
  if (term.e->vector) {  // in space, where u x v is a vector
    const bool scaled = term.e->kind == Kind::scale && term.e->name.empty();
    const Expr f = scaled ? term.e->args[1] : term.e;
    if (f->kind != Kind::cross || f->named_by_let) return out;
    const Expr rest = scaled ? term.e->args[0] : f->pool->number(1);
    return {term.coef, rest, f->kind, f->args[0], f->args[1]};
  }
  std::vector<Expr> factors{term.e};
  if (term.e->kind == Kind::product && term.e->name.empty()) factors = term.e->args;
  for (std::size_t i = 0; i < factors.size(); ++i) {
    const Expr f = factors[i];
    if (f->kind != Kind::dot && f->kind != Kind::cross) continue;
    if (factors.size() > 1 && term.e->exponents[i] != 1) continue;
    return {term.coef, term.e / f, f->kind, f->args[0], f->args[1]};
  }
  return out;
}

// r1 x t + r2 x t = (r1 + r2) x t: two products fewer, and the form that people write. Likewise for dot.
bool merge_pair(std::vector<Term>& terms) {
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const PairTerm a = pair_term(terms[i]);
    if (a.kind == Kind::number) continue;
    for (std::size_t j = i + 1; j < terms.size(); ++j) {
      const PairTerm b = pair_term(terms[j]);
      if (b.kind != a.kind || b.rest != a.rest || abs(b.coef) != abs(a.coef)) continue;
      const Rational swap = a.kind == Kind::cross ? Rational(-1) : Rational(1);
      const Rational sign = b.coef / a.coef;
      Expr left, right;
      if (a.v == b.v) left = a.u + sign * b.u, right = a.v;
      else if (a.u == b.u) left = a.u, right = a.v + sign * b.v;
      else if (a.v == b.u) left = a.u + (sign * swap) * b.v, right = a.v;
      else if (a.u == b.v) left = a.u, right = a.v + (sign * swap) * b.u;
      else continue;
      const Expr merged = a.rest * (a.kind == Kind::cross ? cross(left, right) : dot(left, right));
      terms[i] = {a.coef, merged};
      terms.erase(terms.begin() + static_cast<std::ptrdiff_t>(j));
      return true;
    }
  }
  return false;
}

}  // namespace

Expr collected(Expr e) {
  if (e->kind != Kind::sum || !e->name.empty()) return e;
  std::vector<Term> terms = terms_of(e);
  while (merge_pair(terms)) {
  }
  return sum(*e->pool, terms, e->vector);
}

std::vector<JacobianEntry> isolate_velocities(Expr Cdot, const Joint& joint) {
  const Transposition transposed(Cdot);
  std::vector<JacobianEntry> J;
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    const BodySymbols body = body_symbols(joint, static_cast<int>(b));
    J.push_back({transposed.coefficient(body.v), collected(transposed.coefficient(body.w))});
  }
  return J;
}

}  // namespace cdot::derive
