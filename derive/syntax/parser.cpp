#include "derive/syntax/parser.hpp"

#include <algorithm>
#include <utility>

namespace cdot::derive {
namespace {

constexpr int deepest_nesting = 200;

}  // namespace

const Token& Parser::peek(int ahead) const {
  return tokens_[std::min(at_ + static_cast<std::size_t>(ahead), tokens_.size() - 1)];
}

void Parser::skip_blank_lines() {
  while (peek().kind == TokenKind::newline) take();
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

bool Parser::at_end_of_statement() const { return peek().kind == TokenKind::newline || peek().kind == TokenKind::end; }

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
  // The lexer has reported characters that are no token.
  const bool reported = peek().kind == TokenKind::unknown;
  if (!failed_ && !reported) diagnostics_.error(where, std::move(message), std::move(fix), std::move(also));
  failed_ = true;
}

void Parser::next_statement() {
  while (!at_end_of_statement()) take();
  if (!at_end()) take();
  failed_ = false;
}

bool Parser::end_of_statement() {
  if (!failed_ && !at_end_of_statement()) {
    const Token& t = peek();
    if (t.kind == TokenKind::name || t.kind == TokenKind::number || at_symbol("("))
      fail(t.where, "an operator is missing before " + quote(t.text),
           "write * for a product; one statement stands on one line");
    else if (at_symbol(")") || at_symbol("]"))
      fail(t.where, quote(t.text) + " closes nothing", "remove it, or open it before");
    else
      fail(t.where, "the statement must end before " + quote(t.text),
           t.text == ";" ? "a statement ends with its line"
           : t.text == "[" && peek(-1).text == ")"
               ? "a unit belongs to a number: multiply by 1 with that unit, as in pi/2 * 1 [rad]"
               : "");
  }
  const bool good = !failed_;
  next_statement();
  return good;
}

Span Parser::from(const Token& first) const {
  const Span last = at_ > 0 ? tokens_[at_ - 1].where : first.where;
  return {first.where.begin, std::max(first.where.end, last.end)};
}

std::string Parser::found() const {
  if (at_end()) return "the file ends here";
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

// expression = term { ( "+" | "-" ) term }
Ast Parser::expression() {
  if (failed_) return {};
  if (++depth_ > deepest_nesting) {
    fail(peek().where, "this expression has more than 200 nested levels",
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
    fail(peek().where, "this expression has more than 200 nested levels");
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
    if (member && at_symbol("("))
      fail(peek().where, "a component, x or y, is missing: there is `(`", "the product of two vectors is dot(u, v)");
    else if (member) outer.text = name("a component, x or y,").text;
    outer.where = {result.where.begin, peek(-1).where.end};
    outer.args.push_back(std::move(result));
    result = std::move(outer);
    if (++length > 20) fail(result.where, "more than 20 components of components are nested here");
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
  if (t.kind == TokenKind::string) fail(t.where, "a text in quotes cannot stand in an expression");
  else if (at_symbol("["))
    fail(t.where, "square brackets stand behind a number, for its unit, as in 2 [m]", "use round brackets to group");
  else if (at_symbol("+")) fail(t.where, "a leading + is not allowed", "remove it");
  else if (at_symbol("-")) fail(t.where, "two signs stand in a row", "put the negative part into round brackets");
  else if (at_symbol("*") && peek(-1).text == "*") fail(t.where, "`**` is no operator", "a power is written u^2");
  else if (at_symbol("/") && at_symbol("/", 1)) fail(t.where, "`//` starts no comment", "a comment starts with #");
  else fail(t.where, "a number, a name or a bracket is missing: " + found());
  return {};
}

// The next token is not the closing bracket that it should be.
void Parser::not_closed(const Token& open, std::string_view closing) {
  const Token& next = peek();
  const bool new_line = file_.line(next.where.begin) != file_.line(peek(-1).where.begin);
  if (at_end_of_statement() || new_line)
    fail(open.where, "this bracket is not closed", "add the missing " + std::string(closing));
  else if (at_name() || next.kind == TokenKind::number || at_symbol("("))
    fail(next.where, "an operator or a comma is missing before " + quote(next.text));
  else fail(next.where, quote(closing) + " is missing here: " + found(), "", {open.where});
}

Ast Parser::brackets() {
  const Token open = take();
  Ast inner = expression();
  if (!failed_ && !at_symbol(")")) {
    if (at_symbol(","))
      fail(peek().where, "a comma stands between round brackets without an operator before them",
           "a vector is no list of components: along the axes of the world it is 2 [m] * world.x, else a parameter");
    else not_closed(open, ")");
  }
  accept(")");
  inner.where = from(open);
  return failed_ ? Ast{} : std::move(inner);
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
    not_closed(open, ")");
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
  if (!failed_ && !at_symbol("]")) not_closed(open, "]");
  accept("]");
  result.where = from(open);
  return failed_ ? Ast{} : std::move(result);
}

}  // namespace cdot::derive
