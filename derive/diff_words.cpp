#include "derive/diff_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace cdot::derive {
namespace {

// e as a sum of products: dot, cross, products and squares are distributed over sums that have no name.
class Expansion {
 public:
  Expr of(Expr e) {
    if (!e->name.empty() && !at_root_) return e;
    at_root_ = false;
    switch (e->kind) {
      case Kind::sum: {
        std::vector<Term> terms;
        for (std::size_t i = 0; i < e->args.size(); ++i) terms.push_back({e->coefs[i], of(e->args[i])});
        return sum(*e->pool, terms, e->vector);
      }
      case Kind::dot: return bilinear(e, [](Expr u, Expr v) { return dot(u, v); });
      case Kind::cross: return bilinear(e, [](Expr u, Expr v) { return cross(u, v); });
      case Kind::product: return product_of_sums(e);
      default: return e;
    }
  }

 private:
  template <class Operator>
  Expr bilinear(Expr e, Operator op) {
    Expr total = e->pool->number(0);
    for (const Term& u : terms_of(of(e->args[0]))) {
      for (const Term& v : terms_of(of(e->args[1]))) total = total + (u.coef * v.coef) * op(u.e, v.e);
    }
    return total;
  }

  Expr product_of_sums(Expr e) {
    std::vector<Term> terms = {{Rational(1), e->pool->number(1)}};
    for (std::size_t i = 0; i < e->args.size(); ++i) {
      const bool expands = e->exponents[i] > 0 && e->exponents[i] <= 2;
      const Expr factor = expands ? of(e->args[i]) : pow(e->args[i], e->exponents[i]);
      for (int k = 0; k < (expands ? e->exponents[i] : 1); ++k) {
        std::vector<Term> next;
        for (const Term& t : terms) {
          for (const Term& f : terms_of(factor)) next.push_back({t.coef * f.coef, t.e * f.e});
        }
        terms = std::move(next);
      }
    }
    return sum(*e->pool, terms, false);
  }

  bool at_root_ = true;
};

Expr expanded(Expr e) { return e->vector ? e : Expansion().of(e); }

// The terms of a that b lacks; each with its coefficient.
std::vector<Term> terms_without(Expr a, Expr b) {
  const std::vector<Term> left = terms_of(expanded(a)), right = terms_of(expanded(b));
  std::vector<Term> only;
  for (const Term& t : left) {
    if (is_zero(t.e) || t.coef.is_zero()) continue;
    const bool found = std::any_of(right.begin(), right.end(), [&](const Term& u) {
      return u.e == t.e && u.coef == t.coef;
    });
    if (!found) only.push_back(t);
  }
  return only;
}

Expr sum_of(const std::vector<Term>& terms, Pool& pool) { return collected(sum(pool, terms, false)); }

std::string place_name(const Place& place) {
  std::string s = place.what;
  if (!place.row.empty()) s += ", row " + place.row;
  if (!place.column.empty()) s += ", " + place.column;
  return s;
}

std::string where_from(const Contribution& source, const Joint& joint) {
  const std::string body = source.leaf->body >= 0 ? joint.bodies[static_cast<std::size_t>(source.leaf->body)] : "?";
  const std::string& s = source.leaf->symbol;
  if (source.leaf->role == Role::body_vector) {
    return fmt::format("{0} turns with {1} (d{0}/dt = w_{1} x {0}), so the product rule has a term for it", s, body);
  }
  return fmt::format("{} moves with {}", s, body);
}

// The expression in which body-dependent symbols of one class belong to another body: inverse masses, or arms.
std::vector<Expr> with_bodies_swapped(Expr e, const Joint& joint) {
  std::vector<Expr> swapped;
  if (joint.bodies.size() < 2) return swapped;
  const BodySymbols a = body_symbols(joint, 0), b = body_symbols(joint, 1);
  for (const auto& [x, y] : {std::pair{a.inv_m, b.inv_m}, {a.inv_I, b.inv_I}, {a.w, b.w}, {a.v, b.v}}) {
    for (const auto& map : {std::map<const Node*, Expr>{{&*x, y}}, std::map<const Node*, Expr>{{&*y, x}},
                            std::map<const Node*, Expr>{{&*x, y}, {&*y, x}}}) {
      swapped.push_back(substitute(e, map, KeepNames::no));
    }
  }
  std::vector<Expr> arms;
  for (const Parameter& p : joint.parameters) {
    if (p.kind == ParameterKind::point && p.body >= 0) arms.push_back(p.symbol);
  }
  for (const Expr from : arms) {
    for (const Expr to : arms) {
      if (from != to) swapped.push_back(substitute(e, {{&*from, to}}, KeepNames::no));
    }
  }
  return swapped;
}

struct Explained {
  std::string kind, sentence;
};

std::optional<Explained> whole_entry(const Place& place, Expr hand, Expr generated, const Poses& poses) {
  if (poses.equal(hand, -generated)) return Explained{"sign", "the sign is wrong"};
  for (const Expr other : place.elsewhere) {
    if (is_zero(other)) continue;
    if (poses.equal(hand, other) || poses.equal(hand, -other)) {
      return Explained{"wrong body", "this is what belongs to another body's column"};
    }
  }
  if (is_zero(expanded(hand))) return Explained{"missing term", "nothing stands here"};
  if (is_zero(expanded(generated))) return Explained{"extra term", "nothing belongs here"};
  if (const std::optional<double> k = poses.constant_ratio(hand, generated)) {
    return Explained{"factor", fmt::format("it is {:.6g} times what it should be", *k)};
  }
  for (const Expr swapped : with_bodies_swapped(hand, *place.joint)) {
    if (poses.equal(swapped, generated)) {
      return Explained{"wrong body", "a quantity of one body stands where the other's belongs"};
    }
  }
  return std::nullopt;
}

// The difference as what one moving leaf contributes to this entry, or twice that.
std::optional<Explained> single_source(const Place& place, Expr difference, const Poses& poses) {
  for (const Contribution& source : place.sources) {
    if (is_zero(source.term)) continue;
    const std::string term = text(source.term), why = where_from(source, *place.joint);
    if (poses.equal(difference, -source.term)) {
      return Explained{"missing term", fmt::format("the hand derivation lacks {}: {}", term, why)};
    }
    if (poses.equal(difference, Rational(-2) * source.term)) {
      return Explained{"sign", fmt::format("the term {} has the wrong sign: {}", term, why)};
    }
    if (poses.equal(difference, source.term)) {
      return Explained{"extra term", fmt::format("{} is counted twice: {}", term, why)};
    }
  }
  return std::nullopt;
}

Explained by_terms(const Place& place, Expr hand, Expr generated, const Poses& poses) {
  Pool& pool = *hand->pool;
  const Expr lacks = sum_of(terms_without(generated, hand), pool);
  const Expr has = sum_of(terms_without(hand, generated), pool);
  if (is_zero(has)) return {"missing term", fmt::format("the hand derivation lacks {}", text(lacks))};
  if (is_zero(lacks)) return {"extra term", fmt::format("{} does not belong here", text(has))};
  if (poses.equal(has, -lacks)) {
    return {"sign", fmt::format("it has {} where {} belongs", text(has), text(lacks))};
  }
  const std::vector<Expr> swapped = with_bodies_swapped(has, *place.joint);
  const bool wrong_body = std::any_of(swapped.begin(), swapped.end(),
                                      [&](Expr e) { return poses.equal(e, lacks); });
  return {wrong_body ? "wrong body" : "factor",
          fmt::format("it has {} where {} belongs", text(has), text(lacks))};
}

}  // namespace

