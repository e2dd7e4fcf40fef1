// Numbers and their units: decimals as exact fractions, units as products of m, rad, s, kg and any.
#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

#include "derive/syntax/parser.hpp"

namespace cdot::derive {
namespace {

constexpr int largest_exponent = 400;  // of ten, before the exact value is even tried

// digits [ "." digits ] [ "e" integer ] as an exact fraction.
Rational exact_number(std::string_view text) {
  const std::size_t e = std::min(text.find_first_of("eE"), text.size());
  int exponent = 0;
  if (e < text.size()) {
    std::string_view digits = text.substr(e + 1);
    if (digits.starts_with('+')) digits.remove_prefix(1);
    const auto [end, problem] = std::from_chars(digits.data(), digits.data() + digits.size(), exponent);
    if (problem != std::errc() || std::abs(exponent) > largest_exponent) throw NumberTooLarge();
  }
  std::string mantissa(text.substr(0, e));
  if (const std::size_t point = mantissa.find('.'); point != std::string::npos) {
    mantissa.erase(mantissa.find_last_not_of('0') + 1);  // 1.500 is 1.5
    exponent -= static_cast<int>(mantissa.size() - point - 1);
    mantissa.erase(point, 1);
  }
  Rational value(0);
  for (const char c : mantissa) value = value * Rational(10) + Rational(c - '0');
  if (value.is_zero()) return value;
  if (std::abs(exponent) > largest_exponent) throw NumberTooLarge();
  return value * pow(Rational(10), exponent);
}

struct NamedUnit {
  std::string_view name;
  Unit unit;
  int degrees;
};
const std::array<NamedUnit, 8> known_units = {{{"m", {.m = 1}, 0},
                                               {"rad", {.rad = 1}, 0},
                                               {"s", {.s = 1}, 0},
                                               {"kg", {.kg = 1}, 0},
                                               {"N", {.m = 1, .s = -2, .kg = 1}, 0},
                                               {"J", {.m = 2, .s = -2, .kg = 1}, 0},
                                               {"deg", {.rad = 1}, 1},
                                               {"any", {.any = 1}, 0}}};

std::string unit_fix(std::string_view word) {
  // clang-format off
  static const std::array<std::pair<std::string_view, std::string_view>, 13> others = {{
      {"cm", "0.01 m"}, {"mm", "0.001 m"}, {"km", "1000 m"}, {"g", "0.001 kg"}, {"ms", "0.001 s"}, {"Hz", "1/s"},
      {"hz", "1/s"}, {"meter", "m"}, {"metre", "m"}, {"second", "s"}, {"radians", "rad"}, {"degrees", "deg"},
      {"Nm", "N*m"}}};
  // clang-format on
  for (const auto& [name, meaning] : others)
    if (name == word) return "in the language's units that is " + std::string(meaning);
  std::vector<std::string> names;
  for (const NamedUnit& u : known_units) names.emplace_back(u.name);
  const std::string near = nearest(word, names);
  return (near.empty() ? "" : "did you mean " + quote(near) + "? ") +
         "The units are m, rad, s, kg, N, J and deg, joined by * / ^";
}

}  // namespace

// unit = "[" ( "1" | UNIT [ "^" INTEGER ] ) { ( "*" | "/" ) UNIT [ "^" INTEGER ] } "]"
std::optional<WrittenUnit> Parser::unit() {
  if (failed_ || !at_symbol("[")) return {};
  const Token first = take();
  WrittenUnit result;
  if (peek().kind == TokenKind::number && peek().text == "1") take();
  else unit_factor(result, false);
  while (!failed_ && (at_symbol("*") || at_symbol("/"))) unit_factor(result, take().text == "/");
  if (!failed_ && at_name())
    fail(peek().where, "`*` or `/` is missing between units: " + found(), "write for example [m/s]");
  expect("]", "after the unit");
  result.where = from(first);
  return result;
}

void Parser::unit_factor(WrittenUnit& result, bool divided) {
  const Word word = name("a unit such as m, rad or kg*m^2");
  if (failed_) return;
  const auto known =
      std::find_if(known_units.begin(), known_units.end(), [&](const NamedUnit& u) { return u.name == word.text; });
  if (known == known_units.end()) return fail(word.where, "there is no unit " + quote(word.text), unit_fix(word.text));
  int exponent = 1;
  if (accept("^")) {
    const int sign = accept("-") ? -1 : 1;
    const std::string digits(peek().text);
    if (peek().kind != TokenKind::number || digits.size() != 1)
      return fail(peek().where, "the power of a unit is a whole number from 1 to 9");
    take();
    exponent = sign * (digits[0] - '0');
  }
  if (divided) exponent = -exponent;
  result.unit = result.unit * pow(known->unit, exponent);
  result.degrees += known->degrees * exponent;
}

Ast Parser::number() {
  const Token t = take();
  Ast result;
  result.kind = Ast::Kind::number;
  try {
    result.value = exact_number(t.text);
  } catch (const NumberTooLarge&) {
    fail(t.where, "the number has too many digits: it must be a fraction of 64-bit integers",
         "use at most 18 digits, and powers of ten from e-18 to e18");
  }
  result.unit = unit();
  const auto is_next = [&](const NamedUnit& u) { return at_name() && peek().text == u.name; };
  if (!result.unit && std::ranges::any_of(known_units, is_next))
    fail(peek().where, "a unit stands in brackets",
         "write " + std::string(t.text) + " [" + std::string(peek().text) + "]");
  result.where = from(t);
  return failed_ ? Ast{} : std::move(result);
}

}  // namespace cdot::derive
