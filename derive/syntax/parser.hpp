// Tokens to expressions: the part of the grammar that specs and hand derivations share, and the recovery from an error.
#pragma once

#include <string>
#include <string_view>

#include "derive/syntax/ast.hpp"
#include "derive/syntax/lexer.hpp"

namespace cdot::derive {

class Parser {
 public:
  Parser(const SourceFile& file, const Tokens& tokens, bool hand, Diagnostics& diagnostics)
      : file_(file), tokens_(tokens.list), hand_(hand), diagnostics_(diagnostics) {}

  Ast expression();
  std::optional<WrittenUnit> unit();  // if there is one
  Word name(std::string_view what);   // must come next
  std::string string(std::string_view after);

  const Token& peek(int ahead = 0) const;
  Token take();
  bool at_symbol(std::string_view text, int ahead = 0) const;
  bool at_word(std::string_view text, int ahead = 0) const;
  bool at_name(int ahead = 0) const { return peek(ahead).kind == TokenKind::name; }
  bool at_end_of_statement() const;
  bool at_end() const { return peek().kind == TokenKind::end; }
  bool accept(std::string_view symbol);
  bool expect(std::string_view symbol, std::string_view where);

  // The first error of a statement; later errors of the same statement are not reported.
  void fail(Span where, std::string message, std::string fix = {}, std::vector<Span> also = {});
  bool failed() const { return failed_; }
  void skip_blank_lines();
  void next_statement();  // skips the rest of this one
  // Reports the rest of this statement, if there is any, and skips it. True if the statement had no error.
  bool end_of_statement();

  int position() const { return static_cast<int>(at_); }
  Span from(const Token& first) const;  // from that token to the last one taken
  std::string found() const;            // the next token, in words

 private:
  Ast term();
  Ast sign();
  Ast power();
  Ast primary();
  Ast postfix();
  Ast number();
  Ast call(const Token& name);
  Ast matrix();
  Ast brackets();
  Ast nothing_here();
  void not_closed(const Token& open, std::string_view closing);
  Ast chain(Ast::Kind kind, std::string_view operators, Ast (Parser::*part)());
  void unit_factor(WrittenUnit& unit, bool divided);

  const SourceFile& file_;
  const std::vector<Token>& tokens_;
  bool hand_;
  Diagnostics& diagnostics_;
  std::size_t at_ = 0;
  int depth_ = 0;
  bool failed_ = false;
};

JointAst parse_joint(const SourceFile& file, const Tokens& tokens, Diagnostics& diagnostics);  // parse_joint.cpp

}  // namespace cdot::derive
