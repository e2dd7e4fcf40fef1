// Update rules: a source's change of velocities or positions against M^-1 J^T lambda with the right impulse; and the
// bounds of the impulse.
#include <algorithm>
#include <fmt/format.h>

#include "derive/diff/entry.hpp"
#include "derive/numbers/elimination.hpp"

namespace cdot::derive {
namespace {

using Target = HandItem::Target;

bool is_linear(Target t) { return t == Target::velocity || t == Target::position; }
bool is_position_level(Target t) { return t == Target::position || t == Target::angle; }

bool contains_multiplier(const HandItem& item) {
  return std::ranges::any_of(leaves_of(item.value->entries), [](Expr e) { return e->role == Role::multiplier; });
}

// K^-1 b
std::vector<Expr> solved(const Matrix& K, std::vector<Expr> b) {
  std::vector<std::vector<Expr>> rows;
  for (int i = 0; i < K.rows; ++i) {
    const auto first = K.entries.begin() + i * K.columns;
    rows.emplace_back(first, first + K.columns);
  }
  return solved(std::move(rows), std::move(b), [](Expr a, Expr pivot) { return a / pivot; });
}

// M^-1 J^T lambda, column by column; J^T lambda without the inverse masses, or without the inverse inertias.
struct Weights {
  bool masses = true, inertias = true;
};
std::vector<Expr> changes_by(const Joint& joint, const std::vector<ScalarRow>& rows, const std::vector<Expr>& lambda,
                             const Weights& by = {}) {
  std::vector<Expr> columns;
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    const BodySymbols body = body_symbols(joint, static_cast<int>(b));
    JacobianEntry impulse{zero_vector(*joint.pool), zero_spin(*joint.pool)};
    for (std::size_t i = 0; i < rows.size(); ++i) {
      impulse.v = impulse.v + lambda[i] * rows[i].J[b].v;
      impulse.w = impulse.w + lambda[i] * rows[i].J[b].w;
    }
    const JacobianEntry change{by.masses ? body.inv_m * impulse.v : impulse.v,
                               by.inertias ? apply(body.inv_I, impulse.w) : impulse.w};
    for (const Expr e : columns_of(change)) columns.push_back(e);
  }
  return columns;
}

// True if all columns are the same multiple of the generated ones.
bool same_direction(const Change& change, const Poses& poses) {
  for (std::size_t i = 0; i < change.generated.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (!poses.equal(change.published[i] * change.generated[j], change.published[j] * change.generated[i])) {
        return false;
      }
    }
  }
  return true;
}

// The impulse of the generated change: a symbol if the source's is one, else the impulse that makes Cdot vanish
// (positions: C).
std::vector<Expr> impulse(Pool& pool, const Part& part, UpdateLevel level) {
  const std::size_t n = part.rows.size();
  std::vector<Expr> lambda;
  for (std::size_t i = 0; i < n; ++i) {
    const std::string name = n == 1 ? "lambda" : "lambda_" + std::to_string(i + 1);
    lambda.push_back(level == UpdateLevel::any_impulse ? pool.symbol(name, Role::multiplier)
                     : level == UpdateLevel::positions ? -part.generated.C.entries[i]
                                                       : -part.generated.Cdot.entries[i]);
  }
  return level == UpdateLevel::any_impulse ? lambda : solved(part.generated.K, std::move(lambda));
}

UpdateLevel level_of(const std::vector<const HandItem*>& updates) {
  if (std::any_of(updates.begin(), updates.end(), [](const HandItem* item) { return contains_multiplier(*item); }))
    return UpdateLevel::any_impulse;
  return is_position_level(updates[0]->target) ? UpdateLevel::positions : UpdateLevel::velocities;
}

// -1 if the negative of the generated change fits better: an impulse of any size has either sign of C.
Rational sign_that_fits(const std::vector<Expr>& generated, const std::vector<Expr>& published, const Poses& poses) {
  const auto wrong = [&](Rational sign) {
    int count = 0;
    for (std::size_t c = 0; c < published.size(); ++c) {
      count += poses.equal(published[c], sign * generated[c]) ? 0 : 1;
    }
    return count;
  };
  return wrong(Rational(-1)) < wrong(Rational(1)) ? Rational(-1) : Rational(1);
}

// An update without the inverse masses.
std::optional<Slip> slip_of_weights(const Entry& entry, const Part& part, const std::vector<Expr>& lambda,
                                    const std::vector<Expr>& published) {
  for (const auto& [by, words] : {std::pair(Weights{false, false}, "J^T lambda stands where M^-1 J^T lambda belongs"),
                                  std::pair(Weights{false, true}, "the inverse masses are missing"),
                                  std::pair(Weights{true, false}, "the inverse inertias are missing")}) {
    const std::vector<Expr> without = changes_by(entry.joint, part.rows, lambda, by);
    const auto same = [&](Expr a, Expr b) { return entry.poses().equal(a, b); };
    if (std::ranges::equal(published, without, same)) return Slip{"missing term", words};
  }
  return {};
}

}  // namespace

