#include "derive/language/evaluate.hpp"

#include <algorithm>

#include "derive/expression/symbols.hpp"
#include "derive/syntax/lexer.hpp"

namespace cdot::derive {
namespace {

constexpr int largest_power = 64;
constexpr int largest_total_power = 1000;  // of a factor, after products have been joined

bool is_literal_zero(const Ast& ast) { return ast.kind == Ast::Kind::number && ast.value.is_zero() && !ast.unit; }

bool powers_too_large(Expr e) {
  return e->kind == Kind::product &&
         std::any_of(e->exponents.begin(), e->exponents.end(), [](int n) { return std::abs(n) > largest_total_power; });
}

// Lengths or masses went in and cancelled: an arc over its radius counts as an angle where one is needed.
bool is_ratio(const Unit& result, const std::vector<Value>& factors) {
  if (!result.m.is_zero() || !result.kg.is_zero() || !result.rad.is_zero()) return false;
  return std::any_of(factors.begin(), factors.end(), [](const Value& f) {
    return f.ratio || (f.unit && (!f.unit->m.is_zero() || !f.unit->kg.is_zero()));
  });
}

std::string fix_of_units(const Value& a, const Value& b) {
  const Unit number{}, length{.m = 1}, angle{.rad = 1};
  const auto are = [&](const Unit& x, const Unit& y) {
    return (*a.unit == x && *b.unit == y) || (*a.unit == y && *b.unit == x);
  };
  if (are(length, angle)) return "an arc is radius times angle: multiply the angle by a radius";
  if (*a.unit == Unit{} / *b.unit && *a.unit != number)
    return "a unit belongs to the number before it: in place of pi/2 [rad] write pi/2 * 1 [rad]";
  const Value& plain = *a.unit == number ? a : b;
  if (are(number, angle) && plain.e->kind != Kind::number) return "multiply it by 1 [rad]";
  if (are(number, angle)) return "give the number its unit, as in 1.5 [rad] or 90 [deg]";
  if (are(number, length)) return "give the number its unit, as in 2 [m], or the parameter, as in vector d [m] on a";
  if (are(length, {.m = 2})) return "take the root of one side, or square the other";
  return "only quantities with the same unit can be added or compared";
}

}  // namespace

Value Evaluator::error(Span where, std::string message, std::string fix, std::vector<Span> also) {
  findings_.error(where, std::move(message), std::move(fix), std::move(also));
  return {};
}

void Evaluator::unit_error(Span where, std::string message, std::string fix, std::vector<Span> also) {
  if (hand_) findings_.warning(where, std::move(message), std::move(fix), std::move(also));
  else diagnostics_.error(where, std::move(message), std::move(fix), std::move(also));
}

Value Evaluator::operator()(const Ast& ast) {
  try {
    return evaluate(ast);
  } catch (const NumberTooLarge&) {
    return error(ast.where, "a number in this expression exceeds exact 64-bit arithmetic",
                 "use smaller numbers, or a scalar parameter");
  }
}

Value Evaluator::evaluate(const Ast& ast) {
  switch (ast.kind) {
    case Ast::Kind::broken: return {};
    case Ast::Kind::number: return number(ast);
    case Ast::Kind::name: return name(ast);
    case Ast::Kind::call: return call(ast);
    case Ast::Kind::sum: return sum(ast);
    case Ast::Kind::product: return product(ast);
    case Ast::Kind::power: return power(ast);
    case Ast::Kind::member: return member(ast);
    case Ast::Kind::transpose: return transpose(ast);
    case Ast::Kind::matrix: return matrix(ast);
    case Ast::Kind::negate: {
      const Value v = plain(ast.args[0], "has no negative");
      if (v.type == Type::poison) return v;
      if (v.type == Type::point)
        return error(ast.where, "a point has no negative", "a difference of points is a vector: pa - pb");
      return add({v}, "-", {ast.args[0].where});
    }
  }
  return {};
}

Value Evaluator::number(const Ast& ast) {
  Value v = scalar(pool_.number(ast.value));
  if (is_literal_zero(ast)) {
    v.unit.reset();
    v.zero = true;
  }
  if (!ast.unit) return v;
  v.unit = ast.unit->unit;
  if (ast.unit->degrees == 0) return v;
  return scalar(v.e * pow(pi_symbol(pool_) / pool_.number(180), ast.unit->degrees), v.unit);
}

Value Evaluator::name(const Ast& ast) {
  if (const Value* known = names_.find(ast.text)) return *known;
  if (ast.text == "time") return scalar(time_symbol(pool_), Unit{.s = 1});
  if (ast.text == "pi") return scalar(pi_symbol(pool_), Unit{});
  const int body = names_.body(ast.text);
  if (body < 0 && ast.text != "world") return unknown(ast, false);
  Value v;
  v.type = Type::body;
  v.body = body;
  return v;
}

Value Evaluator::unknown(const Ast& ast, bool called) {
  std::string fix = called ? suggested_operator(ast.text) : names_.hint(ast.text);
  const std::string near = called ? "" : nearest(ast.text, names_.known());
  if (fix.empty() && !near.empty()) fix = "did you mean " + quote(near) + "?";
  if (fix.empty() && !called && ast.text == "t") fix = "did you mean `time`?";
  if (fix.empty() && !called && is_operator(ast.text))
    fix = "it is an operator: " + std::string(operators_named(ast.text)[0]->signature);
  if (fix.empty() && called && names_.find(ast.text))
    fix = quote(ast.text) + " is not an operator; for a product write *";
  if (fix.empty())
    fix = called  ? "`cdot check --help` lists the operators"
          : hand_ ? "declare it with let or free"
                  : "declare it with point, vector, unit, frame, scalar or let";
  const Span where = {ast.where.begin, ast.where.begin + static_cast<int>(ast.text.size())};
  diagnostics_.error(where, (called ? "there is no operator " : "there is no ") + quote(ast.text), fix);
  return {};
}

// Operands of sums and products. In a hand derivation a point is a vector.
Value Evaluator::plain(const Ast& ast, std::string_view use) {
  Value v = (*this)(ast);
  if (hand_ && v.type == Type::point) v = vector(v.e, v.unit);
  if (v.type == Type::body && v.body >= 0)
    return error(ast.where, "a body " + std::string(use),
                 "write x(" + ast.text + ") for its centre of mass, angle(" + ast.text + ") for its angle");
  if (v.type == Type::body)
    return error(ast.where, "the world " + std::string(use), "its axes are world.x and world.y");
  if (v.type == Type::frame)
    return error(ast.where, "a frame " + std::string(use), "its axes are " + ast.text + ".x and " + ast.text + ".y");
  return v;
}

Value Evaluator::sum(const Ast& ast) {
  std::vector<Value> terms;
  std::vector<Span> parts;
  bool poisoned = false;
  for (const Ast& a : ast.args) {
    terms.push_back(plain(a, "cannot be added"));
    parts.push_back(a.where);
    poisoned |= terms.back().type == Type::poison;
  }
  if (poisoned) return {};
  return add(terms, ast.ops, parts);
}

Value Evaluator::add(const std::vector<Value>& terms, const std::string& signs, const std::vector<Span>& parts,
                     std::string_view relation) {
  const auto is_matrix = [](const Value& v) { return v.type == Type::matrix; };
  if (std::any_of(terms.begin(), terms.end(), is_matrix)) return matrix_sum(terms, signs, parts);
  Value total;
  std::vector<Term> sums;
  std::size_t known = 0;  // the first term with a unit
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const Value& next = terms[i];
    if (i > 0 && !add_types(total, next, signs[i], parts[i], parts[0])) return {};
    if (i == 0) total = next;
    if (!terms[known].unit) known = i;
    if (!same_unit(terms[known], next, hand_)) {
      const std::string a = spoken(*terms[known].unit), b = spoken(*next.unit);
      const std::string what = relation.empty()
                                   ? signs[i] == '-' ? "subtracts " + b + " from " + a : "adds " + b + " to " + a
                                   : std::string(relation) + a + " and " + b;
      unit_error(parts[i], what, fix_of_units(terms[known], next), {parts[known]});
      if (!hand_) return {};
    }
    if (next.unit && (!total.unit || (total.ratio && !next.ratio))) {
      total.unit = next.unit;
      total.ratio = next.ratio;
    }
    if (!next.zero || terms.size() == 1) sums.push_back({Rational(signs[i] == '-' ? -1 : 1), next.e});
  }
  total.e = cdot::derive::sum(pool_, sums, total.type != Type::scalar);
  if (terms.size() > 1 || signs[0] == '-') {
    total.anchored = false;
    total.zero = total.zero && is_zero(total.e);
  }
  return total;
}

