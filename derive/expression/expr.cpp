// Interning, the structural order, and traversals. The builders are in expression/build.cpp, the printer in
// expression/text.cpp.
#include "derive/expression/expr.hpp"

#include <algorithm>
#include <cassert>
#include <set>

#include "derive/expression/functions.hpp"

namespace cdot::derive {
namespace {

// The order of leaves. Differences of positions come first, since they cancel large common parts; then vectors that
// turn with a body. Masses precede inertias. Names order the rest.
int rank(const Node& n) {
  switch (n.role) {
    case Role::constant: return 0;
    case Role::inverse_mass: return 1;
    case Role::inverse_inertia: return 2;
    case Role::position: return 3;
    case Role::world_vector: return 4;
    case Role::body_vector: return n.unit_length ? 7 : 5;
    case Role::angle: return 6;
    case Role::parameter: return 9;
    default: return 8;
  }
}

std::strong_ordering compare_symbols(const Node& a, const Node& b) {
  if (const auto c = rank(a) <=> rank(b); c != 0) return c;
  return a.symbol <=> b.symbol;
}

}  // namespace

std::string_view name_of(Fn fn) { return function_of(fn).name; }

std::strong_ordering compare(Expr a, Expr b) {
  if (a == b) return std::strong_ordering::equal;
  // A number sorts last in sums; symbols before compounds.
  if (const auto c = (a->kind == Kind::number) <=> (b->kind == Kind::number); c != 0) return c;
  if (a->kind == Kind::number) return a->value <=> b->value;
  if (const auto c = a->kind <=> b->kind; c != 0) return c;
  if (a->kind == Kind::symbol) return compare_symbols(*a, *b);
  if (a->kind == Kind::function) {
    if (const auto c = a->fn <=> b->fn; c != 0) return c;
  }
  const std::size_t shared = std::min(a->args.size(), b->args.size());
  for (std::size_t i = 0; i < shared; ++i) {
    if (const auto c = compare(a->args[i], b->args[i]); c != 0) return c;
    if (a->kind == Kind::product) {
      if (const auto c = a->exponents[i] <=> b->exponents[i]; c != 0) return c;
    }
    if (a->kind == Kind::sum) {
      if (const auto c = a->coefs[i] <=> b->coefs[i]; c != 0) return c;
    }
  }
  return a->args.size() <=> b->args.size();
}

std::size_t Pool::HashOfContent::operator()(const Node* node) const {
  std::uint64_t hash = static_cast<std::uint64_t>(node->kind) * 2 + node->vector;
  const auto add = [&](auto number) {
    hash = (hash ^ static_cast<std::uint64_t>(number)) * 0x9e3779b97f4a7c15u;  // by the golden ratio
    hash ^= hash >> 32;
  };
  add(std::hash<std::string>()(node->symbol));
  add(node->fn);
  add(node->value.num());
  add(node->value.den());
  for (const Expr arg : node->args) add(arg->id);
  for (const Rational& coef : node->coefs) add(coef.num()), add(coef.den());
  for (const int exponent : node->exponents) add(exponent);
  return static_cast<std::size_t>(hash);
}

bool Pool::SameContent::operator()(const Node* a, const Node* b) const {
  return a->kind == b->kind && a->vector == b->vector && a->fn == b->fn && a->value == b->value && a->args == b->args &&
         a->coefs == b->coefs && a->exponents == b->exponents && a->symbol == b->symbol;
}

Expr Pool::intern(Node node) {
  if (const auto found = by_content_.find(&node); found != by_content_.end()) return Expr(*found);
  node.pool = this;
  node.id = static_cast<int>(nodes_.size());
  nodes_.push_back(std::move(node));
  const Node* stored = &nodes_.back();
  by_content_.insert(stored);
  if (stored->kind == Kind::symbol) symbols_.emplace(stored->symbol, stored);
  return Expr(stored);
}

Expr Pool::number(Rational value) {
  Node n;
  n.kind = Kind::number;
  n.value = value;
  return intern(std::move(n));
}

Expr Pool::leaf(std::string_view name, Role role, int body, bool vector, bool unit_length) {
  if (const Expr known = find(name)) {
    assert(known->vector == vector && known->role == role && known->body == body);
    return known;
  }
  Node n;
  n.kind = Kind::symbol;
  n.vector = vector;
  n.unit_length = unit_length;
  n.symbol = name;
  n.role = role;
  n.body = body;
  return intern(std::move(n));
}

Expr Pool::symbol(std::string_view name, Role role, int body) { return leaf(name, role, body, false, false); }

Expr Pool::vector_symbol(std::string_view name, Role role, int body, bool unit_length) {
  return leaf(name, role, body, true, unit_length);
}

Triad Pool::triad(std::string_view name, Role role, int body) {
  if (const auto found = triads_.find(name); found != triads_.end()) return found->second;
  const std::string stem = std::string(name) + (role == Role::world_vector && name == "world" ? "." : "_");
  Triad axes;
  for (std::size_t i = 0; i < 3; ++i) axes[i] = vector_symbol(stem + "xyz"[i], role, body, true);
  const Triad* stored = &triads_.emplace(name, axes).first->second;
  for (int i = 0; i < 3; ++i) axes_[&*axes[static_cast<std::size_t>(i)]] = {stored, i};
  return axes;
}

Pool::Axis Pool::axis_of(Expr leaf) const {
  const auto found = axes_.find(&*leaf);
  return found == axes_.end() ? Axis{} : found->second;
}

Expr Pool::find(std::string_view name) const {
  const auto found = symbols_.find(name);
  return found == symbols_.end() ? Expr() : Expr(found->second);
}

void Pool::name(Expr e, std::string_view name, bool by_let) {
  if (e->kind == Kind::symbol || e->kind == Kind::number || e->named_by_let || is_zero(e)) return;
  if (!by_let && !e->name.empty()) return;
  e->name = name;
  e->named_by_let = by_let;
}

bool is_number(Expr e, Rational value) {
  if (e->vector) return value.is_zero() && e->kind == Kind::sum && e->args.empty();
  return e->kind == Kind::number && e->value == value;
}

std::vector<Expr> topological(std::span<const Expr> roots) {
  std::vector<Expr> order;
  std::set<const Node*> seen;  // looked up only, never walked: its order does not matter
  const auto visit = [&](auto&& self, Expr e) -> void {
    if (!seen.insert(&*e).second) return;
    for (const Expr arg : e->args) self(self, arg);
    order.push_back(e);
  };
  for (const Expr root : roots) visit(visit, root);
  return order;
}

std::vector<Expr> leaves_of(std::span<const Expr> expressions) {
  std::vector<Expr> leaves;
  for (const Expr e : topological(expressions)) {
    if (e->kind == Kind::symbol) leaves.push_back(e);
  }
  std::sort(leaves.begin(), leaves.end(), [](Expr a, Expr b) { return a->symbol < b->symbol; });
  return leaves;
}

bool depends_on_bodies(Expr e) {
  const std::vector<Expr> parts = topological(std::span<const Expr>(&e, 1));
  return std::any_of(parts.begin(), parts.end(), [](Expr p) { return p->kind == Kind::symbol && p->body >= 0; });
}

bool depends_on_velocity(Expr e) {
  return std::ranges::any_of(leaves_of(std::span(&e, 1)),
                             [](Expr leaf) { return leaf->role == Role::velocity || leaf->role == Role::spin; });
}

}  // namespace cdot::derive
