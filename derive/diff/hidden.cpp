// Searches for a condition that an author had in mind and did not write down.
#include <fmt/format.h>

#include "derive/diff/terms.hpp"
#include "derive/diff/words.hpp"

namespace cdot::derive {
namespace {

class Search {
 public:
  Search(const Joint& joint, Expr hand, Expr generated, const Poses& poses)
      : joint_(joint),
        pool_(*joint.pool),
        hand_(hand),
        generated_(generated),
        zero_(joint.pool->number(0)),
        poses_(poses) {}

  // Equal there, and not just zero both, as a factor C of both sides would make them.
  bool holds(const std::vector<Expr>& equations) const { return holds(equations, poses_); }
  bool holds(const std::vector<Expr>& equations, const Poses& poses) const {
    // Most candidates fail at the first poses.
    if (!poses.first(2).where(equations).equal(hand_, generated_)) return false;
    return equal_and_needed(poses.where(equations));
  }
  // Where C = 0; there nothing may stand, because nothing is needed.
  bool holds_on_constraint(const Poses& there) const {
    if (there.empty() || !there.equal(hand_, generated_)) return false;
    return poses_.equal(hand_, zero_) || equal_and_needed(there);
  }

  // A free symbol that stands for a quantity of the joint.
  std::string meaning_of_symbols(const std::vector<Expr>& free) const {
    for (const Expr symbol : free) {
      for (std::size_t b = 0; b < joint_.bodies.size(); ++b) {
        const Expr w = body_symbols(joint_, static_cast<int>(b)).w;
        if (w->vector) continue;
        const Expr meant = substitute(hand_, {{&*symbol, w}}, KeepNames::no);
        if (poses_.equal(meant, generated_)) return fmt::format("{} = {}", symbol->symbol, w->symbol);
      }
    }
    return "";
  }

  // Ratios of one, and angles or ways of zero.
  std::string of_scalars() const {
    for (const Parameter& p : joint_.parameters) {
      if (p.kind != ParameterKind::scalar) continue;
      const std::vector<int> values = p.unit == Unit{} ? std::vector{1, -1} : std::vector{0};
      for (const int value : values) {
        if (holds({p.symbol - pool_.number(value)})) return fmt::format("{} = {}", p.name, value);
      }
    }
    return "";
  }

  // Bodies that have not turned: their frame is the world's.
  std::string of_orientations() const {
    for (std::size_t b = 0; b < joint_.bodies.size(); ++b) {
      const BodySymbols body = body_symbols(joint_, static_cast<int>(b));
      if (body.theta && holds({body.theta})) return fmt::format("angle({}) = 0", joint_.bodies[b]);
    }
    return "";
  }

  std::string of_vectors() const {
    std::vector<std::pair<std::string, Expr>> vectors;
    for (const Let& let : joint_.lets) {
      if (let.value->vector) vectors.emplace_back(let.name, let.value);
    }
    for (const Parameter& p : joint_.parameters) {
      if (p.symbol && p.symbol->vector) vectors.emplace_back(p.symbol->symbol, p.symbol);
    }
    for (const auto& [name, v] : vectors) {
      if (!v->unit_length && holds(components_of(v))) return fmt::format("{} = 0", name);
    }
    for (std::size_t i = 0; i < vectors.size(); ++i) {
      for (std::size_t j = i + 1; j < vectors.size(); ++j) {
        const Expr u = vectors[i].second, v = vectors[j].second;
        const bool directions = u->unit_length && v->unit_length;
        if (directions && holds(components_of(u - v), poses_.aligned())) {
          return fmt::format("{} = {}", vectors[i].first, vectors[j].first);
        }
      }
    }
    for (std::size_t i = 0; i < vectors.size(); ++i) {
      for (std::size_t j = i + 1; j < vectors.size(); ++j) {
        for (const Expr product :
             {cross(vectors[i].second, vectors[j].second), dot(vectors[i].second, vectors[j].second)}) {
          if (product->kind != Kind::number && !is_zero(product) && holds(components_of(product))) {
            return text(product) + " = 0";
          }
        }
      }
    }
    return "";
  }

 private:
  bool equal_and_needed(const Poses& there) const {
    return there.equal(hand_, generated_) && (!there.equal(generated_, zero_) || poses_.equal(generated_, zero_));
  }

  const Joint& joint_;
  Pool& pool_;
  Expr hand_, generated_, zero_;
  const Poses& poses_;
};

}  // namespace

std::string hidden_assumption(const Joint& joint, const Poses& on_constraint, Expr hand, Expr generated,
                              const Poses& poses) {
  const Search search(joint, hand, generated, poses);
  // Where a symbol stands for anything, the two are equal only by chance or if it means something.
  const std::vector<Expr> free = free_symbols(hand);
  if (!free.empty()) return search.meaning_of_symbols(free);
  if (search.holds_on_constraint(on_constraint)) return "C = 0";
  std::string condition = search.of_scalars();
  if (condition.empty()) condition = search.of_orientations();
  if (condition.empty()) condition = search.of_vectors();
  return condition;
}

}  // namespace cdot::derive