Expr difference_of(Expr hand, Expr generated) {
  const Expr plain = hand - generated;
  const Expr shorter = collected(expanded(plain));
  return text(shorter).size() <= text(plain).size() ? shorter : plain;
}

Difference describe_difference(const Place& place, Expr hand, Expr generated, const Poses& poses) {
  Difference d;
  d.what = place.what;
  d.row = place.row;
  d.column = place.column;
  d.generated = text(generated);
  d.hand = text(hand);
  const Expr difference = difference_of(hand, generated);
  d.difference = text(difference);
  std::optional<Explained> explained = whole_entry(place, hand, generated, poses);
  if (!explained) explained = single_source(place, difference, poses);
  if (!explained) explained = by_terms(place, hand, generated, poses);
  d.kind = explained->kind;
  d.sentence = fmt::format("{}: {}", place_name(place), explained->sentence);
  return d;
}

std::string hidden_assumption(const Joint& joint, const std::vector<Expr>& constraints, Expr hand,
                              Expr generated, const Poses& poses) {
  Pool& pool = *joint.pool;
  const Expr ex = world_x(pool);
  const auto holds = [&](const std::vector<Expr>& equations) {
    // Most candidates fail at the first poses.
    return poses.first(2).where(equations).equal(hand, generated) &&
           poses.where(equations).equal(hand, generated);
  };
  if (!constraints.empty() && holds(constraints)) return "C = 0";
  for (const Parameter& p : joint.parameters) {
    if (p.kind != ParameterKind::scalar) continue;
    for (const int value : {1, -1, 0}) {
      if (holds({p.symbol - pool.number(value)})) return fmt::format("{} = {}", p.name, value);
    }
  }
  std::vector<std::pair<std::string, Expr>> vectors;
  for (const Let& let : joint.lets) {
    if (let.value->vector) vectors.emplace_back(let.name, let.value);
  }
  for (const Parameter& p : joint.parameters) {
    if (p.symbol && p.symbol->vector) vectors.emplace_back(p.symbol->symbol, p.symbol);
  }
  for (const auto& [name, v] : vectors) {
    if (!v->unit_length && holds({dot(ex, v), dot(perp(ex), v)})) return fmt::format("{} = 0", name);
  }
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    for (std::size_t j = i + 1; j < vectors.size(); ++j) {
      for (const Expr product : {cross(vectors[i].second, vectors[j].second),
                                 dot(vectors[i].second, vectors[j].second)}) {
        if (product->kind != Kind::number && holds({product})) return text(product) + " = 0";
      }
    }
  }
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    const BodySymbols body = body_symbols(joint, static_cast<int>(b));
    if (holds({body.theta})) return fmt::format("angle({}) = 0", joint.bodies[b]);
  }
  return "";
}

}  // namespace cdot::derive
