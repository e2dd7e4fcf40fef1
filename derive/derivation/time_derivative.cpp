// d/dt of an expression by the rules of the textbook, simplified node by node.
#include <map>

#include "derive/derivation/rate_rules.hpp"
#include "derive/numbers/modular.hpp"

namespace cdot::derive {
namespace {

// The builders of expressions as the algebra of the rules.
class Simplifying {
 public:
  using Value = Expr;
  Simplifying(const Joint& joint, const Moving& motion) : joint_(joint), motion_(motion) {}

  Expr rate(Expr e) {
    if (const auto found = done_.find(&*e); found != done_.end()) return found->second;
    if (motion_.only == e && e->role == Role::given) return e->pool->number(1);
    const Expr result = RateRules(*this, joint_, motion_).of(e);
    // Only where everything moves is it the whole u_dot: a part of it must not take the name.
    const bool whole = !motion_.only && motion_.stretched < 0 && motion_.immovable < 0;
    if (!e->name.empty() && whole) e->pool->name(result, e->name + "_dot", false);
    done_.emplace(&*e, result);
    return result;
  }

  Expr operand(Expr e) const { return e; }
  Expr nothing(Expr e) const { return e->vector ? zero_vector(*e->pool) : e->pool->number(0); }
  Expr times(Expr factor, Expr rate) const { return factor * rate; }
  Expr monomial(Rational coef, std::span<const Expr> bases, std::span<const int> exponents, Expr rate) const {
    return coef * (product(*rate->pool, bases, exponents) * rate);
  }

  std::vector<Addend> addends(Expr sum) const {
    std::vector<Addend> all;
    for (std::size_t i = 0; i < sum->args.size(); ++i) all.push_back({sum->coefs[i], sum->args[i], {}});
    return all;
  }
  Expr total(Expr e, const std::vector<Weighted<Expr>>& weighted) const {
    std::vector<Term> terms;
    for (const auto& [coef, rate] : weighted) terms.push_back({coef, rate});
    return sum(*e->pool, terms, e->vector);
  }

  void rule(const auto&...) const {}

 private:
  const Joint& joint_;
  const Moving& motion_;
  std::map<const Node*, Expr> done_;
};

}  // namespace

std::optional<AngleBetween> angle_between(Expr e) {
  if (e->kind != Kind::function || e->fn != Fn::atan2) return {};
  const Expr sine = e->args[0];
  const bool in_space = sine->kind == Kind::norm && sine->args[0]->kind == Kind::cross;
  const Term y = in_space ? Term{1, sine->args[0]} : split_coefficient(sine);
  const Term x = split_coefficient(e->args[1]);
  const bool fits = y.e->kind == Kind::cross && x.e->kind == Kind::dot && x.coef == Rational(1) &&
                    abs(y.coef) == Rational(1) && y.e->args == x.e->args;
  if (!fits) return {};
  const Expr u = y.e->args[0], v = y.e->args[1];
  return y.coef == Rational(1) ? AngleBetween{u, v} : AngleBetween{v, u};
}

Expr twist_of(Expr e) {
  if (e->kind != Kind::function || e->fn != Fn::atan2) return {};
  const Expr product = terms_of(e->args[1]).front().e;
  if (product->kind != Kind::dot) return {};
  const Pool& pool = *e->pool;
  for (const bool swapped : {false, true}) {
    const Triad* f = pool.axis_of(product->args[swapped ? 1 : 0]).triad;
    const Triad* g = pool.axis_of(product->args[swapped ? 0 : 1]).triad;
    if (f == nullptr || g == nullptr || f == g) return {};
    const auto rotated = [](const Triad& t, std::size_t k) { return Triad{t[k], t[(k + 1) % 3], t[(k + 2) % 3]}; };
    for (std::size_t k = 0; k < 3; ++k) {
      const Expr about = twist(rotated(*f, k), rotated(*g, k));
      if (twist_as_atan2(about) == e) return about;
    }
  }
  return {};
}

bool is_on_unit_circle(Expr e) {
  const auto square = [](Expr x) {
    if (!is_root(x)) return pow(x, 2);
    return x->kind == Kind::norm ? dot(x->args[0], x->args[0]) : x->args[0];
  };
  return difference_modulo_prime(square(e->args[0]) + square(e->args[1]), e->pool->number(1)) == Nullity::zero;
}

Expr time_derivative(Expr e, const Joint& joint, const Moving& motion) { return Simplifying(joint, motion).rate(e); }

}  // namespace cdot::derive