// Gives `total` the type of total +- next.
bool Evaluator::add_types(Value& total, const Value& next, char sign, Span part, Span first) {
  const auto both = [&](Type a, Type b) { return total.type == a && next.type == b; };
  const bool minus = sign == '-';
  if (both(Type::point, Type::point) && !minus) {
    error(part, "a point cannot be added to a point",
          "subtract points to get a vector; the middle of two is pa + (pb - pa) / 2", {first});
    return false;
  }
  if (both(Type::vector, Type::point) && minus) {
    error(part, "a point cannot be subtracted from a vector", "write point - point, or point - vector", {first});
    return false;
  }
  if (next.type == Type::point && total.type != Type::scalar)
    total.type = total.type == Type::point ? Type::vector : Type::point;
  if (total.zero && next.type == Type::vector) {
    total.type = Type::vector;
    total.along = next.along;
  } else if (next.zero && total.type == Type::vector) {
    return true;
  } else if ((total.type == Type::scalar) != (next.type == Type::scalar)) {
    error(part,
          "a number and " + std::string(in_words(total.type == Type::scalar ? next.type : total.type)) +
              " cannot be added or compared",
          "take a component of the vector with dot(u, n), u.x or u.y, or its length with norm(u)", {first});
    return false;
  }
  if (total.type != Type::scalar && next.along != total.along) {
    error(part, "components along a frame and along other axes are mixed",
          "bring both sides into one frame with local(u, f)", {first});
    return false;
  }
  return true;
}

