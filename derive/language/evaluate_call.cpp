// Calls of operators: the table's row that fits the arguments, its unit rule, and the error if none fits.
#include <algorithm>
#include <fmt/format.h>
#include <map>

#include "derive/expression/sign.hpp"
#include "derive/expression/symbols.hpp"
#include "derive/language/evaluate.hpp"
#include "derive/syntax/lexer.hpp"

namespace cdot::derive {
namespace {

// Of a root of what is never positive, or of such a logarithm: the argument in words, and the fix; else empty.
std::pair<std::string, std::string> missing_domain(const Operator& o, const std::vector<Value>& arguments) {
  const bool root = o.name == "sqrt";
  if ((!root && o.name != "log") || arguments.size() != 1 || !arguments[0].e) return {};
  const Expr e = arguments[0].e;
  if (e->kind != Kind::number)
    return is_never_negative(-e)
               ? std::pair("never positive", fmt::format("give {} an argument that can be positive", o.name))
               : std::pair<std::string, std::string>{};
  const int sign = e->value.sign();
  if (sign > 0 || (root && sign == 0)) return {};
  return {e->value.text(), root ? "give sqrt an argument of 0 or more" : "give log an argument above 0"};
}

unsigned bit_of(const Value& v, bool hand) {
  switch (v.type) {
    case Type::scalar: return number_ | (v.zero ? vector_ : 0u);
    case Type::vector: return vector_;
    case Type::point: return (v.anchored ? point_ : 0u) | (hand ? vector_ : 0u);
    case Type::body: return v.body < 0 ? world_ : body_;
    case Type::frame: return frame_;
    case Type::matrix: return matrix_;
    case Type::poison: return 0;
  }
  return 0;
}

bool fits(const Operator& o, const std::vector<Value>& arguments, bool hand) {
  if (o.takes.size() != arguments.size()) return false;
  for (std::size_t i = 0; i < arguments.size(); ++i)
    if ((o.takes[i] & bit_of(arguments[i], hand)) == 0) return false;
  return true;
}

std::string takes_in_words(unsigned takes) {
  std::string out;
  const auto add = [&](unsigned bit, std::string_view word) {
    if ((takes & bit) != 0) out += (out.empty() ? "" : " or ") + std::string(word);
  };
  add(number_, "a number");
  add(vector_, "a vector");
  add(point_, "a declared point");
  add(frame_, "a frame");
  add(body_, "a body");
  return out;
}

std::string signatures(const std::vector<const Operator*>& candidates) {
  std::string out;
  for (const Operator* o : candidates)
    out += (out.empty() ? "" : "; ") + std::string(o->signature) + ": " + std::string(o->help);
  return out;
}

std::string given_in_words(const Value& v) {
  if (v.type == Type::body && v.body < 0) return "the world";
  if (v.type == Type::point && !v.anchored) return "a computed point, which belongs to no body";
  return std::string(in_words(v.type));
}

std::optional<Unit> unit_given(UnitGiven given, const std::vector<Value>& a) {
  switch (given) {
    case UnitGiven::product: {
      Unit u;
      for (const Value& v : a) {
        if (!v.unit) return {};
        u = u * *v.unit;
      }
      return u;
    }
    case UnitGiven::same: return a[0].unit;
    case UnitGiven::root:
      if (!a[0].unit) return {};
      return pow(*a[0].unit, Rational(1, 2));
    case UnitGiven::number: return Unit{};
    case UnitGiven::radians: return Unit{.rad = 1};
    case UnitGiven::metres: return Unit{.m = 1};
    case UnitGiven::speed: return Unit{.m = 1, .s = -1};
    case UnitGiven::spin: return Unit{.rad = 1, .s = -1};
    case UnitGiven::mass: return Unit{.kg = 1};
    case UnitGiven::inertia: return Unit{.m = 2, .kg = 1};
  }
  return {};
}

}  // namespace

// A column of two is a vector to an operator, a matrix of one entry a number. An inertia stays what it is: its numbers
// are those of its inverse.
Value Evaluator::hand_argument(Value v) { return v.type == Type::matrix && !v.tensor ? simplest(*v.matrix, true) : v; }

std::vector<const Operator*> Evaluator::operators_here(const std::string& name) const {
  std::vector<const Operator*> here;
  for (const Operator* o : operators_named(name))
    if (o->is_of(pool_.dimension())) here.push_back(o);
  return here;
}

// The error for an operator of the other space.
Value Evaluator::elsewhere(const Ast& ast) {
  const bool plane = pool_.dimension() == 2;
  static const std::map<std::string_view, std::string_view> instead = {
      {"perp", "in space a direction across u is an axis of a frame, f.y, or cross(n, u)"},
      {"angle", "in space: angle(u, v, n) about an axis, angle(u, v), or twist(f, g)"}};
  const auto fix = instead.find(ast.text);
  return error(ast.where,
               quote(operators_named(ast.text)[0]->signature) + " is an operator of " + (plane ? "space" : "the plane"),
               fix == instead.end() ? "" : std::string(fix->second));
}

Value Evaluator::call(const Ast& ast) {
  const bool of_name = ast.args.size() == 1 && ast.args[0].kind == Ast::Kind::name;
  if (of_name && (ast.text == "rate" || ast.text == "v"))
    if (const Value* rate = names_.rate_of(ast.args[0].text)) return *rate;
  if (of_name && ast.text == "load" && !hand_) {
    if (const Value* load = names_.load_of(ast.args[0].text)) return *load;
    return error(
        ast.args[0].where, quote(ast.args[0].text) + " is no row whose load may stand here",
        "bounds of a force name a row before it, or in an effect on a coordinate `joint`; events name their row");
  }
  if (of_name && ast.text == "mass")
    if (const Value* mass = names_.mass_of(ast.args[0].text)) return *mass;
  const auto candidates = operators_here(ast.text);
  std::vector<Value> arguments;
  bool poisoned = false;
  for (const Ast& a : ast.args) {
    arguments.push_back(hand_argument((*this)(a)));
    poisoned |= arguments.back().type == Type::poison;
  }
  if (candidates.empty()) return is_operator(ast.text) ? elsewhere(ast) : unknown(ast, true);
  if (!hand_ && candidates[0]->where == Operator::Where::hand)
    return error(ast.where, quote(ast.text) + " is for .hand files only",
                 "a spec contains positions and velocities only; the solver knows the masses");
  if (poisoned) return {};
  for (const Operator* o : candidates)
    if (fits(*o, arguments, hand_)) return apply(*o, arguments, ast);
  return wrong_arguments(arguments, ast);
}

Value Evaluator::wrong_arguments(const std::vector<Value>& arguments, const Ast& ast) {
  const auto candidates = operators_here(ast.text);
  const std::string help = signatures(candidates);
  const auto right_count = std::find_if(candidates.begin(), candidates.end(),
                                        [&](const Operator* o) { return o->takes.size() == arguments.size(); });
  if (right_count == candidates.end()) {
    diagnostics_.error(ast.where,
                       quote(ast.text) + " takes " + std::to_string(candidates[0]->takes.size()) +
                           (candidates.back()->takes.size() != candidates[0]->takes.size()
                                ? " or " + std::to_string(candidates.back()->takes.size())
                                : "") +
                           (candidates.back()->takes.size() == 1 ? " argument" : " arguments") + ", not " +
                           std::to_string(arguments.size()),
                       help);
    return {};
  }
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    unsigned allowed = 0;
    for (const Operator* c : candidates)
      if (c->takes.size() == arguments.size()) allowed |= c->takes[i];
    if ((allowed & bit_of(arguments[i], hand_)) != 0) continue;
    const bool subtract = arguments[i].type == Type::point && (allowed & vector_) != 0;
    return error(ast.args[i].where,
                 quote(ast.text) + " takes " + takes_in_words(allowed) + " here, not " + given_in_words(arguments[i]),
                 subtract ? "a difference of points is a vector: pa - pb; the arm of a point: arm(pa)" : help);
  }
  return error(ast.where, quote(ast.text) + " is not defined for these arguments", help);
}

