// The functions of the language, a row each. Whoever adds one writes its name and its row here, names it in
// specs/README.md and calls it once in tests/derive/language/expressions_test.cpp; everything else reads this table.
#pragma once

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>

#include "derive/expression/expr.hpp"
#include "derive/expression/unit.hpp"

namespace cdot::derive {

// The last three arise only after differentiation, in components (expression/components.hpp). inverse(x) is 1/x, and 0
// at x = 0. select(l, x, y) is x where l > 0, else y. pivot(d, k) is 1/d, and 0 where d is negligible beside the
// diagonal entry k that elimination started from.
enum class Fn : int { sqrt, sin, cos, tan, sinh, cosh, exp, log, abs, sign, atan2, inverse, select, pivot };

struct Function {
  Fn fn;
  std::string_view name;                                       // in specs, in formulas and in kernels
  std::string_view signature{};                                // "sin(s)"; empty: no operator of the language
  UnitRule unit{};                                             // of that operator
  std::string_view help{};                                     // one line for people
  double (*value)(const double* x);                            // in doubles, as a kernel computes
  std::optional<Rational> (*of_number)(Rational x) = nullptr;  // where the result is rational
  // f(x) by other functions, for arithmetic without f: GiNaC's, and exact numbers modulo a prime. Null: both have f
  // (proof/ginac_functions.cpp, numbers/modular_point.cpp).
  Expr (*by_others)(Expr x) = nullptr;
  Expr (*derivative)(Expr f) = nullptr;  // f'(x) for the node f = f(x); null: it has several arguments, or none is due
  std::string_view rule{};               // the derivative as a sentence: "sin(x)_dot = cos(x) x_dot"
  std::string_view limit{};              // limit of the domain of f or f', for a reader of the derivation; {} is x
  std::string_view finding{};            // the same for the author of a spec
  struct Cost {
    int multiply = 0, divide = 0, root = 0, compare = 0, call = 0;
  } cost{.call = 1};
  bool of_contract = false;  // kernel.hpp has it, <cmath> does not
  bool guard = false;        // arises only after differentiation
  std::string_view code{};   // in C++; empty: name(x, ...)
};

namespace functions_detail {

// A pivot counts as round-off below this share of the diagonal entry that elimination started from.
inline constexpr double negligible = 16 * std::numeric_limits<double>::epsilon();

inline Expr of(Fn fn, Expr f) { return call(fn, f->args[0]); }
inline Expr one(Expr e) { return e->pool->number(1); }
// Zero goes to `of_zero`.
template <int of_zero>
std::optional<Rational> at_zero(Rational x) {
  return x.is_zero() ? std::optional(Rational(of_zero)) : std::nullopt;
}

}  // namespace functions_detail

// clang-format off
inline constexpr Function functions[] = {
    {.fn = Fn::sqrt, .name = "sqrt", .signature = "sqrt(s)", .unit = {UnitNeed::any, UnitGiven::root}, .help = "square root",
     .value = [](const double* x) { return std::sqrt(*x); },
     .of_number = [](Rational x) { return x.is_zero() || x == Rational(1) ? std::optional(x) : std::nullopt; },
     .derivative = [](Expr f) { return Rational(1, 2) * pow(f, -1); },
     .rule = "sqrt(x)_dot = x_dot/(2 sqrt(x))",
     .limit = "sqrt is defined for {} ≥ 0 only.",
     .finding = "where {} < 0 its root is not a number; no guard",
     .cost = {.root = 1}},
    {.fn = Fn::sin, .name = "sin", .signature = "sin(s)", .unit = {UnitNeed::angle, UnitGiven::number}, .help = "sine of an angle",
     .value = [](const double* x) { return std::sin(*x); },
     .of_number = functions_detail::at_zero<0>,
     .derivative = [](Expr f) { return functions_detail::of(Fn::cos, f); },
     .rule = "sin(x)_dot = cos(x) x_dot"},
    {.fn = Fn::cos, .name = "cos", .signature = "cos(s)", .unit = {UnitNeed::angle, UnitGiven::number}, .help = "cosine of an angle",
     .value = [](const double* x) { return std::cos(*x); },
     .of_number = functions_detail::at_zero<1>,
     .derivative = [](Expr f) { return -functions_detail::of(Fn::sin, f); },
     .rule = "cos(x)_dot = -sin(x) x_dot"},
    {.fn = Fn::tan, .name = "tan", .signature = "tan(s)", .unit = {UnitNeed::angle, UnitGiven::number}, .help = "tangent of an angle",
     .value = [](const double* x) { return std::tan(*x); },
     .of_number = functions_detail::at_zero<0>,
     .by_others = [](Expr x) { return call(Fn::sin, x) / call(Fn::cos, x); },
     .derivative = [](Expr f) { return functions_detail::one(f) + pow(f, 2); },
     .rule = "tan(x)_dot = (1 + tan(x)^2) x_dot",
     .limit = "tan has poles where {} is an odd multiple of pi/2.",
     .finding = "tan({}) has poles at odd multiples of pi/2; no guard"},
    {.fn = Fn::sinh, .name = "sinh", .signature = "sinh(s)", .unit = {UnitNeed::number, UnitGiven::number}, .help = "hyperbolic sine",
     .value = [](const double* x) { return std::sinh(*x); },
     .of_number = functions_detail::at_zero<0>,
     .by_others = [](Expr x) { return Rational(1, 2) * (call(Fn::exp, x) - call(Fn::exp, -x)); },
     .derivative = [](Expr f) { return functions_detail::of(Fn::cosh, f); },
     .rule = "sinh(x)_dot = cosh(x) x_dot"},
    {.fn = Fn::cosh, .name = "cosh", .signature = "cosh(s)", .unit = {UnitNeed::number, UnitGiven::number}, .help = "hyperbolic cosine",
     .value = [](const double* x) { return std::cosh(*x); },
     .of_number = functions_detail::at_zero<1>,
     .by_others = [](Expr x) { return Rational(1, 2) * (call(Fn::exp, x) + call(Fn::exp, -x)); },
     .derivative = [](Expr f) { return functions_detail::of(Fn::sinh, f); },
     .rule = "cosh(x)_dot = sinh(x) x_dot"},
    {.fn = Fn::exp, .name = "exp", .signature = "exp(s)", .unit = {UnitNeed::number, UnitGiven::number}, .help = "e to the power s",
     .value = [](const double* x) { return std::exp(*x); },
     .of_number = functions_detail::at_zero<1>,
     .derivative = [](Expr f) { return f; },
     .rule = "exp(x)_dot = exp(x) x_dot"},
    {.fn = Fn::log, .name = "log", .signature = "log(s)", .unit = {UnitNeed::number, UnitGiven::number}, .help = "natural logarithm",
     .value = [](const double* x) { return std::log(*x); },
     .of_number = [](Rational x) { return x == Rational(1) ? std::optional(Rational(0)) : std::nullopt; },
     .derivative = [](Expr f) { return pow(f->args[0], -1); },
     .rule = "log(x)_dot = x_dot/x",
     .limit = "log is defined for {} > 0 only.",
     .finding = "where {} <= 0 its log is no finite number; no guard"},
    {.fn = Fn::abs, .name = "abs", .signature = "abs(s)", .unit = {UnitNeed::any, UnitGiven::same}, .help = "s without its sign",
     .value = [](const double* x) { return std::fabs(*x); },
     .of_number = [](Rational x) { return std::optional(abs(x)); },
     .by_others = [](Expr x) { return call(Fn::sqrt, pow(x, 2)); },
     .derivative = [](Expr f) { return functions_detail::of(Fn::sign, f); },
     .rule = "|x|_dot = sign(x) x_dot",
     .limit = "abs has a corner at {} = 0; its derivative is taken as 0 there.",
     .finding = "at the corner {} = 0 of abs the kernel takes the slope 0",
     .cost = {.compare = 1}, .of_contract = true},
    {.fn = Fn::sign, .name = "sign",
     .value = [](const double* x) { return *x > 0 ? 1. : *x < 0 ? -1. : 0.; },
     .of_number = [](Rational x) { return std::optional(Rational(x.sign())); },
     .by_others = [](Expr x) { return call(Fn::sqrt, pow(x, 2)) / x; },
     .derivative = [](Expr f) { return f->pool->number(0); },
     .cost = {.compare = 1}, .of_contract = true},
    // The derivative of an angle depends on the vectors that it is between: derivation/rate_rules.hpp.
    {.fn = Fn::atan2, .name = "atan2", .signature = "atan2(y, x)", .unit = {UnitNeed::equal, UnitGiven::radians},
     .help = "the angle of the vector (x, y), in (-pi, pi]",
     .value = [](const double* x) { return std::atan2(x[0], x[1]); }},
    {.fn = Fn::inverse, .name = "inverse",
     .value = [](const double* x) { return std::fabs(*x) >= std::numeric_limits<double>::min() ? 1 / *x : 0; },
     .of_number = [](Rational x) { return x.is_zero() ? std::nullopt : std::optional(Rational(1) / x); },
     .cost = {.divide = 1, .compare = 1}, .of_contract = true, .guard = true},
    {.fn = Fn::select, .name = "select",
     .value = [](const double* x) { return x[0] > 0 ? x[1] : x[2]; },
     .cost = {.compare = 1}, .of_contract = true, .guard = true, .code = "select({} > smallest<T>(), {}, {})"},
    {.fn = Fn::pivot, .name = "pivot",
     .value = [](const double* x) { return std::fabs(x[0]) > functions_detail::negligible * std::fabs(x[1]) ? 1 / x[0] : 0; },
     .cost = {.multiply = 1, .divide = 1, .compare = 1}, .of_contract = true, .guard = true},
};
// clang-format on

constexpr bool rows_are_in_order() {
  for (int i = 0; i < static_cast<int>(std::size(functions)); ++i) {
    if (functions[i].fn != static_cast<Fn>(i)) return false;
  }
  return true;
}
static_assert(rows_are_in_order());

inline const Function& function_of(Fn fn) { return functions[static_cast<std::size_t>(fn)]; }
// Null if none has this name.
inline const Function* function_named(std::string_view name) {
  const auto found = std::ranges::find(functions, name, &Function::name);
  return found == std::end(functions) ? nullptr : found;
}

}  // namespace cdot::derive
