#include "derive/diff/terms.hpp"

#include <algorithm>
#include <set>

#include "derive/derivation/derivation.hpp"
#include "derive/expression/matrix.hpp"

namespace cdot::derive {
namespace {

// Equal terms added up, in the order of expressions.
Terms merged(Terms terms) {
  std::stable_sort(terms.begin(), terms.end(), [](const Term& a, const Term& b) { return compare(a.e, b.e) < 0; });
  Terms sums;
  for (const Term& t : terms) {
    if (is_zero(t.e)) continue;
    if (!sums.empty() && sums.back().e == t.e) sums.back().coef = sums.back().coef + t.coef;
    else sums.push_back(t);
  }
  std::erase_if(sums, [](const Term& t) { return t.coef.is_zero(); });
  return sums;
}

class Expansion {
 public:
  Expansion(const Joint& joint, Opened opened) : pool_(*joint.pool), opened_(opened) {
    for (const Let& let : joint.lets) lets_of_spec_.insert(let.name);
  }

  // The name of the root itself is always opened. A sum with too many terms for a reader stays closed.
  Terms of(Expr e) {
    constexpr std::size_t most_terms = 40;
    const auto known = known_.find(&*e);
    if (known != known_.end()) return known->second;
    Terms terms = distributed(e);
    if (terms.size() > most_terms) terms = {split_coefficient(e)};
    return known_.emplace(&*e, std::move(terms)).first->second;
  }

 private:
  Terms distributed(Expr e) {
    switch (e->kind) {
      case Kind::sum: return sum_of_terms(e);
      case Kind::dot: return bilinear(e, [&](Expr u, Expr v) { return dot_terms(u, v); });
      case Kind::cross: return bilinear(e, [&](Expr u, Expr v) { return cross_terms(u, v); });
      case Kind::scale: return bilinear(e, [](Expr s, Expr v) { return terms_of(s * v); });
      case Kind::perp: return linear(e, 0, [](Expr u) { return perp(u); });
      case Kind::tensor: return linear(e, 1, [&](Expr u) { return apply(e->args[0], u); });
      case Kind::product: return product(e);
      default: return {split_coefficient(e)};
    }
  }

  bool closed(Expr e) const {
    if (opened_ == Opened::everything || opened_ == Opened::components) return false;
    if (!e->named_by_let) return opened_ < Opened::rates;
    return opened_ < Opened::own_lets || lets_of_spec_.contains(e->name);
  }
  bool stays(Expr e) const { return !e->name.empty() && closed(e); }

  Terms part(Expr e) { return stays(e) ? Terms{{Rational(1), e}} : of(e); }

  Terms sum_of_terms(Expr e) {
    // A name may stand for the negative: d = -u.
    const Expr negative = -e;
    if (stays(negative)) return {{Rational(-1), negative}};
    Terms terms;
    for (std::size_t i = 0; i < e->args.size(); ++i) {
      for (const Term& t : part(e->args[i])) terms.push_back({e->coefs[i] * t.coef, t.e});
    }
    return merged(std::move(terms));
  }

  template <class Operator>
  Terms linear(Expr e, std::size_t operand, Operator op) {
    Terms terms;
    for (const Term& u : part(e->args[operand])) {
      for (const Term& t : terms_of(op(u.e))) terms.push_back({u.coef * t.coef, t.e});
    }
    return merged(std::move(terms));
  }

  template <class Operator>
  Terms bilinear(Expr e, Operator op) {
    Terms terms;
    for (const Term& u : part(e->args[0])) {
      for (const Term& v : part(e->args[1])) {
        for (const Term& t : op(u.e, v.e)) terms.push_back({u.coef * v.coef * t.coef, t.e});
      }
    }
    return merged(std::move(terms));
  }

  Terms product(Expr e) {
    Terms terms = {{Rational(1), pool_.number(1)}};
    for (std::size_t i = 0; i < e->args.size(); ++i) {
      const int n = e->exponents[i];
      if (n > 0 && n <= 2) {
        for (int k = 0; k < n; ++k) terms = times(terms, part(e->args[i]));
      } else {
        terms = times(terms, terms_of(pow(denominator(e->args[i]), n)));
      }
    }
    return merged(std::move(terms));
  }

  Expr denominator(Expr e) { return stays(e) || opened_ < Opened::everything ? e : sum(pool_, of(e), false); }

  static Terms times(const Terms& left, const Terms& right) {
    Terms products;
    for (const Term& l : left) {
      for (const Term& r : right) {
        for (const Term& t : terms_of(l.e * r.e)) products.push_back({l.coef * r.coef * t.coef, t.e});
      }
    }
    return products;
  }

  Terms dot_terms(Expr u, Expr v) {
    if (is_composed(u) && !is_composed(v)) std::swap(u, v);
    const std::vector<Expr> axes = world_axes(pool_);
    const auto axis = std::find(axes.begin(), axes.end(), u);
    if (is_composed(v) && axis != axes.end()) {
      const std::size_t k = static_cast<std::size_t>(axis - axes.begin());
      const bool of_axis = v->kind == Kind::cross && (is_axis(v->args[0]) || is_axis(v->args[1]));
      if (of_axis || opened_ == Opened::components) return of(component_of(v, k));
    }
    if (opened_ < Opened::dots || is_axis(u) || is_axis(v)) return terms_of(dot(u, v));
    if (is_composed(v) && opened_ < Opened::components) return terms_of(dot(u, v));
    Expr total = pool_.number(0);
    for (const Expr e : axes) total = total + dot(e, u) * dot(e, v);
    return is_composed(v) ? of(total) : terms_of(total);
  }

