// Update rules: what a source adds to velocities or positions, against M^-1 J^T lambda with the right impulse.
#include <fmt/format.h>

#include <algorithm>

#include "derive/diff_entry.hpp"

namespace cdot::derive {
namespace {

using Target = HandItem::Target;

bool is_linear(Target t) { return t == Target::velocity || t == Target::position; }
bool is_position_level(Target t) { return t == Target::position || t == Target::angle; }

std::string target_name(Target t, const std::string& body) {
  switch (t) {
    case Target::velocity: return "v_" + body;
    case Target::spin: return "w_" + body;
    case Target::position: return "x_" + body;
    case Target::angle: return "angle_" + body;
  }
  return "";
}

bool contains_multiplier(const HandItem& item) {
  for (const Expr e : topological(item.value->entries)) {
    if (e->kind == Kind::symbol && e->role == Role::multiplier) return true;
  }
  return false;
}

}  // namespace

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

void EntryJudge::compare_update(const HandItem& item, const std::string& column, Expr hand,
                                Expr generated) {
  if (equal(hand, generated)) return;
  const Place place{"update", "", column, {}, {}, &joint_};
  add(item, describe_difference(place, hand, generated, poses()), hand, generated);
}

// The impulse is what the source calls lambda (then only the direction M^-1 J^T is judged, either sign of C), or what
// makes Cdot (positions: C) vanish.
void EntryJudge::judge_updates(Part& part) {
  std::vector<const HandItem*> updates;
  for (const HandItem& item : part.hand->items) {
    if (item.kind == HandItem::Kind::update && item.value) updates.push_back(&item);
  }
  if (updates.empty()) return;
  const std::size_t n = part.rows.size();
  const bool direction_only = std::any_of(updates.begin(), updates.end(),
                                          [](const HandItem* item) { return contains_multiplier(*item); });
  const bool positions = is_position_level(updates[0]->target);
  std::vector<Expr> lambda;
  for (std::size_t i = 0; i < n; ++i) {
    const std::string name = n == 1 ? "lambda" : "lambda_" + std::to_string(i + 1);
    lambda.push_back(direction_only ? pool_.symbol(name, Role::multiplier)
                     : positions    ? -part.generated.C.entries[i]
                                    : -part.generated.Cdot.entries[i]);
  }
  if (!direction_only) lambda = solved(part.generated.K, std::move(lambda));

  const auto derived = [&](std::size_t body, int component) {
    const BodySymbols symbols = body_symbols(joint_, static_cast<int>(body));
    Expr force = pool_.number(0);
    for (std::size_t i = 0; i < n; ++i) {
      force = force + part.generated.J.at(static_cast<int>(i), static_cast<int>(3 * body) + component) * lambda[i];
    }
    return (component == 2 ? symbols.inv_I : symbols.inv_m) * force;
  };
  struct Change {
    const HandItem* item;
    std::string column;
    Expr hand, generated;
  };
  std::vector<Change> changes;
  for (std::size_t b = 0; b < joint_.bodies.size(); ++b) {
    for (const bool linear : {true, false}) {
      const HandItem* source = nullptr;
      Expr hand[2] = {pool_.number(0), pool_.number(0)};
      Target target = linear ? (positions ? Target::position : Target::velocity)
                             : (positions ? Target::angle : Target::spin);
      for (const HandItem* item : updates) {
        if (item->body != static_cast<int>(b) || is_linear(item->target) != linear) continue;
        source = item;
        for (std::size_t k = 0; k < item->value->entries.size() && k < 2; ++k) {
          hand[k] = hand[k] + item->value->entries[k];
        }
      }
      for (int k = 0; k < (linear ? 2 : 1); ++k) {
        const std::string axis = linear ? (k == 0 ? ".x" : ".y") : "";
        changes.push_back({source != nullptr ? source : updates[0], target_name(target, joint_.bodies[b]) + axis,
                           hand[k], derived(b, linear ? k : 2)});
      }
    }
  }
  const auto wrong = [&](Rational sign) {
    return std::count_if(changes.begin(), changes.end(), [&](const Change& c) {
      return !poses().equal(c.hand, sign * c.generated);
    });
  };
  const Rational sign(direction_only && wrong(Rational(-1)) < wrong(Rational(1)) ? -1 : 1);
  for (const Change& c : changes) compare_update(*c.item, c.column, c.hand, sign * c.generated);
}

}  // namespace cdot::derive
