// Grouping scalar rows into the author's statements, and the names of what is derived from them.
#include "derive/explain/lecture.hpp"

#include <set>
#include <utility>

namespace cdot::derive {
namespace {

// The terms of a vector Cdot without velocities: dC/dt with all bodies at rest.
Expr at_rest(Expr Cdot) {
  std::vector<Term> terms;
  for (const Term& term : terms_of(Cdot)) {
    if (!depends_on_velocity(term.e)) terms.push_back(term);
  }
  return sum(*Cdot->pool, terms, true);
}

// A vector as a row; a number is one already.
Formula row_of(const Notation& notation, Expr e) {
  if (is_zero(e)) return number(0);
  if (!e->vector) return notation.of(e);
  const Term term = split_coefficient(e);
  const bool scaled = term.e->kind == Kind::scale && !Notation::has_name(term.e);
  if (!scaled) return shaped(Shape::transpose, notation.of(e));
  Formula row = times(abs(term.coef),
                      product({notation.of(term.e->args[0]), shaped(Shape::transpose, notation.of(term.e->args[1]))}));
  return term.coef.sign() < 0 ? negative(std::move(row)) : row;
}

Statement scalar_statement(const Notation& notation, const ScalarRow& row, std::size_t index) {
  Statement s{row.name, row.row,  row.kind, row.kind == RowKind::velocity ? row.Cdot : row.C,
              index,    row.Cdot, row.C_t,  {}};
  for (const JacobianEntry& entry : row.J) s.J.push_back({row_of(notation, entry.v), row_of(notation, entry.w)});
  return s;
}

}  // namespace

Lecture::Lecture(const Derivation& derivation)
    : joint(derivation.joint), notation(derivation.joint), rates(derivation.joint, notation) {
  std::vector<Expr> all;
  const auto add = [&](const Block& block) {
    for (const ScalarRow& row : block.rows) {
      all.insert(all.end(), {row.C, row.Cdot, row.C_t, row.gamma});
      for (const JacobianEntry& entry : row.J) all.insert(all.end(), {entry.v, entry.w});
    }
    for (const auto& K : block.K) all.insert(all.end(), K.begin(), K.end());
  };
  add(derivation.rows);
  for (const Block& block : derivation.coordinates) add(block);
  notation.share(all);
}

namespace {

// The leaves of f, in order.
void collect_leaves(const Formula& f, std::vector<Expr>& leaves) {
  if (f.shape == Shape::leaf && f.leaf) leaves.push_back(f.leaf);
  for (const Formula& arg : f.args) collect_leaves(arg, leaves);
}

class Introduction {
 public:
  explicit Introduction(const Notation& notation) : notation_(notation) {}

  // Definitions of names in f that have not been given, each after those that it needs.
  void introduce(const Formula& f, std::vector<Chain>& chains) {
    std::vector<Expr> leaves;
    collect_leaves(f, leaves);
    for (const Expr e : leaves) {
      const std::string name = notation_.shared_name(e);
      if (name.empty() || !introduced_.insert(name).second) continue;
      Formula definition = notation_.definition(e);
      introduce(definition, chains);
      chains.push_back({leaf(e, name), {{std::move(definition), ""}}});
    }
  }

 private:
  const Notation& notation_;
  std::set<std::string> introduced_;
};

}  // namespace

void introduce_shared(Lecture& lecture) {
  Introduction introduction(lecture.notation);
  if (lecture.notation.shared().empty()) return;
  for (Step& step : lecture.out.steps) {
    std::vector<Chain> chains;
    for (const Item& item : step.items) {
      for (const Formula& f : item.words.formulas) introduction.introduce(f, chains);
      introduction.introduce(item.chain.left, chains);
      for (const Link& link : item.chain.links) introduction.introduce(link.formula, chains);
    }
    if (chains.empty()) continue;
    Step whole{step.heading, {}};
    whole.say("Names for what recurs:");
    for (Chain& chain : chains) whole.show(std::move(chain));
    whole.items.insert(whole.items.end(), step.items.begin(), step.items.end());
    step = std::move(whole);
  }
}

std::vector<Chain> shared_in(const Lecture& lecture, const std::vector<Chain>& shown) {
  Introduction introduction(lecture.notation);
  std::vector<Chain> chains;
  for (const Chain& chain : shown) {
    introduction.introduce(chain.left, chains);
    for (const Link& link : chain.links) introduction.introduce(link.formula, chains);
  }
  return chains;
}

Step& Lecture::section(std::string heading) {
  out.steps.push_back({std::move(heading), {}});
  return out.steps.back();
}

Part rows_part(const Lecture& lecture, const Block& block) {
  const Joint& joint = lecture.joint;
  const std::vector<ScalarRow>& rows = block.rows;
  Part part{block, {}};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& row = *rows[i].row;
    const bool vector = row.C->vector;
    const Expr Cdot = row.kind == RowKind::velocity ? row.C : time_derivative(row.C, joint);
    const auto entries = vector ? isolate_vector(Cdot, joint, lecture.notation) : std::nullopt;
    if (!entries) {
      part.statements.push_back(scalar_statement(lecture.notation, rows[i], i));
      continue;
    }
    part.statements.push_back({row.name, &row, row.kind, row.C, i, Cdot, at_rest(Cdot), *entries});
    i += static_cast<std::size_t>(joint.dimension) - 1;  // its other components
  }
  if (part.statements.size() == 1) part.statements[0].name.clear();
  return part;
}

Part coordinate_part(const Lecture& lecture, const Block& coordinate) {
  return {coordinate, {scalar_statement(lecture.notation, coordinate.rows[0], 0)}};
}

Formula label(const std::string& letter, const Statement& statement, Expr e) {
  const bool coordinate = statement.row == nullptr;
  if (coordinate && letter == "C") return leaf(e, statement.name);
  if (coordinate && letter == "Cdot") return leaf(e, statement.name + "_dot");
  const std::string& name = statement.name;
  // A row without a name of its own is called C1: its J is J_1.
  const bool numbered = name.size() > 1 && name[0] == 'C' && name[1] >= '0' && name[1] <= '9';
  return leaf(e, name.empty() ? letter : letter + "_" + (numbered ? name.substr(1) : name));
}

}  // namespace cdot::derive
