// Reads and derives an entry, draws its poses, and combines the verdicts on its items.
#include "derive/diff/entry.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

#include "derive/diff/terms.hpp"
#include "derive/expression/symbols.hpp"
#include "derive/numbers/modular.hpp"

namespace cdot::derive {
namespace {

Matrix column(std::vector<Expr> entries) { return {static_cast<int>(entries.size()), 1, std::move(entries)}; }

std::vector<Expr> lower_triangle(const Matrix& m) {
  std::vector<Expr> entries;
  for (int i = 0; i < m.rows; ++i) {
    for (int j = 0; j <= i; ++j) entries.push_back(m.at(i, j));
  }
  return entries;
}

bool is_coordinate(const std::vector<ScalarRow>& rows) { return rows.size() == 1 && rows[0].row == nullptr; }

std::vector<ScalarRow> rows_named(const Entry& entry, const std::vector<std::string>& names) {
  if (names.empty()) return entry.block.rows;
  std::vector<ScalarRow> rows;
  for (const std::string& name : names) {
    for (const ScalarRow& row : entry.block.rows) {
      if (row.name == name || is_named(*row.row, name)) rows.push_back(row);
    }
    for (const Block& coordinate : entry.coordinates) {
      if (coordinate.name == name) rows.push_back(coordinate.rows[0]);
    }
  }
  return rows;
}

Generated generated_for(const Entry& entry, const std::vector<ScalarRow>& rows) {
  const int n = static_cast<int>(rows.size());
  Generated g;
  std::vector<Expr> C, Cdot;
  g.J = {n, entry.width() * static_cast<int>(entry.joint.bodies.size()), {}};
  for (const ScalarRow& row : rows) {
    C.push_back(row.C);
    Cdot.push_back(row.Cdot);
    for (const Expr e : entry.columns_in_form(row.J)) g.J.entries.push_back(e);
  }
  g.C = column(std::move(C));
  g.Cdot = column(std::move(Cdot));
  const auto triangle = effective_mass(entry.joint, rows, entry.immovable);
  g.K = {n, n, {}};
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      g.K.entries.push_back(
          triangle[static_cast<std::size_t>(std::max(i, j))][static_cast<std::size_t>(std::min(i, j))]);
    }
  }
  return g;
}

// Every scalar equation that the entry assumes.
std::vector<Expr> assumed_equations(const Entry& entry) {
  std::vector<Expr> equations;
  for (const HandAssumption& a : entry.hand.assumptions) {
    if (!a.left || !a.right) continue;
    const std::vector<Expr>&left = a.left->entries, &right = a.right->entries;
    const bool zero = right.size() == 1 && is_zero(right[0]);  // fits a vector, too
    if (!zero && left.size() != right.size()) continue;
    for (std::size_t i = 0; i < left.size(); ++i) {
      const Expr equation = left[i] - right[zero ? 0 : i];
      if (!is_zero(equation)) equations.push_back(equation);
    }
  }
  return equations;
}

void prepare_poses(Entry& entry, const std::vector<Part>& parts) {
  std::vector<Expr> all = assumed_equations(entry);
  const std::vector<Expr> equations = all;
  const auto take = [&](const Matrix& m) { all.insert(all.end(), m.entries.begin(), m.entries.end()); };
  for (const Part& part : parts) {
    const Generated& g = part.generated;
    for (const Matrix& m : {g.C, g.Cdot, g.J, g.K}) take(m);
    for (const HandItem& item : part.hand->items) {
      if (item.value) take(*item.value);
      if (item.right) take(*item.right);
      for (const HandReading& reading : item.readings) take(reading.value);
    }
  }
  // Expressions that hidden assumptions and finite differences may need.
  const auto take_any = [&](Expr e) {
    for (const Expr component : components_of(e)) all.push_back(component);
  };
  for (std::size_t b = 0; b < entry.joint.bodies.size(); ++b) {
    const BodySymbols body = body_symbols(entry.joint, static_cast<int>(b));
    all.insert(all.end(), {body.inv_m, body.inv_I});
  }
  for (const Parameter& p : entry.joint.parameters) take_any(p.symbol);
  for (const Let& let : entry.joint.lets) take_any(let.value);
  for (const ScalarRow& row : entry.block.rows) take_any(row.C), take_any(row.Cdot);
  if (entry.law)
    for (const Expr e : expressions_of_law(entry)) take_any(e);
  entry.anywhere.emplace(entry.joint, all);
  if (equations.empty()) return;
  // An equation of the spec itself means C = 0 as the joint is assembled.
  const bool is_C = std::ranges::any_of(equations, [&](Expr equation) {
    return std::ranges::any_of(entry.block.rows, [&](const ScalarRow& row) {
      return !is_zero(row.C) && (entry.anywhere->equal(equation, row.C) || entry.anywhere->equal(equation, -row.C));
    });
  });
  entry.assumed = (is_C ? entry.anywhere->aligned() : *entry.anywhere).where(equations);
  if (entry.assumed->empty()) {
    entry.verdict.remarks.push_back("no pose satisfies the assumptions; they are ignored");
    entry.assumed.reset();
  }
}

