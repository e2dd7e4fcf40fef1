// The results of a derivation for the head of a generated file: names, C, J and K, as the lecture writes them.
#include <algorithm>

#include "derive/explain/lecture.hpp"

namespace cdot::derive {
namespace {

Chain equation(Formula left, Formula right, std::string note = {}) {
  return {std::move(left), {{std::move(right), std::move(note)}}};
}

std::string note_of(RowKind kind) {
  switch (kind) {
    case RowKind::equality: return "";
    case RowKind::inequality: return "C >= 0 must hold, lambda >= 0";
    case RowKind::velocity: return "at velocity level: C is 0";
  }
  return "";
}

bool has_skew(const Formula& f) {
  return f.shape == Shape::skew || std::any_of(f.args.begin(), f.args.end(), has_skew);
}

std::string columns_text(const Joint& joint) {
  std::string words = "columns ";
  for (const std::string& b : joint.bodies) {
    words += (b == joint.bodies[0] ? "v_" : " | v_") + b + " | w_" + b;
  }
  return words;
}

Chain meaning_of_S(int dimension) {
  const bool plane = dimension == 2;
  return equation(leaf({}, plane ? "S(r)" : "S(r) u"), leaf({}, plane ? "perp(r)" : "r × u"));
}

std::vector<Chain> summarise(const Lecture& lecture, const Part& part) {
  std::vector<Chain> summary;
  std::vector<Formula> J;
  for (const Statement& s : part.statements) {
    const bool velocity = s.kind == RowKind::velocity;
    const Formula left =
        part.block.name.empty() ? label(velocity ? "Cdot" : "C", s, s.C) : leaf(s.C, "coordinate " + s.name);
    summary.push_back(equation(left, lecture.notation.definition(s.C), note_of(s.kind)));
    const ScalarRow& first = part.block.rows[s.first];
    for (const std::vector<Expr>* names : {&first.gradients, &first.axes}) {
      for (const Expr n : *names) summary.push_back(equation(leaf(n), lecture.notation.definition(n)));
    }
    const Formula row = row_of_J(s);
    J.insert(J.end(), row.args.begin(), row.args.end());
  }
  if (part.statements.empty()) return summary;
  const int width = static_cast<int>(2 * lecture.joint.bodies.size());
  const bool single = part.statements.size() == 1;
  const Formula all = matrix(width, std::move(J));
  summary.push_back(
      equation(single ? label("J", part.statements[0]) : leaf({}, "J"), all, columns_text(lecture.joint)));
  if (has_skew(all)) summary.push_back(meaning_of_S(lecture.joint.dimension));
  summarise_mass(lecture, part, summary);
  return summary;
}

}  // namespace

std::vector<std::vector<Chain>> summarise(const Derivation& derivation) {
  const Lecture lecture(derivation);
  std::vector<std::vector<Chain>> all = {summarise(lecture, rows_part(lecture, derivation.rows))};
  std::vector<Chain> names;
  for (const Let& let : derivation.joint.lets) {
    names.push_back(equation(leaf(let.value, let.name), lecture.notation.definition(let.value)));
  }
  for (Chain& chain : law_chains(lecture)) all[0].push_back(std::move(chain));
  for (const Block& block : derivation.coordinates) all.push_back(summarise(lecture, coordinate_part(lecture, block)));
  std::vector<Chain> shown = names;
  for (const std::vector<Chain>& chains : all) shown.insert(shown.end(), chains.begin(), chains.end());
  for (Chain& chain : shared_in(lecture, shown)) names.push_back(std::move(chain));
  all[0].insert(all[0].begin(), names.begin(), names.end());
  return all;
}

}  // namespace cdot::derive