  // A vector in space whose components are sums of products.
  bool is_composed(Expr v) const {
    return pool_.dimension() == 3 && (v->kind == Kind::cross || v->kind == Kind::tensor);
  }

  Expr component_of(Expr v, std::size_t k) const {
    const std::vector<Expr> axes = world_axes(pool_);
    if (v->kind == Kind::cross) {
      const Expr i = axes[(k + 1) % 3], j = axes[(k + 2) % 3];
      return dot(i, v->args[0]) * dot(j, v->args[1]) - dot(j, v->args[0]) * dot(i, v->args[1]);
    }
    Expr total = pool_.number(0);
    for (std::size_t j = 0; j < 3; ++j) {
      total = total + tensor_component(v->args[0], k, j) * dot(axes[j], v->args[1]);
    }
    return total;
  }

  // In the plane; in space dot_terms opens them.
  Terms cross_terms(Expr u, Expr v) const {
    if (opened_ < Opened::components || pool_.dimension() == 3) return terms_of(cross(u, v));
    const std::vector<Expr> axes = world_axes(pool_);
    return terms_of(dot(axes[0], u) * dot(axes[1], v) - dot(axes[1], u) * dot(axes[0], v));
  }

  bool is_axis(Expr e) const {
    const std::vector<Expr> axes = world_axes(pool_);
    return std::find(axes.begin(), axes.end(), e) != axes.end();
  }

  Pool& pool_;
  Opened opened_;
  std::set<std::string> lets_of_spec_;
  std::map<const Node*, Terms> known_;
};

// The terms of `of` that `other` lacks; each with its coefficient.
Terms terms_without(const Terms& of, const Terms& other) {
  Terms only;
  for (const Term& t : of) {
    const bool found =
        std::any_of(other.begin(), other.end(), [&](const Term& u) { return u.e == t.e && u.coef == t.coef; });
    if (!found) only.push_back(t);
  }
  return only;
}

using Powers = std::map<const Node*, int>;

Powers powers_of(Expr e) {
  if (e->kind != Kind::product) return {{&*e, 1}};
  Powers powers;
  for (std::size_t i = 0; i < e->args.size(); ++i) powers[&*e->args[i]] = e->exponents[i];
  return powers;
}

// The common part of two exponents: the smaller one, if they have one sign.
int shared(int m, int n) { return m * n <= 0 ? 0 : m > 0 ? std::min(m, n) : std::max(m, n); }

}  // namespace

Terms terms_of_expansion(Expr e, const Joint& joint, Opened opened) {
  return opened == Opened::top ? merged(terms_of(e)) : Expansion(joint, opened).of(e);
}

Leftover leftover_terms(Expr hand, Expr generated, const Joint& joint, Opened opened) {
  const Terms ours = terms_of_expansion(hand, joint, opened);
  const Terms theirs = terms_of_expansion(generated, joint, opened);
  return {terms_without(ours, theirs), terms_without(theirs, ours)};
}

Expr sum_of(const Terms& terms, Pool& pool) { return collected(sum(pool, terms, false)); }

Factors leftover_factors(const Term& hand, const Term& generated) {
  Pool& pool = *hand.e->pool;
  const bool same = abs(hand.coef) == abs(generated.coef), negative = generated.coef.sign() < 0;
  const Rational common = same ? generated.coef : Rational(negative ? -1 : 1);
  Factors f{pool.number(hand.coef / common), pool.number(generated.coef / common), pool.number(common)};
  const Powers ours = powers_of(hand.e), theirs = powers_of(generated.e);
  const auto exponent = [](const Powers& powers, const Node* base) {
    const auto found = powers.find(base);
    return found == powers.end() ? 0 : found->second;
  };
  for (const auto& [base, n] : ours) {
    const int both = shared(n, exponent(theirs, base));
    f.rest = f.rest * pow(Expr(base), both);
    f.hand = f.hand * pow(Expr(base), n - both);
  }
  for (const auto& [base, n] : theirs) {
    f.generated = f.generated * pow(Expr(base), n - shared(n, exponent(ours, base)));
  }
  return f;
}

Expr difference_of(Expr hand, Expr generated, const Joint& joint) {
  Expr shortest = hand - generated;
  for (const Opened opened : all_openings) {
    const Leftover left = leftover_terms(hand, generated, joint, opened);
    Terms terms = left.hand;
    for (const Term& t : left.generated) terms.push_back({-t.coef, t.e});
    const Expr difference = sum_of(terms, *hand->pool);
    if (text(difference).size() < text(shortest).size()) shortest = difference;
  }
  return shortest;
}

std::string brief_text(Expr e, const Joint& joint) {
  const std::string plain = text(e);
  if (joint.dimension == 2 || e->vector) return plain;
  const std::string distributed = text(sum_of(terms_of_expansion(e, joint, Opened::nothing), *e->pool));
  return distributed.size() < plain.size() ? distributed : plain;
}

std::vector<Expr> free_symbols(Expr e) {
  std::vector<Expr> free;
  for (const Expr node : topological(std::span(&e, 1))) {
    if (node->kind == Kind::symbol && node->role == Role::given && node->body < 0) free.push_back(node);
  }
  return free;
}

}  // namespace cdot::derive
