// The axis about which a row turns two bodies against each other: a factor that J repeats gets a name, as on paper.
#include <algorithm>
#include <optional>

#include "derive/derivation/gradient.hpp"
#include "derive/expression/shared.hpp"

namespace cdot::derive {
namespace {

constexpr double short_enough = 5;  // nodes: as they are, unit(u × v) and r (u × v) say more than a name

bool is_named(Expr e) { return e->named_by_let; }

// -(v - u) × f for (u - v) × f; empty without such a sum.
std::optional<Term> turned_inside(const Term& term) {
  if (term.e->kind != Kind::cross || term.e->named_by_let) return {};
  for (std::size_t i = 0; i < 2; ++i) {
    std::vector<Expr> args = term.e->args;
    if (args[i]->kind != Kind::sum || args[i]->named_by_let) continue;
    args[i] = -args[i];
    const Term turned = split_coefficient(cross(args[0], args[1]));
    return Term{-term.coef * turned.coef, turned.e};
  }
  return {};
}

// w = coef * axis; 0 if it is no multiple.
Rational factor_of(Expr w, Expr axis) {
  const Term term = split_coefficient(w);
  const Term wanted = split_coefficient(axis);  // of a name for -(u × f)
  for (const std::optional<Term>& same : {std::optional(term), turned_inside(term)}) {
    if (same && same->e == wanted.e) return same->coef / wanted.coef;
    if (same && -same->e == wanted.e) return -(same->coef / wanted.coef);
  }
  return 0;
}

}  // namespace

void name_axes(const Joint& joint, ScalarRow& row) {
  if (joint.dimension == 2 || row.component >= 0) return;
  for (std::size_t last = row.J.size(); last-- > 0;) {
    const Term term = split_coefficient(row.J[last].w);
    Expr axis = term.e;
    const bool has_words =
        axis->kind == Kind::symbol || std::ranges::find(joint.lets, axis, &Let::value) != joint.lets.end();
    if (is_zero(axis) || has_words || written_size(axis, &is_named) <= short_enough) continue;
    const auto shares = [&](const JacobianEntry& entry) { return factor_of(entry.w, axis) != Rational(0); };
    const auto first = std::ranges::find_if(row.J, shares);
    const bool alone = first == row.J.begin() + static_cast<std::ptrdiff_t>(last);
    if (alone && !axis->named_by_let) continue;  // a variant keeps the name of the whole row
    if (axis->kind == Kind::sum && factor_of(first->w, axis).sign() < 0) axis = -axis;
    if (axis->name.empty()) axis->pool->name(axis, free_name_of_row(joint, row, {"axis", "axis_", "axis_"}), true);
    for (JacobianEntry& entry : row.J) {
      if (shares(entry)) entry.w = factor_of(entry.w, axis) * axis;
    }
    if (std::ranges::find(row.axes, axis) == row.axes.end()) row.axes.push_back(axis);
  }
}

}  // namespace cdot::derive
