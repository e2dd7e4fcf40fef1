// The rules of differentiation, one function each, in the shape in which a textbook states them.
#include "derive/explain/rates.hpp"

#include <algorithm>
#include <utility>

namespace cdot::derive {
namespace {

// Sums what is there; nothing if nothing is.
std::optional<Formula> total(std::vector<SignedFormula> terms) {
  if (terms.empty()) return {};
  return sum(std::move(terms));
}

void append(std::vector<SignedFormula>& terms, std::optional<Formula> f, bool minus = false) {
  if (f) terms.push_back({minus, std::move(*f)});
}

}  // namespace

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

Formula Rates::inserted(Expr e) {
  const bool before = std::exchange(insert_, true);
  const std::optional<Formula> f = rate(e, true);
  insert_ = before;
  return f.value_or(number(0));
}

Chain Rates::chain(Expr e, Formula left) {
  const std::vector<std::string> outer = std::exchange(rules_, {});
  Chain result{std::move(left), {}};
  const Formula by_rules = rate(e, true).value_or(number(0));
  std::string rules;
  for (const std::string& r : rules_) rules += (rules.empty() ? "" : "; ") + r;
  if (rules.empty()) rules = by_rules == number(0) ? "nothing in it moves" : "term by term";
  result.links.push_back({by_rules, rules});
  const Formula all = inserted(e);
  if (all != by_rules) result.links.push_back({all, "the rates above inserted"});
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

void Rates::used(const std::string& rule) {
  if (insert_ || std::find(rules_.begin(), rules_.end(), rule) != rules_.end()) return;
  rules_.push_back(rule);
}

Formula Rates::by_name(Expr e, const std::string& name) {
  const Formula left = leaf(time_derivative(e, joint_), name + "_dot");
  if (introduced_.insert(name).second) {
    Chain introduction = chain(e, left);
    chains_.push_back(std::move(introduction));
  }
  return left;
}

std::optional<Formula> Rates::rate(Expr e, bool root) {
  if (is_zero(time_derivative(e, joint_))) return {};
  if (root || insert_) return rule(e);
  if (Notation::has_name(e)) return by_name(e, e->name);
  if (e->kind == Kind::symbol && e->role == Role::body_vector) return by_name(e, e->symbol);
  return rule(e);
}

std::optional<Formula> Rates::rule(Expr e) {
  switch (e->kind) {
    case Kind::number: return {};
    case Kind::symbol: return symbol_rule(e);
    case Kind::sum: return sum_rule(e);
    case Kind::product: return product_rule(e);
    case Kind::dot:
    case Kind::cross: return pair_rule(e);
    case Kind::scale: return scale_rule(e);
    case Kind::perp: {
      used("a quarter turn of the rate");
      return shaped(Shape::perp, *rate(e->args[0], false));
    }
    case Kind::norm: {
      used("derivative of a length: |u|_dot = unit(u) · u_dot");
      return dot(notation_.of(unit(e->args[0])), *rate(e->args[0], false));
    }
    case Kind::unit: return unit_rule(e);
    case Kind::tensor: return product({notation_.of(e->args[0]), *rate(e->args[1], false)});
    case Kind::twist: {
      used("rate of a twist of g against f: (f.x + g.x) · (w_g - w_f)/(1 + f.x · g.x)");
      return notation_.of(time_derivative(e, joint_));
    }
    case Kind::function: return function_rule(e);
  }
  return {};
}

Formula Rates::turned(Expr s) const { return cross(leaf(body_symbols(joint_, s->body).w), leaf(s)); }

std::optional<Formula> Rates::symbol_rule(Expr e) {
  if (e->role == Role::time) return number(1);
  const BodySymbols body = body_symbols(joint_, e->body);
  const std::string& name = joint_.bodies[static_cast<std::size_t>(e->body)];
  if (e->role == Role::position) {
    used("the centre of mass moves with v");
    return leaf(body.v);
  }
  if (e->role == Role::angle) {
    used("the angle of a body grows at its rate w");
    return leaf(body.w);
  }
  used("fixed in " + name + ", so it turns with it: s_dot = w_" + name + " × s");
  return turned(e);
}

std::optional<Formula> Rates::sum_rule(Expr e) {
  const Notation::PointTerms points = notation_.points_among(e);
  std::vector<SignedFormula> terms;
  for (std::size_t i = 0; i < e->args.size(); ++i) {
    if (points.used[i]) continue;
    const Rational c = e->coefs[i];
    const auto add = [&](std::optional<Formula> f) {
      if (f) append(terms, times(abs(c), std::move(*f)), c.sign() < 0);
    };
    if (const Notation::Point* point = points.at[i]) {
      used("a point fixed on a body moves with v + w × r");
      add(leaf(body_symbols(joint_, point->position->body).v));
      add(turned(point->arm));
    } else {
      add(rate(e->args[i], false));
    }
  }
  return total(positive_first(std::move(terms)));
}

// d(x^k y ...)/dt = k x^(k-1) x_dot y ... + ...
std::optional<Formula> Rates::product_rule(Expr e) {
  std::vector<SignedFormula> terms;
  int moving = 0;
  for (std::size_t i = 0; i < e->args.size(); ++i) {
    std::optional<Formula> x_dot = rate(e->args[i], false);
    if (!x_dot) continue;
    ++moving;
    std::vector<Formula> above, below;
    for (std::size_t j = 0; j < e->args.size(); ++j) {
      const int k = e->exponents[j] - (i == j ? 1 : 0);
      if (k != 0) (k > 0 ? above : below).push_back(power(notation_.of(e->args[j]), std::abs(k)));
    }
    const Rational k = e->exponents[i];
    if (abs(k) != Rational(1)) above.insert(above.begin(), number(abs(k)));
    if (k != Rational(1)) used("chain rule: (x^n)_dot = n x^(n-1) x_dot");
    above.push_back(std::move(*x_dot));
    append(terms, quotient(product(std::move(above)), product(std::move(below))), k.sign() < 0);
  }
  used(moving > 1 ? "product rule" : "constant factors stay");
  return total(std::move(terms));
}

// (u · v)_dot = u_dot · v + u · v_dot, and the same with ×.
std::optional<Formula> Rates::pair_rule(Expr e) {
  Expr u = e->args[0], v = e->args[1];
  const bool scalar_product = e->kind == Kind::dot;
  const std::string along_u = world_axis(u), along_v = world_axis(v);
  if (!along_u.empty() || !along_v.empty()) {
    used("component by component");
    return along_v.empty() ? component(*rate(v, false), along_u) : component(*rate(u, false), along_v);
  }
  if (v->kind == Kind::symbol && v->role == Role::spin) return negative(turned_again(v, u));
  used("product rule");
  // Written as the product itself is written: a direction first in n · u.
  if (scalar_product && v->unit_length && !u->unit_length) std::swap(u, v);
  const auto pair = [&](Formula a, Formula b) {
    return scalar_product ? dot(std::move(a), std::move(b)) : cross(std::move(a), std::move(b));
  };
  std::vector<SignedFormula> terms;
  if (auto u_dot = rate(u, false)) append(terms, pair(std::move(*u_dot), notation_.of(v)));
  if (auto v_dot = rate(v, false)) append(terms, pair(notation_.of(u), std::move(*v_dot)));
  return total(std::move(terms));
}

// (w × r)_dot = w × r_dot, w itself held fixed.
Formula Rates::turned_again(Expr w, Expr r) {
  used("s_dot = w × s again");
  const bool fixed = r->kind == Kind::symbol && r->role == Role::body_vector;
  return cross(leaf(w), fixed ? turned(r) : *rate(r, false));
}

std::optional<Formula> Rates::scale_rule(Expr e) {
  const Expr s = e->args[0], u = e->args[1];
  if (s->role == Role::spin && s->kind == Kind::symbol && u->kind == Kind::perp) {
    return turned_again(s, u->args[0]);
  }
  used("product rule");
  std::vector<SignedFormula> terms;
  if (auto s_dot = rate(s, false)) append(terms, product({std::move(*s_dot), notation_.of(u)}));
  if (auto u_dot = rate(u, false)) append(terms, product({notation_.of(s), std::move(*u_dot)}));
  return total(std::move(terms));
}

std::optional<Formula> Rates::unit_rule(Expr e) {
  const Formula n = notation_.of(e);
  if (joint_.dimension == 3) {
    used("derivative of a direction n of u: n_dot = (u_dot - (n · u_dot) n)/|u|");
    const Formula u_dot = *rate(e->args[0], false);
    return quotient(sum({{false, u_dot}, {true, product({dot(n, u_dot), n})}}), notation_.of(norm(e->args[0])));
  }
  used("derivative of a direction n of u: n_dot = (n × u_dot)/|u| perp(n)");
  const Formula speed = cross(n, *rate(e->args[0], false));
  return product({quotient(speed, notation_.of(norm(e->args[0]))), shaped(Shape::perp, n)});
}

std::optional<Formula> Rates::function_rule(Expr e) {
  if (const auto angle = angle_between(e)) return angle_rule(*angle);
  if (e->fn == Fn::atan2) {
    used("chain rule: atan2(y, x)_dot = (x y_dot - y x_dot)/(x^2 + y^2)");
    const Formula y = notation_.of(e->args[0]), x = notation_.of(e->args[1]);
    std::vector<SignedFormula> terms;
    if (auto y_dot = rate(e->args[0], false)) append(terms, product({x, std::move(*y_dot)}));
    if (auto x_dot = rate(e->args[1], false)) append(terms, product({y, std::move(*x_dot)}), true);
    return quotient(sum(std::move(terms)), sum({{false, power(x, 2)}, {false, power(y, 2)}}));
  }
  std::optional<Formula> x_dot = rate(e->args[0], false);
  if (!x_dot) return {};
  return function_rate(e, std::move(*x_dot));
}

// d f(x)/dt = f'(x) x_dot
Formula Rates::function_rate(Expr e, Formula x_dot) {
  const Expr x = e->args[0];
  const auto of = [&](Fn fn) { return notation_.of(call(fn, x)); };
  const auto rule = [&](const char* text) { used(std::string("chain rule: ") + text); };
  switch (e->fn) {
    case Fn::sqrt:
      rule("sqrt(x)_dot = x_dot/(2 sqrt(x))");
      return quotient(std::move(x_dot), product({number(2), notation_.of(e)}));
    case Fn::sin: rule("sin(x)_dot = cos(x) x_dot"); return product({of(Fn::cos), std::move(x_dot)});
    case Fn::cos: rule("cos(x)_dot = -sin(x) x_dot"); return negative(product({of(Fn::sin), std::move(x_dot)}));
    case Fn::tan:
      rule("tan(x)_dot = (1 + tan(x)^2) x_dot");
      return product({sum({{false, number(1)}, {false, power(notation_.of(e), 2)}}), std::move(x_dot)});
    case Fn::exp: rule("exp(x)_dot = exp(x) x_dot"); return product({notation_.of(e), std::move(x_dot)});
    case Fn::log: rule("log(x)_dot = x_dot/x"); return quotient(std::move(x_dot), notation_.of(x));
    case Fn::abs: rule("|x|_dot = sign(x) x_dot"); return product({of(Fn::sign), std::move(x_dot)});
    default: break;
  }
  throw std::logic_error("no rule for the derivative of " + std::string(name_of(e->fn)));
}

// The angle from u to v grows as v turns and falls as u turns; in space by what turns v against u about their common
// normal.
std::optional<Formula> Rates::angle_rule(const AngleBetween& angle) {
  const bool in_space = joint_.dimension == 3;
  used(std::string("derivative of an angle between directions: ") +
       (in_space ? "what turns the second against the first, about their common normal"
                 : "how fast the second turns, less how fast the first does"));
  std::vector<SignedFormula> terms;
  append(terms, turning(angle.to));
  append(terms, turning(angle.from), true);
  if (!in_space) return total(std::move(terms));
  const Formula normal = notation_.of(unit(cross(angle.from, angle.to)));
  return dot(normal, sum(std::move(terms)));
}

// A vector turns at (u × u_dot)/(u · u); one that is fixed in a body turns with it.
std::optional<Formula> Rates::turning(Expr u) {
  const bool fixed = u->kind == Kind::symbol && u->role == Role::body_vector;
  if (fixed) return leaf(body_symbols(joint_, u->body).w);
  std::optional<Formula> u_dot = rate(u, false);
  if (!u_dot) return {};
  const Formula name = notation_.of(u);
  const Formula speed = cross(name, std::move(*u_dot));
  return u->unit_length ? speed : quotient(speed, dot(name, name));
}

}  // namespace cdot::derive
