#include "derive/diff_entry.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "derive/finite_field.hpp"
#include "derive/ginac.hpp"

namespace cdot::derive {
namespace {

Matrix column(std::vector<Expr> entries) {
  return {static_cast<int>(entries.size()), 1, std::move(entries)};
}

std::string column_name(const Joint& joint, int column) {
  static const char* const planar[] = {"v_{}.x", "v_{}.y", "w_{}"};
  static const char* const spatial[] = {"v_{}.x", "v_{}.y", "v_{}.z", "w_{}.x", "w_{}.y", "w_{}.z"};
  const int width = static_cast<int>(columns_per_body(joint.dimension));
  return fmt::format(fmt::runtime((width == 3 ? planar : spatial)[column % width]),
                     joint.bodies[static_cast<std::size_t>(column / width)]);
}

constexpr std::size_t whole_row = ~std::size_t{0};  // not an entry of J but all of Cdot

Matrix transposed(const Matrix& m) {
  Matrix t{m.columns, m.rows, {}};
  for (int c = 0; c < m.columns; ++c) {
    for (int r = 0; r < m.rows; ++r) t.entries.push_back(m.at(r, c));
  }
  return t;
}

}  // namespace

EntryJudge::EntryJudge(const HandEntryAst& ast, const HandFile& file, const ReadResult& read,
                       const std::map<std::string, std::string>& changed_anchors,
                       Diagnostics& diagnostics)
    : joint_(*read.joint), pool_(*read.joint->pool), changed_anchors_(changed_anchors) {
  for (std::size_t b = 0; b < joint_.bodies.size(); ++b) {
    if (!ast.immovable.empty() && ast.immovable.front() == joint_.bodies[b]) {
      immovable_ = static_cast<int>(b);
    }
  }
  block_ = derive_rows(joint_, immovable_);
  for (const Coordinate& c : joint_.coordinates) {
    coordinates_.push_back(derive_coordinate(joint_, c, immovable_));
  }
  entry_ = elaborate_entry(
      ast, file, read,
      [this](const std::vector<std::string>& names) { return generated_for(rows_named(names)); },
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

Generated EntryJudge::generated_for(const std::vector<ScalarRow>& rows) const {
  const int n = static_cast<int>(rows.size());
  Generated g;
  std::vector<Expr> C, Cdot;
  g.J = {n, static_cast<int>(columns_per_body(joint_.dimension) * joint_.bodies.size()), {}};
  for (const ScalarRow& row : rows) {
    C.push_back(row.C);
    Cdot.push_back(row.Cdot);
    for (const Expr e : columns_of(row.J)) g.J.entries.push_back(e);
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

void EntryJudge::prepare_poses() {
  std::vector<Expr> all, equations;
  const auto take = [&](const std::optional<Matrix>& m) {
    if (m) all.insert(all.end(), m->entries.begin(), m->entries.end());
  };
  for (const HandAssumption& a : entry_.assumptions) {
    take(a.left);
    take(a.right);
    if (!a.left || !a.right || a.left->entries.size() != a.right->entries.size()) continue;
    for (std::size_t i = 0; i < a.left->entries.size(); ++i) {
      const Expr equation = a.left->entries[i] - a.right->entries[i];
      if (!is_zero(equation)) equations.push_back(equation);
    }
  }
  for (const HandPart& part : entry_.parts) {
    const Generated g = generated_for(rows_named(part.rows));
    for (const Matrix& m : {g.C, g.Cdot, g.J, g.K}) take(m);
    for (const HandItem& item : part.items) {
      take(item.value);
      take(item.right);
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

// Exact arithmetic modulo a prime decides; GiNaC's algebra, where the expression is small enough for it, as well.
bool EntryJudge::proved(Expr difference) const {
  constexpr std::size_t few_nodes = 40;
  if (!vanishes_modulo_prime(difference).value_or(false)) return false;
  if (topological(std::span(&difference, 1)).size() > few_nodes) return true;
  for (const Algebra::Route route : {Algebra::Route::names, Algebra::Route::raw}) {
    Algebra algebra(joint_, route, immovable_);
    if (algebra.is_zero(algebra.of(difference)) == Algebra::Zero::yes) return true;
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

// How many entries of this row agree if the row is counted with this sign.
int EntryJudge::agreeing(const Part& part, const HandItem& item, std::size_t row, int sign) {
  if (item.kind != HandItem::Kind::quantity || !item.value || item.what == "K") return 0;
  const Generated& g = part.generated;
  const Matrix& mine = item.what == "C" ? g.C : item.what == "J" ? g.J : g.Cdot;
  if (item.value->rows != mine.rows || item.value->columns != mine.columns) return 0;
  const Rational factor(item.what == "b" ? -sign : sign);
  int agreed = 0;
  for (int c = 0; c < mine.columns; ++c) {
    const Expr generated = mine.at(static_cast<int>(row), c);
    if (is_zero(generated)) continue;
    agreed += poses().equal(item.value->at(static_cast<int>(row), c), factor * generated) ? 1 : 0;
  }
  return agreed;
}

void EntryJudge::find_signs(Part& part) {
  part.sign.assign(part.rows.size(), 1);
  bool by_rows = false;
  for (std::size_t row = 0; row < part.rows.size(); ++row) {
    int plus = 0, minus = 0;
    for (const HandItem& item : part.hand->items) {
      plus += agreeing(part, item, row, 1);
      minus += agreeing(part, item, row, -1);
      by_rows = by_rows || (item.kind == HandItem::Kind::quantity && item.what != "K");
    }
    if (minus > plus) part.sign[row] = -1;
  }
  if (by_rows) return;
  // K alone: D K D with the D = diag(+-1) that fits best; the first row's sign is free.
  int best = -1;
  std::vector<int> kept = part.sign;
  for (unsigned pattern = 0; pattern < (1u << part.rows.size()); pattern += 2) {
    std::vector<int> sign;
    for (std::size_t i = 0; i < part.rows.size(); ++i) sign.push_back((pattern >> i) & 1 ? -1 : 1);
    int agreed = 0;
    for (const HandItem& item : part.hand->items) {
      if (item.what != "K" || !item.value || item.value->rows != part.generated.K.rows ||
          item.value->columns != part.generated.K.columns) {
        continue;
      }
      for (int i = 0; i < item.value->rows; ++i) {
        for (int j = 0; j < item.value->columns; ++j) {
          const int s = sign[static_cast<std::size_t>(i)] * sign[static_cast<std::size_t>(j)];
          agreed += poses().equal(item.value->at(i, j), Rational(s) * part.generated.K.at(i, j)) ? 1 : 0;
        }
      }
    }
    if (agreed > best) best = agreed, kept = sign;
  }
  part.sign = kept;
}

void EntryJudge::add(const HandItem& item, Difference difference, Expr hand, Expr generated) {
  std::vector<Expr> constraints;
  for (const ScalarRow& row : block_.rows) {
    if (!is_zero(row.C)) constraints.push_back(row.C);
  }
  const std::string hidden = hidden_assumption(joint_, constraints, hand, generated, poses());
  if (!hidden.empty()) difference.sentence += fmt::format("; equal only where {}", hidden);
  const bool vague = difference.kind == "missing term" || difference.kind == "extra term" || difference.kind == "factor";
  if (!hidden.empty() && vague && item.kind == HandItem::Kind::claim) {
    difference.kind = "undeclared assumption";
  }
  difference.where = item.where;
  out_.differences.push_back(std::move(difference));
}

void EntryJudge::add_plain(const HandItem& item, std::string what, std::string kind, std::string sentence) {
  Difference d;
  d.what = std::move(what);
  d.kind = std::move(kind);
  d.hand = item.text;
  d.sentence = std::move(sentence);
  d.where = item.where;
  out_.differences.push_back(std::move(d));
}

// What each leaf of C that moves with a body brings into an entry of J, or into Cdot: the terms of the product rule.
std::vector<Contribution> EntryJudge::contributions(const ScalarRow& row, std::size_t entry, Rational sign) const {
  std::vector<Contribution> sources;
  if (row.kind == RowKind::velocity) return sources;
  for (const Expr leaf : leaves_of(std::span(&row.C, 1))) {
    if (leaf->body < 0) continue;
    ScalarRow only;
    only.Cdot = time_derivative(row.C, joint_, immovable_, leaf);
    only.J = isolate_velocities(only.Cdot, joint_);
    sources.push_back({leaf, sign * (entry == whole_row ? only.Cdot : columns_of(only.J)[entry])});
  }
  return sources;
}

void EntryJudge::compare_entry(Part& part, const HandItem& item, int row, int column, Expr hand,
                               Expr generated) {
  if (equal(hand, generated)) return;
  Place place{item.what, std::to_string(row + 1), "", {}, {}, &joint_};
  const bool claim = item.kind == HandItem::Kind::claim;
  if (item.what == "K" || claim) place.column = std::to_string(column + 1);
  if (item.what == "J" && !claim) {
    place.column = column_name(joint_, column);
    const std::vector<Expr> mine = columns_of(part.rows[static_cast<std::size_t>(row)].J);
    const int width = static_cast<int>(columns_per_body(joint_.dimension));
    for (int c = column % width; c < static_cast<int>(mine.size()); c += width) {
      if (c != column) place.elsewhere.push_back(mine[static_cast<std::size_t>(c)]);
    }
  }
  if ((item.what == "J" || item.what == "Cdot") && !claim) {
    const std::size_t entry = item.what == "J" ? static_cast<std::size_t>(column) : whole_row;
    place.sources = contributions(part.rows[static_cast<std::size_t>(row)], entry,
                                  Rational(part.sign[static_cast<std::size_t>(row)]));
  }
  Difference d = describe_difference(place, hand, generated, poses());
  d.confirmed = confirmation(part, item, row, column, hand, generated);
  add(item, std::move(d), hand, generated);
}

void EntryJudge::compare(Part& part, const HandItem& item, const Matrix& hand, const Matrix& generated) {
  const bool claim = item.kind == HandItem::Kind::claim;
  if (hand.rows != generated.rows || hand.columns != generated.columns) {
    const Matrix turned = transposed(hand);
    const bool fits = turned.rows == generated.rows && turned.columns == generated.columns;
    add_plain(item, item.what, fits ? "transposed" : "extra term",
              fmt::format("{}: {} x {} numbers stand where {} x {} belong{}", item.what, hand.rows,
                          hand.columns, generated.rows, generated.columns, fits ? ": it is transposed" : ""));
    return;
  }
  for (int r = 0; r < hand.rows; ++r) {
    for (int c = 0; c < hand.columns; ++c) {
      Rational sign(1);
      if (!claim) sign = part.sign[static_cast<std::size_t>(r)];
      if (!claim && item.what == "K") sign = sign * Rational(part.sign[static_cast<std::size_t>(c)]);
      if (item.what == "b" && !claim) sign = -sign;
      compare_entry(part, item, r, c, hand.at(r, c), sign * generated.at(r, c));
    }
  }
}

void EntryJudge::judge_item(Part& part, const HandItem& item) {
  if (!item.problem.empty()) {
    add_plain(item, item.what.empty() ? "update" : item.what, "factor", item.problem);
    return;
  }
  if (item.kind == HandItem::Kind::bound) return judge_bound(part, item);
  if (item.kind == HandItem::Kind::claim) {
    // The claim's right side stands for what is true if it holds; which side is wrong, only its author knows.
    Part plain = part;
    return compare(plain, item, *item.value, *item.right);
  }
  if (item.kind != HandItem::Kind::quantity) return;
  const Generated& g = part.generated;
  const std::size_t before = out_.differences.size();
  if (item.what == "C") compare(part, item, *item.value, g.C);
  if (item.what == "Cdot" || item.what == "b") compare(part, item, *item.value, g.Cdot);
  if (item.what == "J") compare(part, item, *item.value, g.J);
  if (item.what == "K") compare(part, item, *item.value, g.K);
  if (item.what == "J" && item.value->columns == g.J.columns) judge_momentum(part, *item.value);
  if (out_.differences.size() == before) add_cost(part, item);
}

void EntryJudge::judge_bound(const Part& part, const HandItem& item) {
  const bool inequality = std::all_of(part.rows.begin(), part.rows.end(), [](const ScalarRow& row) {
    return row.kind == RowKind::inequality;
  });
  if (inequality == item.pushes_only) return;
  if (inequality) {
    add_plain(item, "update", "missing term",
              "update: the impulse has to stay >= 0: an inequality may push C up, never pull it back; without that the "
              "row also stops bodies that are already on their way back");
  } else {
    add_plain(item, "update", "extra term",
              "update: the row is an equation, its impulse may have either sign");
  }
}

// Moving all bodies together must not be felt by a joint that has nothing to do with the world.
void EntryJudge::judge_momentum(const Part& part, const Matrix& J) {
  if (joint_.uses_world || immovable_ >= 0) return;
  const Expr ex = world_x(pool_), zero = pool_.number(0);
  for (int r = 0; r < J.rows && r < static_cast<int>(part.rows.size()); ++r) {
    Expr x = zero, y = zero, turn = zero;
    for (std::size_t b = 0; b < joint_.bodies.size(); ++b) {
      const int c = 3 * static_cast<int>(b);
      const Expr place = body_symbols(joint_, static_cast<int>(b)).x;
      x = x + J.at(r, c);
      y = y + J.at(r, c + 1);
      // A turn about the origin gives the centre at x the velocity perp(x).
      turn = turn + J.at(r, c + 2) + dot(ex, place) * J.at(r, c + 1) - dot(perp(ex), place) * J.at(r, c);
    }
    const bool moved = !poses().equal(x, zero) || !poses().equal(y, zero);
    if (!moved && poses().equal(turn, zero)) continue;
    out_.remarks.push_back(fmt::format(
        "row {} of this J breaks conservation of {}: a common {} of all bodies gives J v != 0", r + 1,
        moved ? "momentum" : "angular momentum", moved ? "translation" : "rotation"));
  }
}

std::string EntryJudge::confirmation(const Part& part, const HandItem& item, int row, int column,
                                     Expr hand, Expr generated) const {
  if (item.kind == HandItem::Kind::claim || item.what == "C") return "";
  if (std::any_of(part.rows.begin(), part.rows.end(), [](const ScalarRow& r) { return r.kind == RowKind::velocity; })) {
    return "";
  }
  const auto line = [&](int r, const Sample& sample) {
    std::vector<double> J = measured_row(joint_, part.rows[static_cast<std::size_t>(r)].C, sample);
    for (double& entry : J) entry *= part.sign[static_cast<std::size_t>(r)];
    return J;
  };
  const auto measured = [&](const Sample& sample) {
    const std::vector<double> J = line(row, sample);
    if (item.what == "J") return J[static_cast<std::size_t>(column)];
    double total = 0;
    if (item.what == "K") {
      const std::vector<double> other = line(column, sample);
      for (std::size_t c = 0; c < J.size(); ++c) {
        const std::string name = (c % 3 == 2 ? "inv_I_" : "inv_m_") + joint_.bodies[c / 3];
        if (static_cast<int>(c / 3) != immovable_) total += J[c] * other[c] * sample.scalars.at(name);
      }
      return total;
    }
    const std::size_t width = columns_per_body(joint_.dimension);
    for (std::size_t c = 0; c < J.size(); ++c) {
      total += J[c] * sample.bodies[c / width].velocity(joint_.dimension, c % width);
    }
    return item.what == "b" ? -total : total;
  };
  const Poses::Errors errors = poses().against(measured, generated, hand);
  return fmt::format("central differences of C at {} poses: generated off by {:.0e}, published by {:.2g}",
                     errors.poses, errors.derived, errors.published);
}

void EntryJudge::add_cost(const Part& part, const HandItem& item) {
  if (item.what != "C" && item.what != "J" && item.what != "K") return;
  std::string block = "rows";
  if (!part.hand->rows.empty()) {
    const bool coordinate = part.rows.size() == 1 && part.rows[0].row == nullptr;
    const bool all = part.rows.size() == block_.rows.size() && !coordinate;
    if (!coordinate && !all) return;
    if (coordinate) block = part.rows[0].name;
  }
  std::vector<Expr> entries = item.value->entries;
  if (item.what == "K") {
    entries.clear();
    for (int i = 0; i < item.value->rows; ++i) {
      for (int j = 0; j <= i; ++j) entries.push_back(item.value->at(i, j));
    }
  }
  out_.costs.push_back({name_of_space(joint_.dimension), joint_.name, block, item.what, entry_.id, cost_from_poses(joint_, entries)});
}

Judgement EntryJudge::judge() {
  if (!entry_.listed.empty()) {
    out_.agreement = Agreement::listed;
    out_.condition = entry_.listed;
    return out_;
  }
  prepare_poses();
  bool other_way_round = false;
  for (const HandPart& hand : entry_.parts) {
    Part part{&hand, rows_named(hand.rows), {}, {}};
    part.generated = generated_for(part.rows);
    find_signs(part);
    other_way_round = other_way_round || std::count(part.sign.begin(), part.sign.end(), -1) > 0;
    for (const HandItem& item : hand.items) judge_item(part, item);
    judge_updates(part);
  }
  if (other_way_round) out_.remarks.push_back("C is counted the other way round: J flips its sign, K does not");
  if (only_by_numbers_) out_.remarks.push_back("equal at 12 random poses; algebra alone did not decide");
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
  return out_;
}

}  // namespace cdot::derive