Value Evaluator::apply(const Operator& o, const std::vector<Value>& arguments, const Ast& ast) {
  const Value* first_vector = nullptr;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const Value& a = arguments[i];
    if (a.type == Type::body && a.body >= 0) names_.use_body(a.body, ast.args[i].where);
    if (a.type == Type::body && a.body < 0) names_.use_world();
    if (a.type != Type::vector) continue;
    if (first_vector && first_vector->along != a.along)
      return error(ast.where, "components along a frame and along other axes are mixed",
                   "bring both vectors into one frame with local(u, f)");
    first_vector = &a;
  }
  if (o.name == "local" && first_vector && !first_vector->along.empty())
    return error(ast.args[0].where, "these are components along a frame already");
  std::vector<Value> built = arguments;
  for (std::size_t i = 0; i < built.size(); ++i)
    if (built[i].zero && (o.takes[i] & number_) == 0) built[i] = vector(zero_vector(pool_), {});
    else if (built[i].type == Type::point && (o.takes[i] & point_) == 0) built[i] = vector(built[i].e, built[i].unit);
  if (o.name == "arm" && arguments[0].body < 0)
    return error(ast.args[0].where, "a point of the world has no arm: the world has no centre of mass",
                 "subtract two points instead");
  const auto rule = unit_of_call(o, built, ast);
  if (!rule) return {};
  if (const auto [argument, fix] = missing_domain(o, built); !fix.empty())
    return error(ast.args[0].where, fmt::format("{} has no value at any pose: its argument is {}", o.name, argument),
                 fix);
  Value result = o.build(pool_, built);
  result.unit = rule->unit;
  result.ratio = rule->ratio;
  if (result.type == Type::vector && first_vector && result.along.empty()) {
    result.along = first_vector->along;
  }
  return result;
}

