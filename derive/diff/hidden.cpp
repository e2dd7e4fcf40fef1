// Searches for a condition that an author had in mind and did not write down.
#include <fmt/format.h>

#include "derive/diff/terms.hpp"
#include "derive/diff/words.hpp"

namespace cdot::derive {
namespace {

struct Condition {
  std::string words;
  std::vector<Expr> equations;
  bool aligned = false;  // looked for from poses in which all bodies are turned almost alike
};

// The likely ones first: unit ratios, zero angles or lengths; bodies whose frame is the world's; vectors that are zero,
// equal, parallel or orthogonal.
std::vector<Condition> likely_conditions(const Joint& joint) {
  std::vector<Condition> all;
  for (const Parameter& p : joint.parameters) {
    if (p.kind != ParameterKind::scalar) continue;
    for (const int value : p.unit == Unit{} ? std::vector{1, -1} : std::vector{0}) {
      const bool in_range = (value > p.above || (p.from && value == p.above)) && value < p.below;
      if (!in_range) continue;
      all.push_back({fmt::format("{} = {}", p.name, value), {p.symbol - joint.pool->number(value)}});
    }
  }
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    const BodySymbols body = body_symbols(joint, static_cast<int>(b));
    if (body.theta) all.push_back({fmt::format("angle({}) = 0", joint.bodies[b]), {body.theta}});
  }
  std::vector<std::pair<std::string, Expr>> vectors;
  for (const Let& let : joint.lets) {
    if (let.value->vector) vectors.emplace_back(let.name, let.value);
  }
  for (const Parameter& p : joint.parameters) {
    if (p.symbol && p.symbol->vector) vectors.emplace_back(p.symbol->symbol, p.symbol);
  }
  for (const auto& [name, v] : vectors) {
    if (!v->unit_length) all.push_back({name + " = 0", components_of(v)});
  }
  std::vector<Condition> products;
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    for (std::size_t j = i + 1; j < vectors.size(); ++j) {
      const auto& [name, u] = vectors[i];
      const auto& [other, v] = vectors[j];
      if (u->unit_length && v->unit_length) all.push_back({name + " = " + other, components_of(u - v), true});
      for (const Expr product : {cross(u, v), dot(u, v)}) {
        if (product->kind != Kind::number && !is_zero(product))
          products.push_back({text(product) + " = 0", components_of(product)});
      }
    }
  }
  all.insert(all.end(), products.begin(), products.end());
  return all;
}

// The quantity of the joint that a free symbol stands for, if that makes both sides equal.
std::string meaning_of_symbols(const Joint& joint, Expr hand, Expr generated, const Poses& poses) {
  for (const Expr symbol : free_symbols(hand)) {
    for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
      const Expr w = body_symbols(joint, static_cast<int>(b)).w;
      if (w->vector) continue;
      const Expr meant = substitute(hand, {{&*symbol, w}}, KeepNames::no);
      if (poses.equal(meant, generated)) return fmt::format("{} = {}", symbol->symbol, w->symbol);
    }
  }
  return "";
}

}  // namespace

std::string hidden_assumption(const Joint& joint, const Poses& on_constraint, Expr hand, Expr generated,
                              const Poses& poses) {
  if (!free_symbols(hand).empty()) return meaning_of_symbols(joint, hand, generated, poses);
  const Expr zero = joint.pool->number(0);
  // Both sides are equal there, but not merely both zero, as by a common factor C.
  const auto equal_and_needed = [&](const Poses& there) {
    return there.equal(hand, generated) && (!there.equal(generated, zero) || poses.equal(generated, zero));
  };
  // C = 0: there a term may be omitted if it vanishes.
  if (on_constraint.equal(hand, generated) && (poses.equal(hand, zero) || equal_and_needed(on_constraint)))
    return "C = 0";
  for (const Condition& condition : likely_conditions(joint)) {
    // Most conditions fail at the first poses.
    if (!poses.first(2).where(condition.equations).equal(hand, generated)) continue;
    const Poses start = condition.aligned ? poses.aligned() : poses;
    if (equal_and_needed(start.where(condition.equations))) return condition.words;
  }
  return "";
}

}  // namespace cdot::derive
