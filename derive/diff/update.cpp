// Update rules: what a source adds to velocities or positions, against M^-1 J^T lambda with the
// right impulse; and the bounds of the impulse.
#include <algorithm>
#include <fmt/format.h>

#include "derive/diff/entry.hpp"

namespace cdot::derive {
namespace {

using Target = HandItem::Target;

bool is_linear(Target t) { return t == Target::velocity || t == Target::position; }
bool is_position_level(Target t) { return t == Target::position || t == Target::angle; }

bool contains_multiplier(const HandItem& item) {
  const std::vector<Expr> nodes = topological(item.value->entries);
  return std::any_of(nodes.begin(), nodes.end(),
                     [](Expr e) { return e->kind == Kind::symbol && e->role == Role::multiplier; });
}

// K^-1 b by elimination.
std::vector<Expr> solved(const Matrix& K, std::vector<Expr> b) {
  const int n = K.rows;
  std::vector<Expr> A = K.entries;
  const auto at = [&](int i, int j) -> Expr& { return A[static_cast<std::size_t>(i * n + j)]; };
  const auto rhs = [&](int i) -> Expr& { return b[static_cast<std::size_t>(i)]; };
  for (int k = 0; k < n; ++k) {
    for (int i = k + 1; i < n; ++i) {
      const Expr factor = at(i, k) / at(k, k);
      for (int j = k; j < n; ++j) at(i, j) = at(i, j) - factor * at(k, j);
      rhs(i) = rhs(i) - factor * rhs(k);
    }
  }
  for (int i = n; i-- > 0;) {
    for (int j = i + 1; j < n; ++j) rhs(i) = rhs(i) - at(i, j) * rhs(j);
    rhs(i) = rhs(i) / at(i, i);
  }
  return b;
}

// M^-1 J^T lambda, column by column.
std::vector<Expr> changes_by(const Joint& joint, const std::vector<ScalarRow>& rows, const std::vector<Expr>& lambda) {
  std::vector<Expr> columns;
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    const BodySymbols body = body_symbols(joint, static_cast<int>(b));
    JacobianEntry impulse{zero_vector(*joint.pool), zero_spin(*joint.pool)};
    for (std::size_t i = 0; i < rows.size(); ++i) {
      impulse.v = impulse.v + lambda[i] * rows[i].J[b].v;
      impulse.w = impulse.w + lambda[i] * rows[i].J[b].w;
    }
    const JacobianEntry change{body.inv_m * impulse.v, apply(body.inv_I, impulse.w)};
    for (const Expr e : columns_of(change)) columns.push_back(e);
  }
  return columns;
}

std::string column_name(const Joint& joint, std::size_t column, bool positions) {
  const std::size_t width = columns_per_body(joint.dimension), linear = static_cast<std::size_t>(joint.dimension);
  const std::size_t k = column % width;
  const std::string& body = joint.bodies[column / width];
  if (k < linear) return fmt::format("{}_{}.{}", positions ? "x" : "v", body, "xyz"[k]);
  const std::string turning = fmt::format("{}_{}", positions ? "angle" : "w", body);
  return linear == 2 ? turning : fmt::format("{}.{}", turning, "xyz"[k - linear]);
}

// All columns are the same multiple of what is generated.
bool same_direction(const Confirm::Change& change, const Poses& poses) {
  for (std::size_t i = 0; i < change.generated.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (!poses.equal(change.published[i] * change.generated[j], change.published[j] * change.generated[i])) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace

// The impulse that the changes are compared with: a symbol where the source's is, or else what
// makes Cdot vanish (positions: C).
std::vector<Expr> EntryJudge::impulse(const Part& part, UpdateLevel level) const {
  const std::size_t n = part.rows.size();
  std::vector<Expr> lambda;
  for (std::size_t i = 0; i < n; ++i) {
    const std::string name = n == 1 ? "lambda" : "lambda_" + std::to_string(i + 1);
    lambda.push_back(level == UpdateLevel::any_impulse ? pool_.symbol(name, Role::multiplier)
                     : level == UpdateLevel::positions ? -part.generated.C.entries[i]
                                                       : -part.generated.Cdot.entries[i]);
  }
  return level == UpdateLevel::any_impulse ? lambda : solved(part.generated.K, std::move(lambda));
}

void EntryJudge::judge_updates(const Part& part) {
  std::vector<const HandItem*> updates;
  for (const HandItem& item : part.hand->items) {
    if (item.kind == HandItem::Kind::update && item.value) updates.push_back(&item);
  }
  if (updates.empty()) return;
  const bool positions = is_position_level(updates[0]->target);
  const bool any_impulse =
      std::any_of(updates.begin(), updates.end(), [](const HandItem* item) { return contains_multiplier(*item); });
  const UpdateLevel level = any_impulse ? UpdateLevel::any_impulse
                            : positions ? UpdateLevel::positions
                                        : UpdateLevel::velocities;
  Confirm::Change change{changes_by(joint_, part.rows, impulse(part, level)), {}};
  change.published.assign(change.generated.size(), pool_.number(0));
  std::vector<const HandItem*> said_by(change.generated.size(), updates[0]);
  const std::size_t width = columns_per_body(joint_.dimension), linear = static_cast<std::size_t>(joint_.dimension);
  for (const HandItem* item : updates) {
    const std::size_t first = static_cast<std::size_t>(item->body) * width + (is_linear(item->target) ? 0 : linear);
    for (std::size_t k = 0; k < item->value->entries.size(); ++k) {
      change.published[first + k] = change.published[first + k] + item->value->entries[k];
      said_by[first + k] = item;
    }
  }
  compare_change(part, level, std::move(change), said_by);
}

// An impulse of any size counts C either way round.
void EntryJudge::compare_change(const Part& part, UpdateLevel level, Confirm::Change change,
                                const std::vector<const HandItem*>& said_by) {
  const auto wrong = [&](Rational sign) {
    int count = 0;
    for (std::size_t c = 0; c < said_by.size(); ++c) {
      count += poses().equal(change.published[c], sign * change.generated[c]) ? 0 : 1;
    }
    return count;
  };
  if (level == UpdateLevel::any_impulse && wrong(Rational(-1)) < wrong(Rational(1))) {
    for (Expr& e : change.generated) e = -e;
  }
  const bool only_size = level != UpdateLevel::any_impulse && same_direction(change, poses());
  std::string confirmed;
  const auto difference_at = [&](std::size_t c) {
    if (confirmed.empty()) {
      confirmed = level == UpdateLevel::any_impulse ? confirm().work(part.rows, change)
                  : level == UpdateLevel::positions ? confirm().positions_after(part.rows, change)
                                                    : confirm().velocities_after(part.rows, change);
    }
    const std::string column = column_name(joint_, c, level == UpdateLevel::positions);
    const Place place{"update", "", column, {}, {}, &joint_};
    Difference d = describe_difference(place, change.published[c], change.generated[c], poses());
    d.confirmed = confirmed;
    if (only_size && d.kind == "factor") d.sentence += "; the direction of the impulse is right, its size is not";
    return finished(*said_by[c], std::move(d), change.published[c], change.generated[c]);
  };
  for (const Group& group : groups_of_changes(level, said_by.size())) {
    std::vector<Difference> found;
    Matrix generated{1, group.count, {}}, hand{1, group.count, {}};
    for (int k = 0; k < group.count; ++k) {
      const std::size_t c = static_cast<std::size_t>(group.first + k);
      generated.entries.push_back(change.generated[c]);
      hand.entries.push_back(change.published[c]);
      if (!equal(change.published[c], change.generated[c])) found.push_back(difference_at(c));
    }
    report(std::move(found), "", group.name, hand, generated);
  }
}

// In space the components of one change go together.
std::vector<EntryJudge::Group> EntryJudge::groups_of_changes(UpdateLevel level, std::size_t columns) const {
  std::vector<Group> groups;
  const int width = static_cast<int>(columns_per_body(joint_.dimension));
  for (int c = 0; c < static_cast<int>(columns); ++c) {
    const std::string name = column_name(joint_, static_cast<std::size_t>(c), level == UpdateLevel::positions);
    if (joint_.dimension == 3 && c > 0 && block_of(c, width) == block_of(c - 1, width)) {
      ++groups.back().count;
      groups.back().name = name.substr(0, name.find('.'));
    } else {
      groups.push_back({c, 1, name});
    }
  }
  return groups;
}

void EntryJudge::judge_bound(const Part& part, const HandItem& item) {
  const bool inequality = std::all_of(part.rows.begin(), part.rows.end(),
                                      [](const ScalarRow& row) { return row.kind == RowKind::inequality; });
  if (inequality == item.pushes_only) return;
  std::vector<Expr> b;
  for (const Expr e : part.generated.Cdot.entries) b.push_back(-e);
  const std::string confirmed = confirm().bound(part.rows, solved(part.generated.K, b), inequality);
  const Place place{"update", "", "", {}, {}, &joint_};
  if (inequality) {
    add_plain(item, place, "missing term",
              "the impulse has to stay >= 0: an inequality may push C up, never pull it back; "
              "without that the row "
              "also stops bodies that are already on their way back",
              confirmed);
  } else {
    add_plain(item, place, "extra term", "the row is an equation, its impulse may have either sign", confirmed);
  }
}

}  // namespace cdot::derive
