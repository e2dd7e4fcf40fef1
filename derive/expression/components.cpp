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

// Sums of vectors, component by component.
class Sums {
 public:
  explicit Sums(Pool& pool) : pool_(pool), terms_(static_cast<std::size_t>(pool.dimension())) {}
  void add(Rational coef, const std::vector<Expr>& components) {
    for (std::size_t k = 0; k < components.size(); ++k) terms_[k].push_back({coef, components[k]});
  }
  std::vector<Expr> total() const {
    std::vector<Expr> sums;
    for (const std::vector<Term>& terms : terms_) sums.push_back(sum(pool_, terms, false));
    return sums;
  }

 private:
  Pool& pool_;
  std::vector<std::vector<Term>> terms_;
};

std::vector<Expr> scaled_by(Expr s, std::vector<Expr> u) {
  for (Expr& component : u) component = s * component;
  return u;
}

// "n_x"; with an ending "n_in_b_x".
void name_components(const std::vector<Expr>& components, const std::string& name, const std::string& ending, Expr of) {
  if (name.empty()) return;
  for (std::size_t k = 0; k < components.size(); ++k) {
    of->pool->name(components[k], name + ending + "_" + "xyz"[k], of -> named_by_let);
  }
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
  if (v->kind != Kind::symbol) name_components(components, spoken_name(v), "", v);
  vectors_.emplace(&*v, components);
  return components;
}

Expr Components::scalar_rule(Expr e) {
  switch (e->kind) {
    case Kind::number:
    case Kind::symbol: return e;
    case Kind::dot:
      if (const Expr local = local_product(e)) return local;
      return inner_product(of_vector(e->args[0]), of_vector(e->args[1]));
    case Kind::cross: {
      if (const Expr local = local_product(e)) return local;
      const auto u = of_vector(e->args[0]), v = of_vector(e->args[1]);
      return u[0] * v[1] - u[1] * v[0];
    }
    case Kind::norm: {
      const auto u = is_turned(e->args[0]) ? local_components(e->args[0]) : of_vector(e->args[0]);
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
  switch (v->kind) {
    case Kind::symbol: return leaf_components(v);
    case Kind::sum: return sum_rule(v);
    case Kind::scale: return scaled_by(of(v->args[0]), of_vector(v->args[1]));
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

// A sum of scaled vectors of the body is turned as one, with what else is cheap to know in the body's axes.
std::vector<Expr> Components::sum_rule(Expr v) {
  Sums world(*v->pool), local(*v->pool);
  int turned = 0;
  bool scaled = false;
  for (const Term& term : terms_of(v)) {
    const bool turns = is_turned(term.e);
    turned += turns ? 1 : 0;
    scaled = scaled || (turns && term.e->kind == Kind::scale);
  }
  const bool together = scaled && turned > 1;
  for (const Term& term : terms_of(v)) {
    if (together && is_turned(term.e)) local.add(term.coef, local_components(term.e));
    else world.add(term.coef, of_vector(term.e));
  }
  if (!together) return world.total();
  const std::vector<Expr> l = local.total();
  name_components(l, spoken_name(v), "_in_" + axes_->name, v);
  std::vector<Expr> rotated;
  for (const std::vector<Expr>& row : axes_->A) rotated.push_back(inner_product(row, l));
  world.add(1, rotated);
  return world.total();
}

std::vector<Expr> Components::fixed_components(Expr v) {
  if (axes_ == nullptr) return {};
  if (v->kind == Kind::perp) {
    const std::vector<Expr> u = fixed_components(v->args[0]);
    return u.empty() ? u : std::vector<Expr>{-u[1], u[0]};
  }
  if (v->kind == Kind::scale) {
    const std::vector<Expr> u = fixed_components(v->args[1]);
    return u.empty() ? u : scaled_by(of(v->args[0]), u);
  }
  const auto found = axes_->fixed.find(&*v);
  return found == axes_->fixed.end() ? std::vector<Expr>() : found->second;
}

bool Components::is_turned(Expr v) {
  if (axes_ == nullptr) return false;
  if (!fixed_components(v).empty()) return true;
  if (v->kind == Kind::scale) return is_turned(v->args[1]);
  if (v->kind == Kind::unit) return is_turned(v->args[0]);
  return v->kind == Kind::sum && std::ranges::any_of(v->args, [&](Expr e) { return is_turned(e); });
}

// A' v, where the parts of v that are fixed in the body need no rotation.
std::vector<Expr> Components::local_components(Expr v) {
  if (const std::vector<Expr> fixed = fixed_components(v); !fixed.empty()) return fixed;
  if (const auto found = locals_.find(&*v); found != locals_.end()) return found->second;
  if (v->kind == Kind::scale) return locals_[&*v] = scaled_by(of(v->args[0]), local_components(v->args[1]));
  if (v->kind == Kind::unit) return locals_[&*v] = direction(v, local_components(v->args[0]), axes_->A[0]);
  Sums local(*v->pool), world(*v->pool);
  for (const Term& term : terms_of(v)) {
    if (term.e != v && is_turned(term.e)) local.add(term.coef, local_components(term.e));
    else world.add(term.coef, of_vector(term.e));
  }
  const std::vector<Expr> w = world.total();
  std::vector<Expr> rotated(w.size(), v->pool->number(0));
  for (std::size_t k = 0; k < w.size(); ++k) {
    for (std::size_t i = 0; i < w.size(); ++i) rotated[k] = rotated[k] + axes_->A[i][k] * w[i];
  }
  local.add(1, rotated);
  const std::vector<Expr> result = local.total();
  name_components(result, spoken_name(v), "_in_" + axes_->name, v);
  return locals_[&*v] = result;
}

Expr Components::local_product(Expr product) {
  const Expr u = product->args[0], v = product->args[1];
  if (is_component_axis(u) || is_component_axis(v)) return {};
  const bool with_fixed = fixed_components(u).empty() != fixed_components(v).empty();
  if (!with_fixed && !(u == v && is_turned(u))) return {};
  const std::vector<Expr> a = local_components(u), b = local_components(v);
  return product->kind == Kind::dot ? inner_product(a, b) : a[0] * b[1] - a[1] * b[0];
}

std::vector<Expr> Components::unit_rule(Expr v) {
  return direction(v, of_vector(v->args[0]), leaf_components(world_axes(*v->pool)[0]));
}

// u/|u| by the components of u in some axes, and the world's x axis where u vanishes.
std::vector<Expr> Components::direction(Expr v, const std::vector<Expr>& u, const std::vector<Expr>& world_x) {
  const Expr length = of(norm(v->args[0]));
  const Expr inverse = of(pow(norm(v->args[0]), -1));
  std::vector<Expr> n;
  for (std::size_t k = 0; k < u.size(); ++k) {
    const Expr cases[] = {length, u[k] * inverse, world_x[k]};
    n.push_back(call(Fn::select, cases));
  }
  return n;
}

}  // namespace cdot::derive
