// From Cdot to J: the coefficients of the velocities, simplified node by node.
#include <map>

#include "derive/derivation/transposition_rules.hpp"

namespace cdot::derive {
namespace {

// The builders of expressions as the algebra of the rules, for a scalar Cdot: c stands for the map e -> c . e.
class Transposition {
 public:
  using Map = Expr;

  explicit Transposition(Expr root) {
    const std::vector<Expr> order = topological(std::span(&root, 1));
    for (const Expr e : order) {
      bool moving = e->kind == Kind::symbol && (e->role == Role::velocity || e->role == Role::spin);
      for (const Expr arg : e->args) moving = moving || moves(arg);
      moving_.emplace(&*e, moving);
    }
    factor_.emplace(&*root, root->pool->number(1));
    // A node passes on what all that contain it have passed to it.
    for (auto e = order.rbegin(); e != order.rend(); ++e) {
      const auto found = factor_.find(&**e);
      if (found != factor_.end() && moves(*e)) TranspositionRules(*this).of(*e, found->second);
    }
  }

  Expr coefficient(Expr velocity) const {
    const auto found = factor_.find(&*velocity);
    if (found != factor_.end()) return found->second;
    return velocity->vector ? zero_vector(*velocity->pool) : velocity->pool->number(0);
  }

  bool moves(Expr e) const { return moving_.at(&*e); }
  void pass(Expr e, Expr c) {
    const auto [at, fresh] = factor_.emplace(&*e, c);
    if (!fresh) at->second = at->second + c;
  }
  Expr scaled(Expr c, Rational k) const { return k * c; }
  Expr after_factor(Expr c, Expr s) const { return c * s; }
  Expr after_column(Expr c, Expr u) const { return dot(c, u); }
  Expr after_row(Expr c, Expr u) const { return c * u; }
  Expr after_cross(Expr c, Expr u) const { return cross(c, u); }   // c . (u x v) = (c x u) . v
  Expr before_cross(Expr c, Expr v) const { return cross(v, c); }  // c . (u x v) = (v x c) . u
  Expr after_perp(Expr c) const { return -perp(c); }               // c . perp(u) = -perp(c) . u
  Expr after_tensor(Expr c, Expr T) const { return apply(T, c); }  // c . (T u) = (T c) . u, T being symmetric

 private:
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

// c1 r1 x t + c2 r2 x t = (c1 r1 + c2 r2) x t, vectors with factors that differ.
bool merge_weighted(const PairTerm& a, const PairTerm& b, Term& merged) {
  const Expr p = a.coef * a.rest, q = b.coef * b.rest;
  if (a.v == b.v) merged = {1, cross(p * a.u + q * b.u, a.v)};
  else if (a.u == b.u) merged = {1, cross(a.u, p * a.v + q * b.v)};
  else if (a.v == b.u) merged = {1, cross(p * a.u - q * b.v, a.v)};
  else if (a.u == b.v) merged = {1, cross(a.u, p * a.v - q * b.u)};
  else return false;
  return true;
}

// r1 x t + r2 x t = (r1 + r2) x t: two products fewer, and the form that people write. Likewise for dot.
bool merge_pair(std::vector<Term>& terms) {
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const PairTerm a = pair_term(terms[i]);
    if (a.kind == Kind::number) continue;
    for (std::size_t j = i + 1; j < terms.size(); ++j) {
      const PairTerm b = pair_term(terms[j]);
      if (b.kind != a.kind) continue;
      if (b.rest != a.rest || abs(b.coef) != abs(a.coef)) {
        if (!terms[i].e->vector || !merge_weighted(a, b, terms[i])) continue;
        terms.erase(terms.begin() + static_cast<std::ptrdiff_t>(j));
        return true;
      }
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

std::vector<JacobianEntry> factors_of_velocities(Expr Cdot, const Joint& joint) {
  const Transposition transposed(Cdot);
  std::vector<JacobianEntry> J;
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    const BodySymbols body = body_symbols(joint, static_cast<int>(b));
    J.push_back({transposed.coefficient(body.v), transposed.coefficient(body.w)});
  }
  return J;
}

std::vector<JacobianEntry> isolate_velocities(Expr Cdot, const Joint& joint) {
  std::vector<JacobianEntry> J = factors_of_velocities(Cdot, joint);
  for (JacobianEntry& entry : J) entry.w = collected(entry.w);
  return J;
}

}  // namespace cdot::derive
