#include "derive/diff/entry.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

#include "derive/expression/symbols.hpp"
#include "derive/numbers/modular.hpp"
#include "derive/proof/ginac.hpp"

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

}  // namespace

EntryJudge::EntryJudge(const HandEntryAst& ast, const HandFile& file, const ReadResult& read,
                       const std::map<std::string, std::string>& changed_anchors, Diagnostics& diagnostics)
    : joint_(*read.joint), pool_(*read.joint->pool), changed_anchors_(changed_anchors) {
  for (std::size_t b = 0; b < joint_.bodies.size(); ++b) {
    if (!ast.immovable.empty() && ast.immovable.front() == joint_.bodies[b]) {
      immovable_ = static_cast<int>(b);
    }
  }
  form_ = form_of(ast);
  block_ = derive_rows(joint_, immovable_);
  for (const Coordinate& c : joint_.coordinates) {
    coordinates_.push_back(derive_coordinate(joint_, c, immovable_));
  }
  entry_ = elaborate_entry(
      ast, file, read, [this](const std::vector<std::string>& names) { return generated_for(rows_named(names)); },
      diagnostics);
  out_.id = entry_.id;
  out_.joint = joint_.name;
  out_.title = entry_.title;
  out_.source = entry_.source;
  out_.where = entry_.where;
}

std::vector<ScalarRow> EntryJudge::rows_named(const std::vector<std::string>& names) const {
  if (names.empty()) return block_.rows;
  std::vector<ScalarRow> rows;
  for (const std::string& name : names) {
    for (const ScalarRow& row : block_.rows) {
      if (row.name == name || row.row->name == name) rows.push_back(row);
    }
    for (const Block& coordinate : coordinates_) {
      if (coordinate.name == name) rows.push_back(coordinate.rows[0]);
    }
  }
  return rows;
}

int EntryJudge::width() const {
  return static_cast<int>(joint_.dimension == 2 ? columns_per_body(2) : columns_per_body(form_));
}

std::vector<Expr> EntryJudge::columns_in_form(const std::vector<JacobianEntry>& J) const {
  std::vector<Expr> columns;
  for (std::size_t b = 0; b < J.size(); ++b) {
    const int body = static_cast<int>(b);
    std::vector<Expr> own = columns_of(J[b]);
    if (form_ == Form::euler) own = columns_in(form_, own, joint_, body);
    if (form_ == Form::local) {  // w . v = w' . v', component by component
      const std::vector<Expr> axes = body_axes(pool_, body);
      for (std::size_t k = 0; k < 3; ++k) own[3 + k] = dot(axes[k], J[b].w);
    }
    columns.insert(columns.end(), own.begin(), own.end());
  }
  return columns;
}