// The unit that the table's rule gives, as the unit of a Value; empty if the arguments' units are wrong.
std::optional<Value> Evaluator::unit_of_call(const Operator& o, const std::vector<Value>& a, const Ast& ast) {
  const auto need = [&](std::initializer_list<Unit> allowed, std::string_view what, std::string fix) {
    if (!a[0].unit || std::find(allowed.begin(), allowed.end(), *a[0].unit) != allowed.end()) return true;
    unit_error(ast.args[0].where, quote(o.name) + " takes " + std::string(what) + ", not " + spoken(*a[0].unit),
               std::move(fix));
    return hand_;
  };
  if (o.unit.needs == UnitNeed::angle &&
      !need({Unit{}, Unit{.rad = 1}}, "an angle",
            a[0].unit == Unit{.s = 1} ? "multiply by a rate, as in 2 [rad/s] * time"
                                      : "divide by a quantity of that unit, such as a wavelength"))
    return {};
  if (o.unit.needs == UnitNeed::number &&
      !need({Unit{}, Unit{.rad = 1}}, "a pure number", "divide by a quantity of that unit"))
    return {};
  if (o.unit.needs == UnitNeed::equal && !same_unit(a[0], a[1], hand_)) {
    unit_error(
        ast.args[1].where,
        quote(o.name) + " takes two quantities of one unit, not " + spoken(*a[0].unit) + " and " + spoken(*a[1].unit),
        "", {ast.args[0].where});
    if (!hand_) return {};
  }
  Value v = scalar(Expr(), unit_given(o.unit.gives, a));
  const bool keeps = o.unit.gives == UnitGiven::same || o.unit.gives == UnitGiven::root;
  v.ratio = keeps && a[0].ratio;
  return v;
}

}  // namespace cdot::derive