void judge_updates(Entry& entry, const Part& part) {
  std::vector<const HandItem*> updates;
  for (const HandItem& item : part.hand->items) {
    if (item.kind == HandItem::Kind::update && item.value) updates.push_back(&item);
  }
  if (updates.empty()) return;
  const UpdateLevel level = level_of(updates);
  std::vector<Expr> lambda = impulse(entry.pool(), part, level);
  Change change{changes_by(entry.joint, part.rows, lambda), {}};
  change.published.assign(change.generated.size(), entry.pool().number(0));
  std::vector<const HandItem*> said_by(change.generated.size(), updates[0]);
  const int dimension = entry.joint.dimension;
  const std::size_t width = columns_per_body(dimension), linear = static_cast<std::size_t>(dimension);
  for (const HandItem* item : updates) {
    const std::size_t first = static_cast<std::size_t>(item->body) * width + (is_linear(item->target) ? 0 : linear);
    for (std::size_t k = 0; k < item->value->entries.size(); ++k) {
      change.published[first + k] = change.published[first + k] + item->value->entries[k];
      said_by[first + k] = item;
    }
  }
  const bool any = level == UpdateLevel::any_impulse;
  if (any) {
    const Rational sign = sign_that_fits(change.generated, change.published, entry.poses());
    for (std::vector<Expr>* of : {&lambda, &change.generated})
      for (Expr& e : *of) e = sign * e;
  }
  const bool only_size = !any && same_direction(change, entry.poses());
  const int columns = static_cast<int>(change.generated.size());
  const Matrix published{1, columns, change.published}, generated{1, columns, change.generated};
  const std::vector<Group> groups =
      groups_of_velocities(entry.joint, Form::global, columns, level == UpdateLevel::positions);
  std::string confirmed;
  const std::size_t before = entry.verdict.differences.size();
  const Sides sides{"update", published, generated, {Group{}}, groups};
  compare(entry, sides, [&](int, int c) {
    if (confirmed.empty()) confirmed = entry.confirm().after(level, part.rows, change);
    const std::string column = column_name(entry.joint, Form::global, c, level == UpdateLevel::positions);
    const Place place{"update", "", column, {}, {}, &entry.joint};
    const Expr hand = entry.as_assumed(published.at(0, c)), right = entry.as_assumed(generated.at(0, c));
    Difference d = describe_difference(place, hand, right, entry.poses());
    d.confirmed = confirmed;
    if (only_size && d.kind == "factor") d.sentence += "; the direction of the impulse is right, its size is not";
    return finished(entry, *said_by[static_cast<std::size_t>(c)], std::move(d), hand, right);
  });
  std::vector<Difference>& differences = entry.verdict.differences;
  const auto unexplained = [](const Difference& d) { return d.sentence.find(not_generated) != std::string::npos; };
  const std::size_t told = differences.size() - before;
  if (told == 0 || (told == 1 && !unexplained(differences[before]))) return;
  std::optional<Slip> slip = slip_of_weights(entry, part, lambda, change.published);
  if (!slip) slip = slip_of_whole(entry, &part, "update", published, generated);
  if (!slip && only_size && told > 1 &&
      std::all_of(differences.begin() + static_cast<std::ptrdiff_t>(before), differences.end(), unexplained))
    slip = Slip{"factor", not_generated};
  if (!slip) return;
  differences.resize(before);
  if (only_size && slip->kind == "factor") slip->sentence += "; the direction of the impulse is right, its size is not";
  add_slip(entry, *updates[0], {"update", "", "", {}, {}, &entry.joint}, *slip, confirmed);
}

void judge_bound(Entry& entry, const Part& part, const HandItem& item) {
  const bool inequality = std::all_of(part.rows.begin(), part.rows.end(),
                                      [](const ScalarRow& row) { return row.kind == RowKind::inequality; });
  if (inequality == item.pushes_only) return;
  show_apart(entry, "bound", item, nullptr, nullptr);
  std::vector<Expr> b;
  for (const Expr e : part.generated.Cdot.entries) b.push_back(-e);
  const std::string confirmed = entry.confirm().bound(part.rows, solved(part.generated.K, b), inequality);
  const Place place{"update", "", "", {}, {}, &entry.joint};
  if (inequality) {
    add_plain(entry, item, place, "missing term",
              "the impulse has to stay >= 0: an inequality may push C up, never pull it back; without that the row "
              "also stops bodies that are already on their way back",
              confirmed);
  } else {
    add_plain(entry, item, place, "extra term", "the row is an equation, its impulse may have either sign", confirmed);
  }
}

}  // namespace cdot::derive
