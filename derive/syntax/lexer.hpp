// Text of a spec or of a hand derivation as tokens. Lines end statements except inside open brackets.
#pragma once

#include <string_view>
#include <vector>

#include "derive/syntax/source.hpp"

namespace cdot::derive {

// `unknown`: characters that are no token; the lexer has reported them.
enum class TokenKind { name, number, string, symbol, unknown, newline, end };

struct Token {
  TokenKind kind = TokenKind::end;
  Span where;
  std::string_view text;  // of a string: without its quotes
};

struct Tokens {
  std::vector<Token> list;     // ends with newline and end
  std::vector<Span> comments;  // of whole lines
  bool readable = true;        // false if it is not a text, or too large; the lexer has reported it
};

Tokens lex(const SourceFile& file, bool hand, Diagnostics& diagnostics);

// A word of the user, short and printable, in back quotes.
std::string quote(std::string_view word);

bool starts_statement(std::string_view word);  // a word of the language that opens a statement
const std::vector<std::string>& statement_words(bool hand);

}  // namespace cdot::derive
