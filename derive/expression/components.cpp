// Vectors to components. Names follow the derivation: a kernel reads like code that a careful person writes.
#include "derive/expression/components.hpp"

#include <algorithm>
#include <cassert>

#include "derive/expression/functions.hpp"
#include "derive/expression/matrix.hpp"

namespace cdot::derive {
namespace {

// A name for a scalar that is obvious from its parts, or "".
std::string name_from_parts(Expr e) {
  if (!e->name.empty()) return e->name;
  const auto part = [&](std::size_t i) { return spoken_name(e->args[i]); };
  if (e->kind == Kind::norm && !part(0).empty()) return part(0) + "_len";
  if (e->kind != Kind::cross && e->kind != Kind::dot) return "";
  const std::vector<Expr> axes = world_axes(*e->pool);
  for (const Expr arg : e->args) {
    // A component needs no name beside that of its vector.
    if (std::find(axes.begin(), axes.end(), arg) != axes.end() || spoken_name(arg).empty()) return "";
  }
  return e->kind == Kind::cross ? part(0) + "_x_" + part(1) : "dot_" + part(0) + "_" + part(1);
}

Expr inner_product(const std::vector<Expr>& u, const std::vector<Expr>& v) {
  Expr total = u[0] * v[0];
  for (std::size_t k = 1; k < u.size(); ++k) total = total + u[k] * v[k];
  return total;
}

std::vector<Expr> leaf_components(Expr v) {
  Pool& pool = *v->pool;
  std::vector<Expr> components;
  for (const Expr axis : world_axes(pool)) {
    const Expr constant = dot(axis, v);
    const bool known = is_world_axis(v);
    const char letter = "xyz"[components.size()];
    components.push_back(known ? constant : pool.symbol(v->symbol + "_" + letter, v->role, v->body));
  }
  return components;
}

}  // namespace

std::string spoken_name(Expr e) {
  if (!e->name.empty()) return e->name;
  if (e->kind == Kind::symbol) return e->symbol;
  if (e->kind == Kind::unit && !spoken_name(e->args[0]).empty()) {
    return "dir_" + spoken_name(e->args[0]);
  }
  // ra x n, the lever of a direction. Its components along world axes need no name.
  if (e->vector && e->kind == Kind::cross && !is_world_axis(e->args[0]) && !is_world_axis(e->args[1])) {
    const std::string a = spoken_name(e->args[0]), b = spoken_name(e->args[1]);
    if (!a.empty() && !b.empty()) return a + "_x_" + b;
  }
  // rb + u becomes rb_u. A difference has no short name.
  if (e->vector && e->kind == Kind::sum && e->args.size() == 2 && e->coefs[0] == Rational(1) &&
      e->coefs[1] == Rational(1)) {
    const std::string a = spoken_name(e->args[0]), b = spoken_name(e->args[1]);
    if (!a.empty() && !b.empty()) return a + "_" + b;
  }
  return "";
}

Expr Components::of(Expr e) {
  assert(!e->vector);
  if (const auto found = scalars_.find(&*e); found != scalars_.end()) return found->second;
  const Expr written_out = scalar_rule(e);
  const std::string name = name_from_parts(e);
  if (!name.empty()) e->pool->name(written_out, name, e->named_by_let);
  scalars_.emplace(&*e, written_out);
  return written_out;
}

std::vector<Expr> Components::of_vector(Expr v) {
  assert(v->vector);
  if (const auto found = vectors_.find(&*v); found != vectors_.end()) return found->second;
  const std::vector<Expr> components = vector_rule(v);
  const std::string name = spoken_name(v);
  if (!name.empty() && v->kind != Kind::symbol) {
    for (std::size_t k = 0; k < components.size(); ++k) {
      v->pool->name(components[k], name + "_" + "xyz"[k], v -> named_by_let);
    }
  }
  vectors_.emplace(&*v, components);
  return components;
}

Expr Components::scalar_rule(Expr e) {
  switch (e->kind) {
    case Kind::number:
    case Kind::symbol: return e;
    case Kind::dot: return inner_product(of_vector(e->args[0]), of_vector(e->args[1]));
    case Kind::cross: {
      const auto u = of_vector(e->args[0]), v = of_vector(e->args[1]);
      return u[0] * v[1] - u[1] * v[0];
    }
    case Kind::norm: {
      const auto u = of_vector(e->args[0]);
      return call(Fn::sqrt, inner_product(u, u));
    }
    case Kind::twist: return of(twist_as_atan2(e));
    case Kind::product: {
      Expr total = e->pool->number(1);
      for (std::size_t i = 0; i < e->args.size(); ++i) {
        const int k = e->exponents[i];
        Expr base = of(e->args[i]);
        if (k < 0) {
          const std::string name = base->name.empty() ? spoken_name(base) : base->name;
          base = call(Fn::inverse, base);
          if (!name.empty()) e->pool->name(base, "inv_" + name, false);
        }
        total = total * pow(base, k < 0 ? -k : k);
      }
      return total;
    }
    default: {
      std::vector<Expr> args;
      for (const Expr arg : e->args) args.push_back(of(arg));
      return rebuild(e, args);
    }
  }
}

std::vector<Expr> Components::vector_rule(Expr v) {
  Pool& pool = *v->pool;
  switch (v->kind) {
    case Kind::symbol: return leaf_components(v);
    case Kind::sum: {
      std::vector<std::vector<Term>> terms(static_cast<std::size_t>(pool.dimension()));
      for (std::size_t i = 0; i < v->args.size(); ++i) {
        const auto part = of_vector(v->args[i]);
        for (std::size_t k = 0; k < part.size(); ++k) terms[k].push_back({v->coefs[i], part[k]});
      }
      std::vector<Expr> sums;
      for (const std::vector<Term>& t : terms) sums.push_back(sum(pool, t, false));
      return sums;
    }
    case Kind::scale: {
      const Expr s = of(v->args[0]);
      std::vector<Expr> u = of_vector(v->args[1]);
      for (Expr& component : u) component = s * component;
      return u;
    }
    case Kind::perp: {
      const auto u = of_vector(v->args[0]);
      return {-u[1], u[0]};
    }
    case Kind::cross: {
      const auto a = of_vector(v->args[0]), b = of_vector(v->args[1]);
      return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    }
    case Kind::tensor: {
      const auto u = of_vector(v->args[1]);
      std::vector<Expr> product;
      for (std::size_t i = 0; i < 3; ++i) {
        product.push_back(inner_product({tensor_component(v->args[0], i, 0), tensor_component(v->args[0], i, 1),
                                         tensor_component(v->args[0], i, 2)},
                                        u));
      }
      return product;
    }
    case Kind::unit: return unit_rule(v);
    default: break;
  }
  assert(false && "not a vector");
  return {};
}

// n = u/|u|, and the world's x axis where u vanishes.
std::vector<Expr> Components::unit_rule(Expr v) {
  Pool& pool = *v->pool;
  const auto u = of_vector(v->args[0]);
  const Expr length = of(norm(v->args[0]));
  const Expr inverse = of(pow(norm(v->args[0]), -1));
  std::vector<Expr> n;
  for (std::size_t k = 0; k < u.size(); ++k) {
    const Expr cases[] = {length, u[k] * inverse, pool.number(k == 0 ? 1 : 0)};
    n.push_back(call(Fn::select, cases));
  }
  return n;
}

}  // namespace cdot::derive