Value Evaluator::product(const Ast& ast) {
  std::vector<Value> factors;
  bool poisoned = false, matrices = false;
  for (const Ast& a : ast.args) {
    factors.push_back(plain(a, "cannot be multiplied"));
    poisoned |= factors.back().type == Type::poison;
    matrices |= factors.back().type == Type::matrix;
  }
  if (poisoned) return {};
  if (matrices) return matrix_product(factors, ast);
  return scaled(factors, ast);
}

// Numbers and at most one vector.
Value Evaluator::scaled(const std::vector<Value>& factors, const Ast& ast) {
  std::vector<Expr> numbers;
  std::vector<int> powers;
  const Value* direction = nullptr;
  Span first_vector;
  Value result = scalar(Expr(), Unit{});
  for (std::size_t i = 0; i < factors.size(); ++i) {
    const Value& f = factors[i];
    const Span where = ast.args[i].where;
    const bool divide = ast.ops[i] == '/';
    if (f.type == Type::point)
      return error(where, "a point cannot be multiplied or divided",
                   "subtract another point first: the difference is a vector");
    if (f.type == Type::vector && divide)
      return error(where, "nothing can be divided by a vector", "divide by its length, norm(u)");
    if (f.type == Type::vector && direction)
      return error(where, "the product of two vectors is ambiguous", "write dot(u, v) or cross(u, v)", {first_vector});
    if (divide && is_zero(f.e)) return error(where, "division by zero");
    if (!f.unit) result.unit.reset();
    if (f.unit && result.unit) result.unit = divide ? *result.unit / *f.unit : *result.unit * *f.unit;
    if (f.type == Type::vector) {
      direction = &f;
      first_vector = where;
    } else {
      numbers.push_back(f.e);
      powers.push_back(divide ? -1 : 1);
    }
  }
  result.ratio = result.unit && is_ratio(*result.unit, factors);
  result.e = cdot::derive::product(pool_, numbers, powers);
  if (powers_too_large(split_coefficient(result.e).e))
    return error(ast.where, "the exponent of a factor exceeds 1000", "simplify the formula");
  if (!direction) return result;
  result.type = Type::vector;
  result.e = result.e * direction->e;
  result.along = direction->along;
  return result;
}

