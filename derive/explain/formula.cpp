// Builds written formulas, by hand and from expressions. write.cpp decides how they look.
#include "derive/explain/formula.hpp"

#include <algorithm>
#include <utility>

#include "derive/expression/functions.hpp"
#include "derive/expression/shared.hpp"

namespace cdot::derive {
namespace {

Formula of_form(Shape kind, std::vector<Formula> args) {
  Formula f;
  f.shape = kind;
  f.args = std::move(args);
  return f;
}

bool is_negative(const Formula& f) { return f.shape == Shape::sum && f.args.size() == 1 && f.minus[0]; }

// A frame by its name, from its x axis.
Formula frame_of(Expr x_axis) { return leaf(x_axis, x_axis->symbol.substr(0, x_axis->symbol.size() - 2)); }

std::vector<Formula> of_all(const Notation& notation, Expr e) {
  std::vector<Formula> args;
  for (const Expr arg : e->args) args.push_back(notation.of(arg));
  return args;
}

// Signs come out of products: u × (-v) is written -(u × v).
Formula pair(Shape shape, Formula u, Formula v) {
  const bool minus = is_negative(u) != is_negative(v);
  if (is_negative(u)) u = Formula(u.args[0]);
  if (is_negative(v)) v = Formula(v.args[0]);
  Formula f = of_form(shape, {std::move(u), std::move(v)});
  return minus ? negative(std::move(f)) : f;
}

}  // namespace

Formula leaf(Expr e, std::string name) {
  Formula f;
  f.shape = Shape::leaf;
  f.leaf = e;
  f.name = !name.empty() ? std::move(name) : e->kind == Kind::symbol ? e->symbol : e->name;
  return f;
}

Formula number(Rational value) {
  Formula f;
  f.number = value;
  return f;
}

Formula sum(std::vector<SignedFormula> terms) {
  if (terms.empty()) return number(0);
  if (terms.size() == 1 && !terms[0].minus) return std::move(terms[0].formula);
  Formula f;
  f.shape = Shape::sum;
  for (SignedFormula& term : terms) {
    // a + (b + c) is written a + b + c; a - (b + c) stays.
    const bool opens = term.formula.shape == Shape::sum && (!term.minus || is_negative(term.formula));
    for (SignedFormula& t : opens ? terms_of(term.formula) : std::vector{term}) {
      f.minus.push_back(t.minus != (opens && term.minus));
      f.args.push_back(std::move(t.formula));
    }
  }
  if (f.args.size() == 1 && !f.minus[0]) return f.args[0];
  return f;
}

Formula negative(Formula f) { return sum({{true, std::move(f)}}); }

Formula product(std::vector<Formula> factors) {
  std::vector<Formula> kept;
  bool minus = false;
  for (Formula& f : factors) {
    if (is_negative(f)) {
      minus = !minus;
      f = Formula(f.args[0]);
    }
    if (is_one(f)) continue;
    if (f.shape == Shape::product) kept.insert(kept.end(), f.args.begin(), f.args.end());
    else kept.push_back(std::move(f));
  }
  Formula result = kept.empty()       ? number(1)
                   : kept.size() == 1 ? std::move(kept[0])
                                      : of_form(Shape::product, std::move(kept));
  return minus ? negative(std::move(result)) : result;
}

Formula quotient(Formula above, Formula below) {
  if (is_one(below)) return above;
  if (is_negative(above)) return negative(quotient(above.args[0], std::move(below)));
  return of_form(Shape::quotient, {std::move(above), std::move(below)});
}

Formula power(Formula base, int exponent) {
  if (exponent == 1 || is_one(base)) return base;
  if (is_negative(base)) {
    Formula positive = power(base.args[0], exponent);
    return exponent % 2 == 0 ? positive : negative(std::move(positive));
  }
  Formula f = of_form(Shape::power, {std::move(base)});
  f.exponent = exponent;
  return f;
}

Formula dot(Formula u, Formula v) { return pair(Shape::dot, std::move(u), std::move(v)); }
Formula cross(Formula u, Formula v) { return pair(Shape::cross, std::move(u), std::move(v)); }

Formula shaped(Shape kind, Formula arg) {
  const bool odd = kind == Shape::perp || kind == Shape::transpose || kind == Shape::skew;
  if (odd && is_negative(arg)) return negative(of_form(kind, {arg.args[0]}));
  return of_form(kind, {std::move(arg)});
}

Formula times(Rational magnitude, Formula f) {
  if (magnitude.num() == 1) return quotient(std::move(f), number(magnitude.den()));
  if (f.shape == Shape::quotient) return quotient(times(magnitude, f.args[0]), f.args[1]);
  return product({number(magnitude), std::move(f)});
}

Formula component(Formula u, std::string axis) {
  Formula f = of_form(Shape::component, {std::move(u)});
  f.name = std::move(axis);
  return f;
}

std::vector<SignedFormula> positive_first(std::vector<SignedFormula> terms) {
  std::stable_partition(terms.begin(), terms.end(), [](const SignedFormula& term) { return !term.minus; });
  return terms;
}

bool same_terms(const Formula& f, const Formula& g) {
  std::vector<SignedFormula> left = terms_of(f), right = terms_of(g);
  return std::is_permutation(
      left.begin(), left.end(), right.begin(), right.end(),
      [](const SignedFormula& a, const SignedFormula& b) { return a.minus == b.minus && a.formula == b.formula; });
}

Formula identity() { return of_form(Shape::identity, {}); }

Formula matrix(int columns, std::vector<Formula> entries) {
  Formula f = of_form(Shape::matrix, std::move(entries));
  f.columns = columns;
  return f;
}

bool is_one(const Formula& f) { return f.shape == Shape::number && f.number == Rational(1); }

std::vector<SignedFormula> terms_of(const Formula& f) {
  if (f.shape != Shape::sum) return {{false, f}};
  std::vector<SignedFormula> terms;
  for (std::size_t i = 0; i < f.args.size(); ++i) terms.push_back({f.minus[i], f.args[i]});
  return terms;
}

std::string world_axis(Expr axis) {
  const std::vector<Expr> axes = world_axes(*axis->pool);
  for (std::size_t k = 0; k < axes.size(); ++k) {
    if (axis == axes[k]) return std::string(1, "xyz"[k]);
  }
  return "";
}

Notation::Notation(const Joint& joint) {
  for (const Parameter& p : joint.parameters) taken_.push_back(p.name);
  for (const Let& let : joint.lets) taken_.push_back(let.name);
  for (const Parameter& p : joint.parameters) {
    if (p.kind != ParameterKind::point || p.body < 0) continue;
    points_.push_back({p.name, body_symbols(joint, p.body).x, p.symbol, p.value});
  }
}

bool Notation::has_name(Expr e) { return !e->name.empty() && (e->named_by_let || e->name.ends_with("_dot")); }

void Notation::share(std::span<const Expr> roots) {
  shared_ = shared_parts(roots, &has_name);
  if (shared_.empty()) shared_ = recurring_parts(roots, &has_name);
  int number = 0;
  for (const Expr e : shared_) {
    std::string name;
    do name = "s" + std::to_string(++number);
    while (std::find(taken_.begin(), taken_.end(), name) != taken_.end());
    names_of_shared_.emplace(&*e, name);
  }
}

std::string Notation::shared_name(Expr e) const {
  const auto found = names_of_shared_.find(&*e);
  return found == names_of_shared_.end() ? "" : found->second;
}

Formula Notation::of(Expr e) const {
  if (const std::string name = shared_name(e); !name.empty()) return leaf(e, name);
  return has_name(e) && !is_zero(e) ? leaf(e) : written(e);
}
Formula Notation::definition(Expr e) const { return written(e); }

Formula Notation::written(Expr e) const {
  switch (e->kind) {
    case Kind::number: return e->value.sign() < 0 ? negative(number(-e->value)) : number(e->value);
    case Kind::symbol: return leaf(e);
    case Kind::sum: return sum_of(e);
    case Kind::product: return product_of(e);
    case Kind::scale: return scale_of(e);
    case Kind::dot: return dot_of(e);
    case Kind::cross: return cross_of(e);
    case Kind::perp: return shaped(Shape::perp, of(e->args[0]));
    case Kind::tensor: return product({of(e->args[0]), of(e->args[1])});
    case Kind::twist: {
      Formula f = of_form(Shape::call, {frame_of(e->args[0]), frame_of(e->args[3])});
      f.name = "twist";
      return f;
    }
    case Kind::norm: return shaped(Shape::norm, of(e->args[0]));
    case Kind::unit: return shaped(Shape::unit, of(e->args[0]));
    case Kind::function: break;
  }
  if (const auto angle = angle_between(e)) {
    Formula f = of_form(Shape::call, {of(angle->from), of(angle->to)});
    f.name = "angle";
    return f;
  }
  Formula f = of_form(Shape::call, of_all(*this, e));
  f.name = name_of(e->fn);
  return f;
}

Notation::PointTerms Notation::points_among(Expr sum) const {
  PointTerms found{std::vector<const Point*>(sum->args.size()), std::vector<bool>(sum->args.size())};
  for (std::size_t i = 0; i < sum->args.size(); ++i) {
    for (std::size_t j = 0; j < sum->args.size() && !found.at[i]; ++j) {
      if (found.used[j] || sum->coefs[i] != sum->coefs[j]) continue;
      for (const Point& point : points_) {
        if (point.position != sum->args[i] || point.arm != sum->args[j]) continue;
        found.at[i] = &point;
        found.used[j] = true;
        break;
      }
    }
  }
  return found;
}

// The divisor d of (c u - s v)/d, if all terms have the same; empty for others.
Expr shared_divisor(Expr sum) {
  Expr shared;
  for (const Expr arg : sum->args) {
    const Expr factor = arg->kind == Kind::scale ? arg->args[0] : arg;
    if (Notation::has_name(arg) || Notation::has_name(factor) || factor->kind != Kind::product) return {};
    Expr divisor = sum->pool->number(1);
    for (std::size_t i = 0; i < factor->args.size(); ++i)
      if (factor->exponents[i] < 0) divisor = divisor * pow(factor->args[i], -factor->exponents[i]);
    if (is_one(divisor) || (shared && divisor != shared)) return {};
    shared = divisor;
  }
  return sum->args.size() > 1 ? shared : Expr();
}

Formula Notation::sum_of(Expr e) const {
  if (const Expr divisor = shared_divisor(e)) {
    std::vector<Term> above;
    for (const Term& term : terms_of(e)) above.push_back({term.coef, divisor * term.e});
    return quotient(written(derive::sum(*e->pool, above, e->vector)), of(divisor));
  }
  const PointTerms points = points_among(e);
  std::vector<SignedFormula> terms;
  for (std::size_t i = 0; i < e->args.size(); ++i) {
    if (points.used[i]) continue;
    const Rational c = e->coefs[i];
    Formula f = points.at[i]         ? leaf(points.at[i]->value, points.at[i]->name)
                : is_one(e->args[i]) ? number(1)
                                     : of(e->args[i]);
    const bool minus = is_negative(f);
    if (minus) f = Formula(f.args[0]);
    f = is_one(f) ? number(abs(c)) : times(abs(c), std::move(f));
    terms.push_back({(c.sign() < 0) != minus, std::move(f)});
  }
  return sum(positive_first(std::move(terms)));
}

Formula Notation::product_of(Expr e) const {
  std::vector<Formula> above, below;
  for (std::size_t i = 0; i < e->args.size(); ++i) {
    const int k = e->exponents[i];
    (k > 0 ? above : below).push_back(power(of(e->args[i]), k > 0 ? k : -k));
  }
  return quotient(product(std::move(above)), product(std::move(below)));
}

// The component along an axis of the world is written u.x; a direction comes first, as in n · u.
Formula Notation::dot_of(Expr e) const {
  const Expr u = e->args[0], v = e->args[1];
  if (const std::string axis = world_axis(u); !axis.empty()) return component(of(v), axis);
  if (const std::string axis = world_axis(v); !axis.empty()) return component(of(u), axis);
  for (const auto& [other, tensor] : {std::pair{u, v}, std::pair{v, u}}) {
    if (tensor->kind != Kind::tensor || Notation::has_name(tensor)) continue;
    return product({shaped(Shape::transpose, of(other)), of(tensor->args[0]), of(tensor->args[1])});
  }
  const Formula left = of(u);
  if (u == v && left.shape != Shape::leaf) return power(shaped(Shape::norm, left), 2);
  return v->unit_length && !u->unit_length ? dot(of(v), left) : dot(left, of(v));
}

// The normal form has the arm first; -(r × w) is written w × r.
Formula Notation::cross_of(Expr e) const {
  const Expr u = e->args[0], v = e->args[1];
  const bool turns = v->kind == Kind::symbol && v->role == Role::spin;
  return turns ? negative(cross(of(v), of(u))) : cross(of(u), of(v));
}

// w perp(r) is written w × r.
Formula Notation::scale_of(Expr e) const {
  const Expr s = e->args[0], u = e->args[1];
  const bool turns = s->kind == Kind::symbol && s->role == Role::spin && u->kind == Kind::perp;
  if (turns) return cross(of(s), of(u->args[0]));
  return product({of(s), of(u)});
}

Expr value_of(const Formula& f, Pool& pool) {
  std::vector<Expr> args;
  for (const Formula& arg : f.args) args.push_back(value_of(arg, pool));
  switch (f.shape) {
    case Shape::leaf: return f.leaf;
    case Shape::number: return pool.number(f.number);
    case Shape::sum: {
      Expr total = f.minus[0] ? -args[0] : args[0];
      for (std::size_t i = 1; i < args.size(); ++i) {
        total = f.minus[i] ? total - args[i] : total + args[i];
      }
      return total;
    }
    case Shape::product: {
      Expr total = args[0];
      for (std::size_t i = 1; i < args.size(); ++i) total = total * args[i];
      return total;
    }
    case Shape::quotient: return args[0] / args[1];
    case Shape::power: return pow(args[0], f.exponent);
    case Shape::dot: return dot(args[0], args[1]);
    case Shape::cross: return cross(args[0], args[1]);
    case Shape::perp: return perp(args[0]);
    case Shape::norm: return norm(args[0]);
    case Shape::unit: return unit(args[0]);
    case Shape::component: return dot(world_axes(pool)[static_cast<std::size_t>(f.name[0] - 'x')], args[0]);
    default: break;
  }
  if (f.shape == Shape::call && f.name == "angle") {
    const Expr sine = cross(args[0], args[1]);
    return call(Fn::atan2, std::vector{sine->vector ? norm(sine) : sine, dot(args[0], args[1])});
  }
  if (const Function* function = function_named(f.name); function && f.shape == Shape::call)
    return call(function->fn, args);
  throw std::logic_error("a matrix has no scalar or vector value");
}

}  // namespace cdot::derive