Generated EntryJudge::generated_for(const std::vector<ScalarRow>& rows) const {
  const int n = static_cast<int>(rows.size());
  Generated g;
  std::vector<Expr> C, Cdot;
  g.J = {n, width() * static_cast<int>(joint_.bodies.size()), {}};
  for (const ScalarRow& row : rows) {
    C.push_back(row.C);
    Cdot.push_back(row.Cdot);
    for (const Expr e : columns_in_form(row.J)) g.J.entries.push_back(e);
  }
  g.C = column(std::move(C));
  g.Cdot = column(std::move(Cdot));
  const auto triangle = effective_mass(joint_, rows, immovable_);
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
std::vector<Expr> EntryJudge::assumed_equations() const {
  std::vector<Expr> equations;
  for (const HandAssumption& a : entry_.assumptions) {
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

// What has to vanish at a pose for the joint to hold.
std::vector<Expr> EntryJudge::constraints() const {
  std::vector<Expr> equations;
  for (const ScalarRow& row : block_.rows) {
    if (!is_zero(row.C)) equations.push_back(row.C);
  }
  return equations;
}

void EntryJudge::prepare_poses() {
  std::vector<Expr> all = assumed_equations();
  const std::vector<Expr> equations = all;
  const auto take = [&](const Matrix& m) { all.insert(all.end(), m.entries.begin(), m.entries.end()); };
  for (const HandPart& part : entry_.parts) {
    const Generated g = generated_for(rows_named(part.rows));
    for (const Matrix& m : {g.C, g.Cdot, g.J, g.K}) take(m);
    for (const HandItem& item : part.items) {
      if (item.value) take(*item.value);
      if (item.right) take(*item.right);
      for (const HandReading& reading : item.readings) take(reading.value);
    }
  }
  // Everything that a hidden assumption may be about, and that finite differences need.
  const auto take_any = [&](Expr e) {
    for (const Expr component : components_of(e)) all.push_back(component);
  };
  for (std::size_t b = 0; b < joint_.bodies.size(); ++b) {
    const BodySymbols body = body_symbols(joint_, static_cast<int>(b));
    all.insert(all.end(), {body.inv_m, body.inv_I});
  }
  for (const Parameter& p : joint_.parameters) take_any(p.symbol);
  for (const Let& let : joint_.lets) take_any(let.value);
  for (const ScalarRow& row : block_.rows) take_any(row.C);
  anywhere_.emplace(joint_, all);
  if (equations.empty()) return;
  assumed_ = anywhere_->where(equations);
  if (assumed_->empty()) {
    out_.remarks.push_back("no pose was found that fulfils the assumptions; they are left out");
    assumed_.reset();
  }
}

const Poses& EntryJudge::poses_on_constraint() {
  if (on_constraint_) return *on_constraint_;
  const std::vector<Expr> equations = constraints();
  on_constraint_ = equations.empty() ? poses().first(0) : poses().aligned().where(equations);
  return *on_constraint_;
}

// Exact arithmetic modulo a prime decides; GiNaC's algebra, where the expression is small enough
// for it, as well.
bool EntryJudge::proved(Expr difference) const {
  constexpr std::size_t few_nodes = 40;
  if (!vanishes_modulo_prime(difference).value_or(false)) return false;
  const std::vector<Expr> nodes = topological(std::span(&difference, 1));
  // Of Euler parameters the algebra does not know that their length is 1.
  const bool euler = std::any_of(nodes.begin(), nodes.end(), [](Expr e) {
    return e->kind == Kind::symbol && e->role == Role::given && e->body >= 0;
  });
  if (euler || nodes.size() > few_nodes) return true;
  for (const Algebra::Route route : {Algebra::Route::names, Algebra::Route::raw}) {
    Algebra algebra(joint_, route, immovable_);
    if (algebra.vanishes(algebra.of(difference))) return true;
  }
  return false;
}

// Equal everywhere, or where the entry's assumptions hold; the first is proved as well.
bool EntryJudge::equal(Expr hand, Expr generated) {
  if (hand == generated) return true;
  if (anywhere_->equal(hand, generated)) {
    if (!proved(hand - generated)) only_by_numbers_ = true;
    return true;
  }
  if (!assumed_ || !assumed_->equal(hand, generated)) return false;
  needs_assumptions_ = true;
  return true;
}

void EntryJudge::judge_item(const Part& part, const HandItem& item) {
  if (!item.problem.empty()) return judge_problem(part, item);
  if (item.kind == HandItem::Kind::bound) return judge_bound(part, item);
  // The right side of a claim is what its left side, the published one, would have to equal.
  if (item.kind == HandItem::Kind::claim) return compare(part, item, *item.value, *item.right);
  if (item.kind != HandItem::Kind::quantity) return;
  const Generated& g = part.generated;
  const std::size_t before = out_.differences.size();
  const bool others_need_assumptions = std::exchange(needs_assumptions_, false);
  const Matrix& generated = item.what == "C" ? g.C : item.what == "J" ? g.J : item.what == "K" ? g.K : g.Cdot;
  compare(part, item, *item.value, generated);
  if (item.what == "J" && item.value->columns == g.J.columns) judge_momentum(part, *item.value);
  // Under an assumption more may be left out than is when nothing is assumed: no fair comparison.
  if (out_.differences.size() == before && !needs_assumptions_) add_costs(part, item, generated);
  needs_assumptions_ = needs_assumptions_ || others_need_assumptions;
}

std::string EntryJudge::scope_of(const Part& part) const {
  std::string scope;
  const auto append = [&](const char* first, const char* further, const std::string& what) {
    scope += (scope.find(first) == scope.npos ? first : further) + what;
  };
  if (!is_coordinate(part.rows) && part.rows.size() != block_.rows.size()) {
    for (const std::string& name : part.hand->rows) append(" of ", " ", name);
  }
  for (const auto& [name, body] : changed_anchors_) append(" with ", " and ", name + " on " + body);
  for (const std::string& body : entry_.immovable) append(" with ", " and ", body + " immovable");
  return scope;
}

// Beside what is generated of the same, where the ledger does not have that anyway.
void EntryJudge::add_costs(const Part& part, const HandItem& item, const Matrix& generated) {
  if (item.what != "C" && item.what != "J" && item.what != "K") return;
  if (item.what == "J" && form_ != Form::global) return;
  const std::string block = is_coordinate(part.rows) ? part.rows[0].name : "rows";
  const std::string scope = scope_of(part);
  const auto add = [&](const std::string& source, const Matrix& m) {
    const std::vector<Expr> entries = item.what == "K" ? lower_triangle(m) : m.entries;
    out_.costs.push_back({name_of_space(joint_.dimension), joint_.name, block, item.what, source + scope,
                          cost_from_poses(joint_, item.what, entries)});
  };
  add(entry_.id, *item.value);
  if (!scope.empty()) add("generated", generated);
}

Judgement EntryJudge::judge() {
  if (!entry_.listed.empty()) {
    out_.agreement = Agreement::listed;
    out_.condition = entry_.listed;
    return out_;
  }
  prepare_poses();
  std::vector<Part> parts;
  for (const HandPart& hand : entry_.parts) {
    const std::vector<ScalarRow> rows = rows_named(hand.rows);
    parts.push_back({&hand, rows, generated_for(rows), {}});
  }
  find_signs(parts);
  for (const Part& part : parts) {
    for (const HandItem& item : part.hand->items) judge_item(part, item);
    judge_updates(part);
  }
  const bool other_way_round = std::any_of(parts.begin(), parts.end(), [](const Part& part) {
    return std::count(part.sign.begin(), part.sign.end(), -1) > 0;
  });
  if (other_way_round) out_.remarks.push_back("C is counted the other way round: J flips its sign, K does not");
  if (only_by_numbers_) out_.remarks.push_back("equal at 12 random poses; algebra alone did not decide");
  conclude();
  return out_;
}

void EntryJudge::conclude() {
  std::string condition;
  const auto append = [&](const std::string& c) { condition += (condition.empty() ? "" : ", ") + c; };
  for (const auto& [name, body] : changed_anchors_) append(fmt::format("{} is fixed in {}", name, body));
  if (needs_assumptions_) {
    for (const HandAssumption& a : entry_.assumptions) {
      if (a.left && a.right) append(a.text);
    }
  }
  out_.agreement = !out_.differences.empty() ? Agreement::differs
                   : condition.empty()       ? Agreement::agrees
                                             : Agreement::agrees_if;
  out_.condition = condition;
}

}  // namespace cdot::derive