void take_order(Entry& entry, Part& part) {
  std::vector<ScalarRow> rows = rows_in_order_of(entry, part);
  if (rows.empty()) return;
  std::string names;
  for (const ScalarRow& row : rows) names += (names.empty() ? "`" : ", `") + row.name + "`";
  entry.verdict.remarks.push_back("its rows stand in the order " + names);
  part.rows = std::move(rows);
  part.generated = generated_for(entry, part.rows);
}

// The scope of an entry, if it is not all rows of the spec as written: " of pin", " with t on a".
std::string scope_of(const Entry& entry, const Part& part) {
  std::string scope;
  const auto append = [&](const char* first, const char* further, const std::string& what) {
    scope += (scope.find(first) == scope.npos ? first : further) + what;
  };
  if (!is_coordinate(part.rows) && part.rows.size() != entry.block.rows.size()) {
    for (const std::string& name : part.hand->rows) append(" of ", " ", name);
  }
  for (const auto& [name, body] : entry.changed_anchors) append(" with ", " and ", name + " on " + body);
  for (const std::string& body : entry.hand.immovable) append(" with ", " and ", body + " immovable");
  return scope;
}

// Adds the cost of a published quantity; beside it that of the generated one, if the ledger lacks it.
void add_costs(Entry& entry, const Part& part, const HandItem& item) {
  const Generated& g = part.generated;
  const Matrix* const generated = item.what == "C" ? &g.C : item.what == "J" ? &g.J : item.what == "K" ? &g.K : nullptr;
  if (!generated) return;
  if (item.what == "J" && entry.form != Form::global) return;
  const std::string block = is_coordinate(part.rows) ? part.rows[0].name : "rows";
  const std::string scope = scope_of(entry, part);
  const auto add = [&](const std::string& source, const Matrix& m) {
    const std::vector<Expr> entries = item.what == "K" ? lower_triangle(m) : m.entries;
    entry.verdict.costs.push_back({name_of_space(entry.joint.dimension), entry.joint.name, block, item.what,
                                   source + scope, cost_from_poses(entry.joint, item.what, entries)});
  };
  add(entry.hand.id, *item.value);
  if (!scope.empty()) add("generated", *generated);
}

void judge_item(Entry& entry, const Part& part, const HandItem& item) {
  if (!item.problem.empty()) return judge_problem(entry, part, item);
  if (item.kind == HandItem::Kind::bound) return judge_bound(entry, part, item);
  if (item.kind == HandItem::Kind::claim) return judge_claim(entry, item);
  if (item.kind != HandItem::Kind::quantity) return;
  if (is_of_law(item.what)) return judge_law(entry, part, item);
  const std::size_t before = entry.verdict.differences.size(), told = entry.verdict.remarks.size();
  const bool others_need_assumptions = std::exchange(entry.needs_assumptions, false);
  if (item.what == "C") judge_C(entry, part, item);
  else if (item.what == "J") judge_J(entry, part, item);
  else if (item.what == "K") judge_K(entry, part, item);
  else judge_Cdot(entry, part, item);
  // An assumption may simplify the published formula, a remark tells of terms that it adds: no fair comparison.
  const bool plain = entry.verdict.differences.size() == before && entry.verdict.remarks.size() == told;
  if (plain && !entry.needs_assumptions) add_costs(entry, part, item);
  entry.needs_assumptions = entry.needs_assumptions || others_need_assumptions;
}

void conclude(Entry& entry) {
  std::string condition;
  const auto append = [&](const std::string& c) { condition += (condition.empty() ? "" : ", ") + c; };
  for (const auto& [name, body] : entry.changed_anchors) append(fmt::format("{} is fixed in {}", name, body));
  if (entry.needs_assumptions) {
    for (const HandAssumption& a : entry.hand.assumptions) {
      if (a.left && a.right) append(a.text);
    }
  }
  entry.verdict.agreement = !entry.verdict.differences.empty() ? Agreement::differs
                            : condition.empty()                ? Agreement::agrees
                                                               : Agreement::agrees_if;
  entry.verdict.condition = condition;
}

}  // namespace

const Matrix& generated_of(const Part& part, const HandItem& item) {
  const Generated& g = part.generated;
  return item.what == "C" ? g.C : item.what == "J" ? g.J : item.what == "K" ? g.K : g.Cdot;
}

int Entry::width() const {
  return static_cast<int>(joint.dimension == 2 ? columns_per_body(2) : columns_per_body(form));
}