Value Evaluator::power(const Ast& ast) {
  const Value base = plain(ast.args[0], "has no powers");
  const Value exponent = plain(ast.args[1], "cannot be an exponent");
  if (base.type == Type::poison || exponent.type == Type::poison) return {};
  const Expr n = exponent.e;
  if (exponent.type != Type::scalar || n->kind != Kind::number || !n->value.is_integer() ||
      abs(n->value) > Rational(largest_power))
    return error(ast.args[1].where, "an exponent must be a whole number, at most 64",
                 "for a root write sqrt(...), for other powers exp(s * log(...))");
  if (exponent.unit && *exponent.unit != Unit{})
    return error(ast.args[1].where, "an exponent is a pure number, not in " + spoken(*exponent.unit));
  const int power = static_cast<int>(n->value.num());
  if (base.type == Type::matrix) return matrix_power(base, power, ast);
  if (base.type != Type::scalar)
    return error(ast.args[0].where, std::string(in_words(base.type)) + " has no powers",
                 "for the square of a vector write dot(u, u)");
  if (power <= 0 && is_zero(base.e)) return error(ast.where, power == 0 ? "0^0 has no value" : "division by zero");
  const Expr inner = split_coefficient(base.e).e;
  const bool large = inner->kind == Kind::product && power != 0 &&
                     std::any_of(inner->exponents.begin(), inner->exponents.end(),
                                 [&](int k) { return std::abs(k) > largest_total_power / std::abs(power); });
  if (large) return error(ast.where, "the exponent of a factor exceeds 1000", "simplify the formula");
  Value result = scalar(pow(base.e, power));
  result.ratio = base.ratio;
  result.unit.reset();
  if (base.unit) result.unit = pow(*base.unit, power);
  return result;
}

Value Evaluator::member(const Ast& ast) {
  const Value v = (*this)(ast.args[0]);
  if (v.type == Type::poison) return {};
  const std::size_t index = ast.text.size() == 1 ? std::string("xyz").find(ast.text) : std::string::npos;
  if (index >= static_cast<std::size_t>(pool_.dimension()))
    return error(ast.where, "there is no component " + quote(ast.text),
                 pool_.dimension() == 2 ? "in the plane the components are .x and .y"
                                        : "in space the components are .x, .y and .z");
  if (v.type == Type::frame) return vector(v.axes[index]);
  if (v.type == Type::body) {
    if (v.body < 0) names_.use_world();
    else names_.use_body(v.body, ast.where);
    return vector(body_axes(pool_, v.body)[index]);
  }
  if (v.type == Type::vector) {
    Value result = scalar(component(v.e, index), v.unit);
    result.ratio = v.ratio;
    return result;
  }
  if (v.type == Type::point) {
    const Ast& of = ast.args[0];
    const bool call = of.kind == Ast::Kind::call && of.args.size() == 1;
    const std::string point = of.kind == Ast::Kind::name ? of.text : call ? of.text + "(" + of.args[0].text + ")" : "p";
    const bool declared = names_.find("origin") != nullptr;
    return error(ast.where, "a point has no components",
                 std::string("a vector has: ") + (declared ? "" : "declare `point origin on world` and ") + "write `(" +
                     point + " - origin)." + ast.text + "`");
  }
  return error(ast.where, std::string(in_words(v.type)) + " has no component " + ast.text);
}

}  // namespace cdot::derive
