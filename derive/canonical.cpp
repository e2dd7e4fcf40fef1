// From vectors to components. The rules are those of the plane; names follow the derivation, so that a kernel reads
// like the code that a careful person writes.
#include "derive/canonical.hpp"

#include <cassert>

namespace cdot::derive {
namespace {

// A name for a scalar that is obvious from its parts, or "".
std::string name_from_parts(Expr e) {
  if (!e->name.empty()) return e->name;
  const auto part = [&](std::size_t i) { return spoken_name(e->args[i]); };
  if (e->kind == Kind::norm && !part(0).empty()) return part(0) + "_len";
  if (e->kind != Kind::cross && e->kind != Kind::dot) return "";
  const Expr x = world_x(*e->pool);
  for (const Expr arg : e->args) {
    // A component needs no name beside that of its vector.
    if (arg == x || arg == perp(x) || spoken_name(arg).empty()) return "";
  }
  return e->kind == Kind::cross ? part(0) + "_x_" + part(1) : "dot_" + part(0) + "_" + part(1);
}

}  // namespace

std::string spoken_name(Expr e) {
  if (!e->name.empty()) return e->name;
  if (e->kind == Kind::symbol) return e->symbol;
  if (e->kind == Kind::unit && !spoken_name(e->args[0]).empty()) {
    return "dir_" + spoken_name(e->args[0]);
  }
  // rb + u is spoken as rb_u; with a minus sign there is no short name that says it.
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

std::array<Expr, 2> Components::of_vector(Expr v) {
  assert(v->vector);
  if (const auto found = vectors_.find(&*v); found != vectors_.end()) return found->second;
  const std::array<Expr, 2> components = vector_rule(v);
  const std::string name = spoken_name(v);
  if (!name.empty() && v->kind != Kind::symbol) {
    v->pool->name(components[0], name + "_x", v->named_by_let);
    v->pool->name(components[1], name + "_y", v->named_by_let);
  }
  vectors_.emplace(&*v, components);
  return components;
}

Expr Components::scalar_rule(Expr e) {
  switch (e->kind) {
    case Kind::number:
    case Kind::symbol: return e;
    case Kind::dot: {
      const auto u = of_vector(e->args[0]), v = of_vector(e->args[1]);
      return u[0] * v[0] + u[1] * v[1];
    }
    case Kind::cross: {
      const auto u = of_vector(e->args[0]), v = of_vector(e->args[1]);
      return u[0] * v[1] - u[1] * v[0];
    }
    case Kind::norm: {
      const auto u = of_vector(e->args[0]);
      return call(Fn::sqrt, u[0] * u[0] + u[1] * u[1]);
    }
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

std::array<Expr, 2> Components::vector_rule(Expr v) {
  Pool& pool = *v->pool;
  switch (v->kind) {
    case Kind::symbol:
      if (v == world_x(pool)) return {pool.number(1), pool.number(0)};
      return {pool.symbol(v->symbol + "_x", v->role, v->body),
              pool.symbol(v->symbol + "_y", v->role, v->body)};
    case Kind::sum: {
      std::vector<Term> x, y;
      for (std::size_t i = 0; i < v->args.size(); ++i) {
        const auto part = of_vector(v->args[i]);
        x.push_back({v->coefs[i], part[0]});
        y.push_back({v->coefs[i], part[1]});
      }
      return {sum(pool, x, false), sum(pool, y, false)};
    }
    case Kind::scale: {
      const Expr s = of(v->args[0]);
      const auto u = of_vector(v->args[1]);
      return {s * u[0], s * u[1]};
    }
    case Kind::perp: {
      const auto u = of_vector(v->args[0]);
      return {-u[1], u[0]};
    }
    case Kind::unit: {
      // n = u/|u|, and (1, 0) where u vanishes.
      const auto u = of_vector(v->args[0]);
      const Expr length = of(norm(v->args[0]));
      const Expr inverse = of(pow(norm(v->args[0]), -1));
      const Expr x[] = {length, u[0] * inverse, pool.number(1)};
      const Expr y[] = {length, u[1] * inverse, pool.number(0)};
      return {call(Fn::select, x), call(Fn::select, y)};
    }
    default: break;
  }
  assert(false && "not a vector");
  return {};
}

}  // namespace cdot::derive
