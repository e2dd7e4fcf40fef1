#include "derive/parser.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

namespace cdot::derive {
namespace {

constexpr int deepest_nesting = 200;
constexpr int largest_exponent = 400;  // of ten, before the exact value is even tried

// digits [ "." digits ] [ "e" integer ] as an exact fraction.
Rational exact_number(std::string_view text) {
  const std::size_t e = std::min(text.find_first_of("eE"), text.size());
  int exponent = 0;
  if (e < text.size()) {
    std::string_view digits = text.substr(e + 1);
    if (digits.starts_with('+')) digits.remove_prefix(1);
    const auto [end, problem] =
        std::from_chars(digits.data(), digits.data() + digits.size(), exponent);
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
const std::array<NamedUnit, 7> known_units = {{{"m", {.m = 1}, 0},
                                               {"rad", {.rad = 1}, 0},
                                               {"s", {.s = 1}, 0},
                                               {"kg", {.kg = 1}, 0},
                                               {"N", {.m = 1, .s = -2, .kg = 1}, 0},
                                               {"J", {.m = 2, .s = -2, .kg = 1}, 0},
                                               {"deg", {.rad = 1}, 1}}};

std::string unit_fix(std::string_view word) {
  static const std::array<std::pair<std::string_view, std::string_view>, 13> others = {
      {{"cm", "0.01 m"},
       {"mm", "0.001 m"},
       {"km", "1000 m"},
       {"g", "0.001 kg"},
       {"ms", "0.001 s"},
       {"Hz", "1/s"},
       {"hz", "1/s"},
       {"meter", "m"},
       {"metre", "m"},
       {"second", "s"},
       {"radians", "rad"},
       {"degrees", "deg"},
       {"Nm", "N*m"}}};
  for (const auto& [name, meaning] : others)
    if (name == word) return "in the language's units that is " + std::string(meaning);
  std::vector<std::string> names;
  for (const NamedUnit& u : known_units) names.emplace_back(u.name);
  const std::string near = nearest(word, names);
  return (near.empty() ? "" : "did you mean " + quote(near) + "? ") +
         "The units are m, rad, s, kg, N, J and deg, joined by * / ^";
}

}  // namespace

const Token& Parser::peek(int ahead) const {
  return tokens_[std::min(at_ + static_cast<std::size_t>(ahead), tokens_.size() - 1)];
}

Token Parser::take() {
  const Token token = peek();
  if (at_ + 1 < tokens_.size()) ++at_;
  return token;
}

bool Parser::at_symbol(std::string_view text, int ahead) const {
  return peek(ahead).kind == TokenKind::symbol && peek(ahead).text == text;
}

bool Parser::at_word(std::string_view text, int ahead) const {
  return peek(ahead).kind == TokenKind::name && peek(ahead).text == text;
}

bool Parser::at_end_of_statement() const {
  return peek().kind == TokenKind::newline || peek().kind == TokenKind::end;
}

bool Parser::accept(std::string_view symbol) {
  if (failed_ || !at_symbol(symbol)) return false;
  take();
  return true;
}

bool Parser::expect(std::string_view symbol, std::string_view where) {
  if (failed_) return false;
  if (accept(symbol)) return true;
  fail(peek().where, quote(symbol) + " is missing " + std::string(where) + ": " + found());
  return false;
}

void Parser::fail(Span where, std::string message, std::string fix, std::vector<Span> also) {
  if (!failed_) diagnostics_.error(where, std::move(message), std::move(fix), std::move(also));
  failed_ = true;
}

void Parser::next_statement() {
  while (!at_end_of_statement()) take();
  if (!at_end()) take();
  failed_ = false;
}

void Parser::end_of_statement() {
  if (!failed_ && !at_end_of_statement()) {
    const Token& t = peek();
    if (t.kind == TokenKind::name || t.kind == TokenKind::number || at_symbol("("))
      fail(t.where, "an operator is missing before " + quote(t.text),
           "write * for a product; one statement stands on one line");
    else if (at_symbol(")") || at_symbol("]"))
      fail(t.where, quote(t.text) + " closes nothing", "remove it, or open it before");
    else
      fail(t.where, "the statement should end here, but there is " + quote(t.text));
  }
  next_statement();
}

Span Parser::from(const Token& first) const {
  const Span last = at_ > 0 ? tokens_[at_ - 1].where : first.where;
  return {first.where.begin, std::max(first.where.end, last.end)};
}

std::string Parser::found() const {
  if (at_end_of_statement()) return "the line ends here";
  if (peek().kind == TokenKind::string) return "there is a text in quotes";
  return "there is " + quote(peek().text);
}

Word Parser::name(std::string_view what) {
  if (failed_) return {};
  if (!at_name()) {
    fail(peek().where, std::string(what) + " is missing: " + found());
    return {};
  }
  const Token t = take();
  return {std::string(t.text), t.where};
}

std::string Parser::string(std::string_view after) {
  if (failed_) return {};
  if (peek().kind == TokenKind::string) return std::string(take().text);
  fail(peek().where, "after `" + std::string(after) + "` stands a text in quotes: " + found(),
       "write " + std::string(after) + " \"...\"");
  return {};
}

// unit = "[" ( "1" | UNIT [ "^" INTEGER ] ) { ( "*" | "/" ) UNIT [ "^" INTEGER ] } "]"
std::optional<WrittenUnit> Parser::unit() {
  if (failed_ || !at_symbol("[")) return {};
  const Token first = take();
  WrittenUnit result;
  if (peek().kind == TokenKind::number && peek().text == "1")
    take();
  else
    unit_factor(result, false);
  while (!failed_ && (at_symbol("*") || at_symbol("/"))) unit_factor(result, take().text == "/");
  expect("]", "after the unit");
  result.where = from(first);
  return result;
}

void Parser::unit_factor(WrittenUnit& result, bool divided) {
  const Word word = name("a unit such as m, rad or kg*m^2");
  if (failed_) return;
  const auto known = std::find_if(known_units.begin(), known_units.end(),
                                  [&](const NamedUnit& u) { return u.name == word.text; });
  if (known == known_units.end())
    return fail(word.where, "there is no unit " + quote(word.text), unit_fix(word.text));
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

// expression = term { ( "+" | "-" ) term }
Ast Parser::expression() {
  if (failed_) return {};
  if (++depth_ > deepest_nesting) {
    fail(peek().where, "brackets are nested too deeply here",
         "give parts of the expression names with `let`");
    --depth_;
    return {};
  }
  Ast result = chain(Ast::Kind::sum, "+-", &Parser::term);
  --depth_;
  return result;
}

// term = sign { ( "*" | "/" ) sign }
Ast Parser::term() { return chain(Ast::Kind::product, "*/", &Parser::sign); }

Ast Parser::chain(Ast::Kind kind, std::string_view operators, Ast (Parser::*part)()) {
  Ast first = (this->*part)();
  const auto at_operator = [&] {
    return !failed_ && peek().kind == TokenKind::symbol && peek().text.size() == 1 &&
           operators.find(peek().text[0]) != std::string_view::npos;
  };
  if (!at_operator()) return first;
  Ast result;
  result.kind = kind;
  result.where = first.where;
  result.ops = operators.substr(0, 1);
  result.args.push_back(std::move(first));
  while (at_operator()) {
    result.ops += take().text[0];
    result.args.push_back((this->*part)());
  }
  result.where.end = result.args.back().where.end;
  if (failed_) return {};
  return result;
}

// sign = [ "-" ] power
Ast Parser::sign() {
  if (!at_symbol("-")) return power();
  const Token minus = take();
  Ast result;
  result.kind = Ast::Kind::negate;
  result.args.push_back(power());
  result.where = from(minus);
  if (failed_) return {};
  return result;
}

// power = postfix [ "^" sign ]
Ast Parser::power() {
  if (++depth_ > deepest_nesting) {
    fail(peek().where, "powers are nested too deeply here");
    --depth_;
    return {};
  }
  Ast base = postfix();
  if (accept("^")) {
    Ast result;
    result.kind = Ast::Kind::power;
    result.where = base.where;
    result.args.push_back(std::move(base));
    result.args.push_back(sign());
    result.where.end = result.args.back().where.end;
    base = failed_ ? Ast{} : std::move(result);
  }
  --depth_;
  return base;
}

// postfix = primary { "." ( "x" | "y" ) | "'" }
Ast Parser::postfix() {
  Ast result = primary();
  int length = 0;
  while (!failed_ && (at_symbol(".") || (hand_ && at_symbol("'")))) {
    const bool member = take().text == ".";
    Ast outer;
    outer.kind = member ? Ast::Kind::member : Ast::Kind::transpose;
    if (member) outer.text = name("a component, x or y,").text;
    outer.where = {result.where.begin, peek(-1).where.end};
    outer.args.push_back(std::move(result));
    result = std::move(outer);
    if (++length > 20) fail(result.where, "too many components of components");
  }
  return failed_ ? Ast{} : std::move(result);
}

Ast Parser::primary() {
  if (failed_) return {};
  if (peek().kind == TokenKind::number) return number();
  if (at_symbol("(")) return brackets();
  if (hand_ && at_symbol("[")) return matrix();
  if (!at_name()) return nothing_here();
  const Token name = take();
  if (at_symbol("(")) return call(name);
  Ast result;
  result.kind = Ast::Kind::name;
  result.where = name.where;
  result.text = name.text;
  return result;
}

Ast Parser::nothing_here() {
  const Token& t = peek();
  if (t.kind == TokenKind::string)
    fail(t.where, "a text in quotes cannot stand in an expression");
  else if (at_symbol("["))
    fail(t.where, "square brackets stand behind a number, for its unit, as in 2 [m]",
         "use round brackets to group");
  else if (at_symbol("+"))
    fail(t.where, "a sign + is not written", "remove it");
  else if (at_symbol("-"))
    fail(t.where, "two signs in a row", "put the negative part into round brackets");
  else
    fail(t.where, "a number, a name or a bracket is missing: " + found());
  return {};
}

Ast Parser::brackets() {
  const Token open = take();
  Ast inner = expression();
  if (!failed_ && !at_symbol(")")) {
    if (at_symbol(","))
      fail(peek().where, "a comma between round brackets without an operator before them",
           "a vector is written with perp, unit vectors or a parameter, not as (x, y)");
    else if (at_end_of_statement())
      fail(open.where, "this bracket is not closed", "add the missing )");
    else
      expect(")", "here");
  }
  accept(")");
  inner.where = from(open);
  return failed_ ? Ast{} : std::move(inner);
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
  result.where = from(t);
  return failed_ ? Ast{} : std::move(result);
}

// NAME "(" expression { "," expression } ")"
Ast Parser::call(const Token& name) {
  const Token open = take();
  Ast result;
  result.kind = Ast::Kind::call;
  result.text = name.text;
  if (!at_symbol(")")) {
    do result.args.push_back(expression());
    while (accept(","));
  }
  if (!failed_ && !at_symbol(")")) {
    if (at_end_of_statement())
      fail(open.where, "this bracket is not closed", "add the missing )");
    else if (at_name() || peek().kind == TokenKind::number)
      fail(peek().where, "an operator or a comma is missing before " + quote(peek().text));
    else
      expect(")", "after the arguments of " + quote(name.text));
  }
  accept(")");
  result.where = from(name);
  return failed_ ? Ast{} : std::move(result);
}

// "[" expression { ( "," | ";" ) expression } "]"
Ast Parser::matrix() {
  const Token open = take();
  Ast result;
  result.kind = Ast::Kind::matrix;
  result.row_lengths.push_back(0);
  for (;;) {
    result.args.push_back(expression());
    ++result.row_lengths.back();
    if (accept(",")) continue;
    if (!accept(";")) break;
    result.row_lengths.push_back(0);
  }
  if (!failed_ && at_end_of_statement())
    fail(open.where, "this bracket is not closed", "add the missing ]");
  expect("]", "after the blocks of the matrix");
  result.where = from(open);
  return failed_ ? Ast{} : std::move(result);
}

}  // namespace cdot::derive
