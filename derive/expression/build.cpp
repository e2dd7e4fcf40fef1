// The builders: each brings its operands into the one form that the interning relies on.
#include <algorithm>
#include <cassert>

#include "derive/expression/functions.hpp"

namespace cdot::derive {
namespace {

Expr node(Kind kind, bool vector, std::vector<Expr> args, bool unit_length = false) {
  Node n;
  n.kind = kind;
  n.vector = vector;
  n.unit_length = unit_length;
  Pool& pool = *args.front()->pool;
  n.args = std::move(args);
  return pool.intern(std::move(n));
}

// v as scalar * rest for what a bilinear operator pulls out: numeric coefficients and `scale` factors.
struct Scaled {
  Expr factor;  // scalar
  Expr rest;    // vector
};

Scaled split_scale(Expr v) {
  Pool& pool = *v->pool;
  const Term term = split_coefficient(v);
  const Expr coef = pool.number(term.coef);
  if (term.e->kind != Kind::scale) return {coef, term.e};
  return {coef * term.e->args[0], term.e->args[1]};
}

bool is_perp(Expr v) { return v->kind == Kind::perp; }
bool is_unit_of(Expr n, Expr u) { return n->kind == Kind::unit && n->args[0] == u; }

// Levers come before directions in a cross product: cross(ra, t), cross(u, n).
bool direction_after(Expr u, Expr v) {
  if (u->unit_length != v->unit_length) return !u->unit_length;
  return compare(u, v) < 0;
}

void append_terms(Rational coef, Expr e, std::vector<Term>& out) {
  if (e->kind == Kind::sum && e->name.empty()) {
    for (std::size_t i = 0; i < e->args.size(); ++i) out.push_back({coef * e->coefs[i], e->args[i]});
  } else if (e->kind == Kind::number) {
    out.push_back({coef * e->value, e->pool->number(1)});
  } else {
    out.push_back({coef, e});
  }
}

}  // namespace

Term split_coefficient(Expr e) {
  if (e->kind == Kind::number) return {e->value, e->pool->number(1)};
  if (e->kind == Kind::sum && e->args.size() == 1) return {e->coefs[0], e->args[0]};
  return {Rational(1), e};
}

std::vector<Term> terms_of(Expr e) {
  if (e->kind != Kind::sum) return {split_coefficient(e)};
  std::vector<Term> terms;
  for (std::size_t i = 0; i < e->args.size(); ++i) terms.push_back({e->coefs[i], e->args[i]});
  return terms;
}

Expr sum(Pool& pool, std::span<const Term> terms, bool vector) {
  std::vector<Term> flat;
  for (const Term& t : terms) append_terms(t.coef, t.e, flat);
  std::sort(flat.begin(), flat.end(), [](const Term& a, const Term& b) { return compare(a.e, b.e) < 0; });
  Node n;
  n.kind = Kind::sum;
  n.vector = vector;
  for (std::size_t i = 0; i < flat.size();) {
    Rational coef(0);
    const Expr e = flat[i].e;
    for (; i < flat.size() && flat[i].e == e; ++i) coef = coef + flat[i].coef;
    if (coef.is_zero()) continue;
    n.args.push_back(e);
    n.coefs.push_back(coef);
  }
  if (!vector && n.args.empty()) return pool.number(0);
  if (!vector && n.args.size() == 1 && is_one(n.args[0])) return pool.number(n.coefs[0]);
  if (n.args.size() == 1 && n.coefs[0] == Rational(1)) return n.args[0];
  if (n.args.size() == 1 && abs(n.coefs[0]) == Rational(1)) n.unit_length = n.args[0]->unit_length;
  return pool.intern(std::move(n));
}

Expr zero_vector(Pool& pool) { return sum(pool, {}, true); }

Expr operator+(Expr a, Expr b) {
  assert(a->vector == b->vector);
  return sum(*a->pool, std::vector<Term>{{1, a}, {1, b}}, a->vector);
}

Expr operator-(Expr a, Expr b) {
  assert(a->vector == b->vector);
  return sum(*a->pool, std::vector<Term>{{1, a}, {-1, b}}, a->vector);
}

Expr operator*(Rational c, Expr e) { return sum(*e->pool, std::vector<Term>{{c, e}}, e->vector); }

Expr operator-(Expr a) { return Rational(-1) * a; }

Expr product(Pool& pool, std::span<const Expr> factors, std::span<const int> exponents) {
  Rational coef(1);
  std::vector<std::pair<Expr, int>> flat;
  for (std::size_t i = 0; i < factors.size(); ++i) {
    const Term term = split_coefficient(factors[i]);
    if (term.coef.is_zero()) return pool.number(0);  // the guarded inverse of zero is zero, too
    coef = coef * pow(term.coef, exponents[i]);
    if (term.e->kind == Kind::product && term.e->name.empty()) {
      for (std::size_t k = 0; k < term.e->args.size(); ++k) {
        flat.emplace_back(term.e->args[k], term.e->exponents[k] * exponents[i]);
      }
    } else if (!is_one(term.e)) {
      flat.emplace_back(term.e, exponents[i]);
    }
  }
  std::stable_sort(flat.begin(), flat.end(),
                   [](const auto& a, const auto& b) { return compare(a.first, b.first) < 0; });
  Node n;
  n.kind = Kind::product;
  for (std::size_t i = 0; i < flat.size();) {
    int exponent = 0;
    const Expr e = flat[i].first;
    for (; i < flat.size() && flat[i].first == e; ++i) exponent += flat[i].second;
    if (exponent == 0) continue;
    n.args.push_back(e);
    n.exponents.push_back(exponent);
  }
  if (n.args.empty()) return pool.number(coef);
  const bool plain = n.args.size() == 1 && n.exponents[0] == 1;
  return coef * (plain ? n.args[0] : pool.intern(std::move(n)));
}

Expr without_factor(Expr e, std::size_t i) {
  std::vector<int> exponents = e->exponents;
  --exponents[i];
  return product(*e->pool, e->args, exponents);
}

Expr operator*(Expr a, Expr b) {
  Pool& pool = *a->pool;
  if (a->vector) std::swap(a, b);
  assert(!a->vector);
  if (!b->vector) {
    return product(pool, std::vector<Expr>{a, b}, std::vector<int>{1, 1});
  }
  const Scaled inner = split_scale(b);
  const Term factor = split_coefficient(a * inner.factor);
  if (factor.coef.is_zero() || is_zero(inner.rest)) return zero_vector(pool);
  if (is_one(factor.e)) return factor.coef * inner.rest;
  // u / |u| is the unit vector of u.
  if (factor.e->kind == Kind::product && factor.e == pow(norm(inner.rest), -1)) {
    return factor.coef * unit(inner.rest);
  }
  return factor.coef * node(Kind::scale, true, {factor.e, inner.rest});
}

Expr pow(Expr base, int exponent) {
  return product(*base->pool, std::span<const Expr>(&base, 1), std::span<const int>(&exponent, 1));
}

Expr operator/(Expr a, Expr b) { return a * pow(b, -1); }

namespace {

// n · (t × v) = (n × t) · v, n and t being axes of one triad: n × t is its third one. Empty for other operands.
Expr known_triple_product(Expr n, Expr product) {
  if (product->named_by_let) return {};
  const Pool::Axis axis = n->pool->axis_of(n);
  for (const std::size_t i : {0U, 1U}) {
    const Expr t = product->args[i], v = product->args[1 - i];
    const Pool::Axis other = n->pool->axis_of(t);
    if (!axis.triad || axis.triad != other.triad || axis.index == other.index) continue;
    const Expr third = (*axis.triad)[static_cast<std::size_t>(3 - axis.index - other.index)];
    const bool turns_on = ((axis.index + 1) % 3 == other.index) == (i == 0);
    return turns_on ? dot(third, v) : -dot(third, v);
  }
  return {};
}

// Products within one triad, and of a cross product with one of its factors, are constants. Empty for other operands.
Expr known_dot(Expr u, Expr v) {
  Pool& pool = *u->pool;
  const Pool::Axis a = pool.axis_of(u), b = pool.axis_of(v);
  if (a.triad && a.triad == b.triad && a.index != b.index) return pool.number(0);
  for (const auto& [product, factor] : {std::pair{u, v}, std::pair{v, u}}) {
    if (product->kind != Kind::cross) continue;
    if (const Expr triple = known_triple_product(factor, product)) return triple;
    if (product->args[0] == factor || product->args[1] == factor) return pool.number(0);
    if (is_unit_of(factor, product->args[0]) || is_unit_of(factor, product->args[1])) {
      return pool.number(0);
    }
  }
  return {};
}

Expr cross_in_space(Expr u, Expr v) {
  Pool& pool = *u->pool;
  const Pool::Axis a = pool.axis_of(u), b = pool.axis_of(v);
  if (a.triad && a.triad == b.triad) {
    const Expr third = (*a.triad)[static_cast<std::size_t>(3 - a.index - b.index)];
    return (a.index + 1) % 3 == b.index ? third : -third;
  }
  if (direction_after(u, v)) return node(Kind::cross, true, {u, v});
  return -node(Kind::cross, true, {v, u});
}

// True if u, or the vector whose direction u is, is x - (n · x) n: the part of x at right angles to n.
bool is_part_across(Expr n, Expr u) {
  if (u->kind == Kind::unit) u = u->args[0];
  if (!n->unit_length || u->kind != Kind::sum) return false;
  std::vector<Term> across;
  Expr along = n->pool->number(0);
  for (std::size_t i = 0; i < u->args.size(); ++i) {
    const Expr arg = u->args[i];
    if (arg->kind == Kind::scale && arg->args[1] == n) along = along + u->coefs[i] * arg->args[0];
    else across.push_back({u->coefs[i], arg});
  }
  return !is_zero(along) && is_zero(dot(n, sum(*n->pool, across, true)) + along);
}

}  // namespace

Expr dot(Expr u, Expr v) {
  const Scaled a = split_scale(u), b = split_scale(v);
  const Expr factor = a.factor * b.factor;
  Pool& pool = *u->pool;
  if (is_zero(factor) || is_zero(a.rest) || is_zero(b.rest)) return pool.number(0);
  if (is_perp(a.rest) && is_perp(b.rest)) return factor * dot(a.rest->args[0], b.rest->args[0]);
  if (is_perp(a.rest) && !is_component_axis(a.rest)) {
    return factor * cross(a.rest->args[0], b.rest);
  }
  if (is_perp(b.rest) && !is_component_axis(b.rest)) {
    return factor * cross(b.rest->args[0], a.rest);
  }
  if (pool.dimension() == 2 && (a.rest == perp(b.rest) || b.rest == perp(a.rest))) {
    return pool.number(0);
  }
  if (const Expr known = known_dot(a.rest, b.rest)) return factor * known;
  if (is_part_across(a.rest, b.rest) || is_part_across(b.rest, a.rest)) return pool.number(0);
  if (a.rest == b.rest && a.rest->unit_length) return factor;
  if (is_unit_of(b.rest, a.rest)) return factor * norm(a.rest);
  if (is_unit_of(a.rest, b.rest)) return factor * norm(b.rest);
  const bool in_order = direction_after(a.rest, b.rest);
  return factor * node(Kind::dot, false, in_order ? std::vector{a.rest, b.rest} : std::vector{b.rest, a.rest});
}

Expr cross(Expr u, Expr v) {
  if (!u->vector) return u * perp(v);
  const Scaled a = split_scale(u), b = split_scale(v);
  const Expr factor = a.factor * b.factor;
  Pool& pool = *u->pool;
  const bool plane = pool.dimension() == 2;
  if (is_zero(factor) || is_zero(a.rest) || is_zero(b.rest) || a.rest == b.rest || is_unit_of(b.rest, a.rest) ||
      is_unit_of(a.rest, b.rest)) {
    return plane ? pool.number(0) : zero_vector(pool);
  }
  if (!plane) return factor * cross_in_space(a.rest, b.rest);
  if (is_perp(a.rest) && is_perp(b.rest)) return factor * cross(a.rest->args[0], b.rest->args[0]);
  if (is_perp(a.rest)) return -(factor * dot(a.rest->args[0], b.rest));
  if (is_perp(b.rest)) return factor * dot(a.rest, b.rest->args[0]);
  if (is_world_axis(b.rest)) return -(factor * dot(a.rest, perp(b.rest)));  // u x e_x = -u_y
  if (is_world_axis(a.rest)) return factor * dot(perp(a.rest), b.rest);
  if (direction_after(a.rest, b.rest)) return factor * node(Kind::cross, false, {a.rest, b.rest});
  return -(factor * node(Kind::cross, false, {b.rest, a.rest}));
}

Expr apply(Expr T, Expr u) {
  if (!u->vector || T->pool->dimension() == 2) return T * u;
  const Scaled a = split_scale(u);
  if (is_zero(a.factor) || is_zero(a.rest)) return zero_vector(*u->pool);
  return a.factor * node(Kind::tensor, true, {T, a.rest});
}

Expr twist(const Triad& f, const Triad& g) {
  if (f == g) return f[0]->pool->number(0);
  return node(Kind::twist, false, {f[0], f[1], f[2], g[0], g[1], g[2]});
}

Expr twist_as_atan2(Expr twist) {
  const std::vector<Expr>& t = twist->args;
  const Expr parts[] = {dot(t[2], t[4]) - dot(t[1], t[5]), dot(t[1], t[4]) + dot(t[2], t[5])};
  return call(Fn::atan2, parts);
}

Expr perp(Expr u) {
  const Scaled a = split_scale(u);
  if (is_zero(a.rest)) return a.rest;
  if (is_perp(a.rest)) return (-a.factor) * a.rest->args[0];
  return a.factor * node(Kind::perp, true, {a.rest}, a.rest->unit_length);
}

Expr norm(Expr u) {
  const Scaled a = split_scale(u);
  Pool& pool = *u->pool;
  if (is_zero(a.rest)) return pool.number(0);
  const Expr factor = call(Fn::abs, a.factor);
  if (a.rest->unit_length) return factor;
  const Expr inner = is_perp(a.rest) ? a.rest->args[0] : a.rest;
  return factor * node(Kind::norm, false, {inner});
}

Expr unit(Expr u) {
  const Scaled a = split_scale(u);
  if (is_zero(a.rest)) return world_x(*u->pool);
  const Expr sign = call(Fn::sign, a.factor);
  if (a.rest->unit_length) return sign * a.rest;
  if (is_perp(a.rest)) return sign * perp(unit(a.rest->args[0]));
  return sign * node(Kind::unit, true, {a.rest}, true);
}

Expr call(Fn fn, std::span<const Expr> args) {
  const Expr a = args[0];
  Pool& pool = *a->pool;
  if (const auto of_number = function_of(fn).of_number; of_number && a->kind == Kind::number) {
    if (const std::optional<Rational> known = of_number(a->value)) return pool.number(*known);
  }
  // sqrt(u . u) is the length of u.
  if (fn == Fn::sqrt && a->kind == Kind::dot && a->args[0] == a->args[1]) return norm(a->args[0]);
  if (fn == Fn::abs && a->kind == Kind::norm) return a;
  Node n;
  n.kind = Kind::function;
  n.fn = fn;
  n.args.assign(args.begin(), args.end());
  return pool.intern(std::move(n));
}

Expr world_x(Pool& pool) { return world_axes(pool)[0]; }

std::vector<Expr> world_axes(Pool& pool) {
  if (pool.dimension() == 2) {
    const Expr x = pool.vector_symbol("world.x", Role::world_vector, -1, true);
    return {x, perp(x)};
  }
  const Triad axes = pool.triad("world", Role::world_vector);
  return {axes.begin(), axes.end()};
}

bool is_tensor(Expr leaf) {
  return leaf->pool->dimension() == 3 && leaf->role == Role::inverse_inertia &&
         leaf->symbol.find('_', 6) == std::string::npos;  // inv_I_a, not inv_I_a_xy
}

std::vector<Expr> components_of(Expr e) {
  if (!e->vector) return {e};
  std::vector<Expr> components;
  for (const Expr axis : world_axes(*e->pool)) components.push_back(dot(axis, e));
  return components;
}

Expr rebuild(Expr e, std::span<const Expr> args) {
  Pool& pool = *e->pool;
  switch (e->kind) {
    case Kind::number:
    case Kind::symbol: return e;
    case Kind::sum: {
      std::vector<Term> terms;
      for (std::size_t i = 0; i < args.size(); ++i) terms.push_back({e->coefs[i], args[i]});
      return sum(pool, terms, e->vector);
    }
    case Kind::product: return product(pool, args, e->exponents);
    case Kind::function: return call(e->fn, args);
    case Kind::scale: return args[0] * args[1];
    case Kind::dot: return dot(args[0], args[1]);
    case Kind::cross: return cross(args[0], args[1]);
    case Kind::perp: return perp(args[0]);
    case Kind::tensor: return apply(args[0], args[1]);
    case Kind::twist: return twist({args[0], args[1], args[2]}, {args[3], args[4], args[5]});
    case Kind::norm: return norm(args[0]);
    case Kind::unit: return unit(args[0]);
  }
  return e;
}

}  // namespace cdot::derive
