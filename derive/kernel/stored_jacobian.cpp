#include "derive/kernel/stored_jacobian.hpp"

#include <algorithm>

#include "derive/expression/components.hpp"

namespace cdot::derive {
namespace {

bool is_simple(Expr e) { return e->kind == Kind::symbol || !e->name.empty(); }

// The opposite of x y - z costs no more.
bool has_both_signs(Expr e) {
  return e->kind == Kind::sum && std::ranges::any_of(e->coefs, [](Rational c) { return c.sign() < 0; });
}

}  // namespace

StoredJacobian::StoredJacobian(const Joint& joint, const Block& block)
    : joint_(joint), pool_(*joint.pool), block_(block) {
  Components components;
  for (std::size_t i = 0; i < block.rows.size(); ++i) {
    std::vector<Entry> row;
    for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
      const std::string suffix = joint.bodies[b] + (block.rows.size() > 1 ? "_" + std::to_string(i + 1) : "");
      const std::vector<Expr> entries = columns_of(block.rows[i].J[b]);
      for (std::size_t k = 0; k < entries.size(); ++k)
        row.push_back(store(entries[k], components.of(entries[k]), column_name(k, suffix)));
    }
    J_.push_back(std::move(row));
  }
}

Expr StoredJacobian::entry(std::size_t row, std::size_t column) const {
  const Entry& entry = J_[row][column];
  Expr e = pool_.number(entry.coef);
  for (const int f : entry.fields) e = e * fields_[static_cast<std::size_t>(f)].symbol;
  return e;
}

// v_a_1_x, w_a_1 in the plane, w_a_1_x in space
std::string StoredJacobian::column_name(std::size_t k, const std::string& suffix) const {
  const std::size_t linear = static_cast<std::size_t>(joint_.dimension);
  if (k < linear) return "v" + suffix + "_" + "xyz"[k];
  return "w" + suffix + (linear == 2 ? "" : std::string("_") + "xyz"[k - linear]);
}

StoredJacobian::Entry StoredJacobian::store(Expr entry, Expr components, const std::string& column) {
  const Term term = split_coefficient(components);
  if (is_one(term.e)) return {term.coef, {}};
  Entry stored{term.coef, {}};
  const bool plain_factors = term.e->kind == Kind::product && term.e->name.empty() &&
                             std::ranges::all_of(term.e->args, is_simple) &&
                             std::ranges::all_of(term.e->exponents, [](int k) { return k == 1; });
  if (plain_factors) {
    for (const Expr factor : term.e->args) stored.fields.push_back(field(factor, column));
    return stored;
  }
  const Term part = with_better_sign(entry, term);
  stored.coef = part.coef;
  stored.fields.push_back(field(part.e, column, (Rational(1) / part.coef) * entry));
  return stored;
}

// The opposite of a number that is stored already, or where that costs nothing, a number that J has without a minus.
Term StoredJacobian::with_better_sign(Expr entry, const Term& term) const {
  const Term opposite{-term.coef, -term.e};
  if (is_field(opposite.e)) return opposite;
  if (term.coef.sign() > 0 || !has_both_signs(term.e) || is_field(term.e)) return term;
  if (term.e->name.empty()) return opposite;
  return is_lonely_axis(entry) ? Term{-term.coef, turned(term.e)} : term;
}

// An entry of the only row on the only body that moves, which no other entry repeats with the other sign.
bool StoredJacobian::is_lonely_axis(Expr entry) const {
  if (block_.rows.size() > 1 || block_.immovable < 0 || joint_.bodies.size() > 2) return false;
  const std::vector<Expr> parts = topological(std::span(&entry, 1));
  const std::vector<Expr>& axes = block_.rows[0].axes;
  return std::find_first_of(parts.begin(), parts.end(), axes.begin(), axes.end()) != parts.end();
}

// z - x y for the opposite of a name for x y - z.
Expr StoredJacobian::turned(Expr e) const {
  std::vector<Term> terms;
  for (std::size_t i = 0; i < e->args.size(); ++i) terms.push_back({-e->coefs[i], e->args[i]});
  return sum(pool_, terms, false);
}

bool StoredJacobian::is_field(Expr e) const { return std::ranges::find(fields_, e, &Field::value) != fields_.end(); }

int StoredJacobian::field(Expr e, const std::string& column, Expr entry) {
  for (std::size_t i = 0; i < fields_.size(); ++i) {
    if (fields_[i].value == e) return static_cast<int>(i);
  }
  std::string name = is_simple(e) ? (e->name.empty() ? e->symbol : e->name) : column;
  while (std::ranges::find(fields_, name, &Field::name) != fields_.end()) name += "_";
  fields_.push_back({name, e, entry ? entry : e, pool_.symbol("J." + name, Role::given)});
  return static_cast<int>(fields_.size()) - 1;
}

}  // namespace cdot::derive