std::vector<Expr> Entry::columns_in_form(const std::vector<JacobianEntry>& J) const {
  std::vector<Expr> columns;
  for (std::size_t b = 0; b < J.size(); ++b) {
    const int body = static_cast<int>(b);
    std::vector<Expr> own = columns_of(J[b]);
    if (form == Form::euler) own = columns_in(form, own, joint, body);
    if (form == Form::local) {  // w . v = w' . v', component by component
      const std::vector<Expr> axes = body_axes(pool(), body);
      for (std::size_t k = 0; k < 3; ++k) own[3 + k] = dot(axes[k], J[b].w);
    }
    columns.insert(columns.end(), own.begin(), own.end());
  }
  return columns;
}

Expr Entry::as_assumed(Expr e) const {
  if (!assumed) return e;
  std::map<const Node*, Expr> replacements;
  for (const HandAssumption& a : hand.assumptions) {
    const Expr left = a.left_expression, right = a.right_expression;
    if (!left || !right || left->vector != right->vector) continue;
    // A symbol that the entry made up for this stays out of the words.
    if (left->kind == Kind::symbol && free_symbols(right).empty()) replacements.emplace(&*left, right);
    else if (right->kind == Kind::symbol && free_symbols(left).empty()) replacements.emplace(&*right, left);
  }
  return substitute(e, replacements);
}

// Poses with C = 0.
const Poses& Entry::poses_on_constraint() {
  if (on_constraint) return *on_constraint;
  std::vector<Expr> equations;
  for (const ScalarRow& row : block.rows) {
    if (!is_zero(row.C)) equations.push_back(row.C);
  }
  on_constraint = equations.empty() ? poses().first(0) : poses().aligned().where(equations);
  return *on_constraint;
}

bool Entry::equal(Expr published, Expr generated) {
  if (published == generated) return true;
  if (anywhere->equal(published, generated)) {
    if (difference_modulo_prime(published, generated) != Nullity::zero) only_by_numbers = true;
    return true;
  }
  if (!assumed || !assumed->equal(published, generated)) return false;
  needs_assumptions = true;
  return true;
}

Entry read_entry(const HandEntryAst& ast, const HandFile& file, const ReadResult& read,
                 const std::map<std::string, std::string>& changed_anchors, Diagnostics& diagnostics) {
  const Joint& joint = *read.joint;
  Entry entry(joint);
  entry.changed_anchors = changed_anchors;
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    if (!ast.immovable.empty() && ast.immovable.front() == joint.bodies[b]) entry.immovable = static_cast<int>(b);
  }
  if (joint.dimension == 3) entry.form = form_named(ast.form);
  entry.block = derive_rows(joint, entry.immovable);
  for (const Coordinate& c : joint.coordinates) {
    entry.coordinates.push_back(derive_coordinate(joint, c, entry.immovable));
  }
  const auto generated = [&](const std::vector<std::string>& names) {
    return generated_for(entry, rows_named(entry, names));
  };
  if (joint.law) {
    Derivation derivation(joint);
    derive_law(derivation);
    entry.law = derivation.law;
  }
  entry.hand = elaborate_entry(ast, file, read, generated, diagnostics);
  if (entry.law) read_over_bodies(entry);
  Judgement& verdict = entry.verdict;
  verdict.id = entry.hand.id;
  verdict.joint = joint.name;
  verdict.title = entry.hand.title;
  verdict.source = entry.hand.source;
  verdict.note = entry.hand.note;
  verdict.where = entry.hand.where;
  return entry;
}

namespace {

// Axes have names that no spec has.
void tell_axes(Entry& entry, const std::vector<Part>& parts) {
  for (const Part& part : parts)
    for (const ScalarRow& row : part.rows)
      for (const Expr axis : row.axes) {
        const bool shown = std::ranges::any_of(entry.verdict.differences, [&](const Difference& d) {
          return (d.sentence + d.generated).find(axis->name) != std::string::npos;
        });
        if (shown)
          entry.verdict.remarks.push_back(fmt::format("{} is the axis about which {} turns: see `cdot explain {}`",
                                                      axis->name, row.name, entry.joint.name));
      }
}

}  // namespace

Judgement judge(Entry entry) {
  Judgement& verdict = entry.verdict;
  if (!entry.hand.listed.empty()) {
    verdict.agreement = Agreement::listed;
    verdict.condition = entry.hand.listed;
    return verdict;
  }
  std::vector<Part> parts;
  for (const HandPart& hand : entry.hand.parts) {
    const std::vector<ScalarRow> rows = rows_named(entry, hand.rows);
    parts.push_back({&hand, rows, generated_for(entry, rows), {}, {}});
  }
  prepare_poses(entry, parts);
  for (Part& part : parts) take_order(entry, part);
  find_signs(entry, parts);
  for (const Part& part : parts) {
    for (const HandItem& item : part.hand->items) judge_item(entry, part, item);
    judge_updates(entry, part);
  }
  for (std::string& remark : remarks_on_signs(parts)) verdict.remarks.push_back(std::move(remark));
  if (entry.only_by_numbers) verdict.remarks.push_back("equal at 12 random poses; exact arithmetic did not decide");
  tell_axes(entry, parts);
  conclude(entry);
  return verdict;
}

}  // namespace cdot::derive
