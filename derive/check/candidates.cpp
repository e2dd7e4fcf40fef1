// Quantities with short names that may vanish where K is singular.
#include <algorithm>

#include "derive/check/mass.hpp"
#include "derive/expression/shared.hpp"
#include "derive/proof/words.hpp"

namespace cdot::derive {
namespace {

constexpr std::size_t most_vectors = 12, longest_name = 60, most_candidates = 60;
// A text has about a letter per node at least; that of a large expression is not even written to be measured.
constexpr double most_nodes = 3 * longest_name;

// A component along an axis of the world means nothing to a joint.
bool of_world(Expr e) {
  return is_world_axis(e) || (e->kind == Kind::cross && std::ranges::any_of(e->args, is_world_axis));
}

class Candidates {
 public:
  explicit Candidates(const Subject& subject) : joint_(subject.joint), rows_(subject.block.rows) {
    std::vector<Expr> entries;
    for (const ScalarRow& row : subject.block.rows) {
      for (const JacobianEntry& entry : row.J) entries.insert(entries.end(), {entry.w, entry.v});
    }
    for (const Expr e : leaves_of(entries)) {
      if (e->role == Role::parameter && !e->vector) add(e);
    }
    for (const Expr e : entries) {
      if (!e->vector || joint_.dimension == 3) add(e);
    }
    for (const Expr e : topological(entries)) {
      if (!e->vector || e->role == Role::position || e->kind == Kind::perp) continue;
      if (e->kind != Kind::scale && !is_zero(e) && vectors_.size() <= most_vectors && !of_world(e)) add_vector(e);
    }
    for (std::size_t i = 0; i < vectors_.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k) {
        add(cross(vectors_[k], vectors_[i]));
        add(dot(vectors_[k], vectors_[i]));
      }
    }
    std::ranges::stable_sort(all_, {}, [&](const Candidate& c) { return std::pair(by_gradients(c.e), c.name.size()); });
    if (all_.size() > most_candidates) all_.resize(most_candidates);
    for (Candidate& candidate : all_) candidate.explained = gradients_in(candidate.e);
  }

  std::vector<Candidate> all() { return std::move(all_); }

 private:
  // Factors of a product vanish one by one; a length vanishes with its vector.
  void add(Expr e) {
    e = split_coefficient(e).e;
    if (e->kind == Kind::product && e->name.empty()) {
      for (std::size_t i = 0; i < e->args.size(); ++i)
        if (e->exponents[i] > 0) add(e->args[i]);
      return;
    }
    if (e->kind == Kind::scale && e->name.empty()) return add(e->args[0]), add(e->args[1]);
    if (e->kind == Kind::norm) return add(e->args[0]);
    if (e->kind == Kind::number || e->unit_length || is_zero(e)) return;
    if (written_size(e, [](Expr part) { return !part->name.empty(); }) > most_nodes) return;
    if (!e->vector) e = with_leading_sign(e);
    std::string name = spec_text(e, joint_);
    if (name.starts_with('-') && e->kind != Kind::sum) name = spec_text(e = -e, joint_);  // both vanish together
    const auto same = [&](const Candidate& c) { return c.e == e || c.name == name; };
    if (name.size() <= longest_name && std::ranges::none_of(all_, same)) all_.push_back({e, name});
  }

  // No spec has the names of gradients and axes, so they come last.
  bool by_gradients(Expr e) const {
    const std::vector<Expr> parts = topological(std::span(&e, 1));
    return std::ranges::any_of(rows_, [&](const ScalarRow& row) {
      return std::ranges::find_first_of(parts, row.gradients) != parts.end() ||
             std::ranges::find_first_of(parts, row.axes) != parts.end();
    });
  }

  std::string gradients_in(Expr e) const {
    std::string words;
    const auto add = [&](Expr n, const std::string& meaning) {
      if (shows(e, n)) words += (words.empty() ? "" : ", ") + n->name + meaning;
    };
    for (const ScalarRow& row : rows_) {
      for (const Expr n : row.gradients) add(n, " the gradient of " + row.name);
      for (const Expr axis : row.axes) add(axis, " the axis of " + row.name);
    }
    return words.empty() ? "" : " (" + words + ")";
  }

  // True if the text of e contains this part by its name.
  static bool shows(Expr e, Expr part) {
    return e == part || (e->name.empty() && std::ranges::any_of(e->args, [&](Expr arg) { return shows(arg, part); }));
  }

  // An axis brings the other axes of its frame, which are orthogonal to it.
  void add_vector(Expr e) {
    const Pool::Axis axis = joint_.pool->axis_of(e);
    for (const Expr v : axis.triad ? std::vector<Expr>(axis.triad->begin(), axis.triad->end()) : std::vector<Expr>{e}) {
      if (std::ranges::find(vectors_, v) != vectors_.end()) continue;
      vectors_.push_back(v);
      add(v);
    }
  }

  const Joint& joint_;
  const std::vector<ScalarRow>& rows_;
  std::vector<Expr> vectors_;
  std::vector<Candidate> all_;
};

}  // namespace

std::vector<Candidate> candidates_for_zero(const Subject& subject) { return Candidates(subject).all(); }

}  // namespace cdot::derive
