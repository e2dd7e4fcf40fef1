#include "derive/diff_terms.hpp"

#include <algorithm>

#include "derive/derivation.hpp"

namespace cdot::derive {
namespace {

class Expansion {
 public:
  Expansion(const Joint& joint, Opened opened) : opened_(opened) {
    for (const Let& let : joint.lets) lets_of_spec_.insert(let.name);
  }

  Expr root(Expr e) { return open(e); }

 private:
  bool closed(Expr e) const {
    if (e->name.empty() || opened_ == Opened::everything) return false;
    if (!e->named_by_let) return opened_ < Opened::rates;
    return opened_ < Opened::own_lets || lets_of_spec_.contains(e->name);
  }

  Expr of(Expr e) { return closed(e) ? e : open(e); }

  Expr open(Expr e) {
    switch (e->kind) {
      case Kind::sum: {
        std::vector<Term> terms;
        for (std::size_t i = 0; i < e->args.size(); ++i) terms.push_back({e->coefs[i], of(e->args[i])});
        return sum(*e->pool, terms, e->vector);
      }
      case Kind::dot: return bilinear(e, [](Expr u, Expr v) { return dot(u, v); });
      case Kind::cross: return bilinear(e, [](Expr u, Expr v) { return cross(u, v); });
      case Kind::scale: return bilinear(e, [](Expr s, Expr v) { return s * v; });
      case Kind::perp: return linear(e, 0, [](Expr u) { return perp(u); });
      case Kind::tensor: return linear(e, 1, [&](Expr u) { return apply(e->args[0], u); });
      case Kind::product: return product_of_sums(e);
      default: return e;
    }
  }

  static Expr zero_like(Expr e) { return e->vector ? zero_vector(*e->pool) : e->pool->number(0); }

  template <class Operator>
  Expr linear(Expr e, std::size_t operand, Operator op) {
    Expr total = zero_like(e);
    for (const Term& u : terms_of(of(e->args[operand]))) total = total + u.coef * op(u.e);
    return total;
  }

  template <class Operator>
  Expr bilinear(Expr e, Operator op) {
    Expr total = zero_like(e);
    for (const Term& u : terms_of(of(e->args[0]))) {
      for (const Term& v : terms_of(of(e->args[1]))) total = total + (u.coef * v.coef) * op(u.e, v.e);
    }
    return total;
  }

  Expr product_of_sums(Expr e) {
    std::vector<Term> terms = {{Rational(1), e->pool->number(1)}};
    for (std::size_t i = 0; i < e->args.size(); ++i) {
      const bool expands = e->exponents[i] > 0 && e->exponents[i] <= 2;
      const bool below = e->exponents[i] < 0 && opened_ == Opened::everything;
      const Expr factor = expands ? of(e->args[i]) : pow(below ? of(e->args[i]) : e->args[i], e->exponents[i]);
      for (int k = 0; k < (expands ? e->exponents[i] : 1); ++k) terms = times(terms, terms_of(factor));
    }
    return sum(*e->pool, terms, false);
  }

  static std::vector<Term> times(const std::vector<Term>& left, const std::vector<Term>& right) {
    std::vector<Term> products;
    for (const Term& l : left) {
      for (const Term& r : right) products.push_back({l.coef * r.coef, l.e * r.e});
    }
    return products;
  }

  Opened opened_;
  std::set<std::string> lets_of_spec_;
};

// The terms of `of` that `other` lacks; each with its coefficient.
std::vector<Term> terms_without(const std::vector<Term>& of, const std::vector<Term>& other) {
  std::vector<Term> only;
  for (const Term& t : of) {
    if (is_zero(t.e) || t.coef.is_zero()) continue;
    const bool found = std::any_of(other.begin(), other.end(), [&](const Term& u) {
      return u.e == t.e && u.coef == t.coef;
    });
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

// Of two exponents of one sign the smaller: what both sides have.
int shared(int m, int n) { return m * n <= 0 ? 0 : m > 0 ? std::min(m, n) : std::max(m, n); }

}  // namespace

Expr expanded(Expr e, const Joint& joint, Opened opened) {
  return e->vector ? e : Expansion(joint, opened).root(e);
}

Leftover leftover_terms(Expr hand, Expr generated, const Joint& joint, Opened opened) {
  const std::vector<Term> ours = terms_of(expanded(hand, joint, opened));
  const std::vector<Term> theirs = terms_of(expanded(generated, joint, opened));
  return {terms_without(ours, theirs), terms_without(theirs, ours)};
}

Expr sum_of(const std::vector<Term>& terms, Pool& pool) { return collected(sum(pool, terms, false)); }

Factors leftover_factors(const Term& hand, const Term& generated) {
  Pool& pool = *hand.e->pool;
  Factors f{pool.number(hand.coef), pool.number(generated.coef), pool.number(1)};
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
  if (hand.coef.sign() < 0 && generated.coef.sign() < 0) {
    f.hand = -f.hand, f.generated = -f.generated, f.rest = -f.rest;
  }
  return f;
}

Expr difference_of(Expr hand, Expr generated, const Joint& joint) {
  Expr shortest = hand - generated;
  for (const Opened opened : all_openings) {
    const Leftover left = leftover_terms(hand, generated, joint, opened);
    std::vector<Term> terms = left.hand;
    for (const Term& t : left.generated) terms.push_back({-t.coef, t.e});
    const Expr difference = sum_of(terms, *hand->pool);
    if (text(difference).size() < text(shortest).size()) shortest = difference;
  }
  return shortest;
}

std::vector<Expr> free_symbols(Expr e) {
  std::vector<Expr> free;
  for (const Expr node : topological(std::span(&e, 1))) {
    if (node->kind == Kind::symbol && node->role == Role::given) free.push_back(node);
  }
  return free;
}

}  // namespace cdot::derive
