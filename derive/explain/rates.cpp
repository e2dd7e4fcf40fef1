// The rules of d/dt, written down and not simplified.
#include "derive/explain/rates.hpp"

#include <algorithm>
#include <utility>

namespace cdot::derive {

std::vector<Chain> Rates::differentiate(Expr e, Formula left) {
  chains_.clear();
  Chain last = chain(e, std::move(left));
  // First rates in the order in which the author introduced the names, which never refers ahead.
  if (!depends_on_velocity(e))
    std::stable_sort(chains_.begin(), chains_.end(),
                     [this](const Chain& a, const Chain& b) { return place_of(a.left.name) < place_of(b.left.name); });
  chains_.push_back(std::move(last));
  return std::exchange(chains_, {});
}

std::optional<Formula> Rates::inserted(Expr e) {
  const bool before = std::exchange(insert_, true);
  std::optional<Formula> f;
  insertions_ = 0;
  try {
    f = by_rules(e);
  } catch (const TooLong&) {
  }
  insert_ = before;
  return f;
}

Chain Rates::chain(Expr e, Formula left) {
  const std::vector<std::string> outer = std::exchange(rules_, {});
  Chain result{std::move(left), {}};
  const Formula rate = by_rules(e);
  std::string rules;
  for (const std::string& r : rules_) rules += (rules.empty() ? "" : "; ") + r;
  if (rules.empty()) rules = rate == number(0) ? "nothing in it moves" : "term by term";
  result.links.push_back({rate, rules});
  const std::optional<Formula> all = inserted(e);
  if (all && *all != rate) result.links.push_back({*all, "the rates above inserted"});
  rules_ = outer;
  return result;
}

std::size_t Rates::place_of(std::string name) const {
  while (name.ends_with("_dot")) name.resize(name.size() - 4);
  const auto let = std::find_if(joint_.lets.begin(), joint_.lets.end(), [&](const Let& l) {
    return l.name == name || name == l.name + "_x" || name == l.name + "_y";
  });
  return let == joint_.lets.end() ? 0 : static_cast<std::size_t>(let - joint_.lets.begin()) + 1;
}

void Rates::take_note(const std::string& rule) {
  if (insert_ || std::find(rules_.begin(), rules_.end(), rule) != rules_.end()) return;
  rules_.push_back(rule);
}

Rates::Written Rates::by_name(Expr e, const std::string& name) {
  Formula left = leaf(time_derivative(e, joint_), name + "_dot");
  if (introduced_.insert(name).second) {
    Chain introduction = chain(e, left);
    chains_.push_back(std::move(introduction));
  }
  return {std::move(left)};
}

Formula Rates::by_rules(Expr e) {
  if (is_zero(time_derivative(e, joint_))) return number(0);
  return RateRules(*this, joint_).of(e).formula.value_or(number(0));
}

Rates::Written Rates::rate(Expr e) {
  if (is_zero(time_derivative(e, joint_))) return {};
  if (insert_ && ++insertions_ > most_insertions) throw TooLong{};
  if (!insert_ && Notation::has_name(e)) return by_name(e, e->name);
  if (!insert_ && e->kind == Kind::symbol && e->role == Role::body_vector) return by_name(e, e->symbol);
  return RateRules(*this, joint_).of(e);
}

std::vector<Addend> Rates::addends(Expr sum) const {
  const Notation::PointTerms points = notation_.points_among(sum);
  std::vector<Addend> all;
  for (std::size_t i = 0; i < sum->args.size(); ++i) {
    if (!points.used[i]) all.push_back({sum->coefs[i], sum->args[i], points.at[i] ? points.at[i]->arm : Expr()});
  }
  return all;
}

Rates::Written Rates::total(Expr, const std::vector<Weighted<Written>>& weighted) const {
  std::vector<SignedFormula> terms;
  for (const auto& [coef, rate] : weighted) {
    if (rate.formula) terms.push_back({coef.sign() < 0, derive::times(abs(coef), *rate.formula)});
  }
  if (terms.empty()) return {};
  return {sum(positive_first(std::move(terms)))};
}

Rates::Written Rates::monomial(Rational coef, std::span<const Expr> bases, std::span<const int> exponents,
                               const Written& rate) const {
  if (!rate.formula) return {};
  std::vector<Formula> above, below;
  if (abs(coef).num() != 1) above.push_back(number(abs(coef).num()));
  if (coef.den() != 1) below.push_back(number(coef.den()));
  for (std::size_t i = 0; i < bases.size(); ++i) {
    const int k = exponents[i];
    if (k != 0) (k > 0 ? above : below).push_back(power(notation_.of(bases[i]), std::abs(k)));
  }
  above.push_back(*rate.formula);
  Formula f = quotient(product(std::move(above)), product(std::move(below)));
  return {coef.sign() < 0 ? negative(std::move(f)) : std::move(f)};
}

// As a fraction, x_dot/(2 sqrt(x)); of a sum the number first, (1 + tan(x)^2) x_dot.
Rates::Written Rates::times(Expr factor, const Written& rate) const {
  const Term term = split_coefficient(factor);
  if (Notation::has_name(term.e) || (term.e->kind != Kind::product && term.e->kind != Kind::sum)) {
    const int once = 1;
    return monomial(term.coef, std::span(&term.e, 1), std::span(&once, 1), rate);
  }
  if (term.e->kind == Kind::product) return monomial(term.coef, term.e->args, term.e->exponents, rate);
  std::vector<SignedFormula> terms = terms_of(notation_.of(factor));
  std::stable_partition(terms.begin(), terms.end(),
                        [](const SignedFormula& t) { return t.formula.shape == Shape::number; });
  return Written{sum(std::move(terms))} * rate;
}

namespace {

// The name of the world's axis that f is; empty for others.
std::string axis_in(const Formula& f) {
  if (f.shape == Shape::leaf) return world_axis(f.leaf);
  const bool quarter_turn = f.shape == Shape::perp && f.args[0].shape == Shape::leaf;
  return quarter_turn ? world_axis(perp(f.args[0].leaf)) : "";
}

}  // namespace

Formula Rates::Written::along_axis_or_dot(const Formula& f, const Formula& g) {
  if (const std::string axis = axis_in(f); !axis.empty()) return component(g, axis);
  if (const std::string axis = axis_in(g); !axis.empty()) return component(f, axis);
  return derive::dot(f, g);
}

}  // namespace cdot::derive
