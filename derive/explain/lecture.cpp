// Grouping scalar rows into the author's statements, and the names of what is derived from them.
#include "derive/explain/lecture.hpp"

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
