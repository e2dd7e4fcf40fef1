// Source text and messages about it, with positions and carets. The readers of specs and hand derivations use it, and
// every later stage that reports about one of their lines.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace cdot::derive {

// Length in bytes of the UTF-8 character at byte i; 0 if there is none.
int utf8_length(std::string_view text, std::size_t i);

// Bytes [begin, end) of a file.
struct Span {
  int begin = 0, end = 0;
};

struct SourceFile {
  std::string path;  // as shown in messages
  std::string text;
  std::vector<int> line_starts;

  SourceFile(std::string path, std::string text);
  int line(int offset) const;    // 1-based
  int column(int offset) const;  // 1-based, in characters (UTF-8 code points)
};

enum class Severity { error, warning };

// One message: file:line:column, what is wrong, the line with carets, and the likely fix.
struct Diagnostic {
  Severity severity = Severity::error;
  Span where;
  std::vector<Span> also;  // further spans that get carets (the other operand, the first declaration)
  std::string message;     // what is wrong
  std::string fix;         // what to do; may be empty
};

// All messages about one file, in the order of the text.
struct Diagnostics {
  std::vector<Diagnostic> list;
  bool has_errors() const;
  void sort();
  void error(Span where, std::string message, std::string fix = {}, std::vector<Span> also = {});
  void warning(Span where, std::string message, std::string fix = {}, std::vector<Span> also = {});
};

// For a terminal or a log: long lines are shortened around the caret, control and invalid bytes are shown safely.
//   specs/planar/line.joint:7:3: error: adds metres to radians
//     7 |   dot(t, u) + angle(a) = 0
//       |   ^~~~~~~~~   ~~~~~~~~
//     fix: ...
std::string render(const SourceFile& file, const Diagnostic& d);
std::string render(const SourceFile& file, const Diagnostics& all);

// "x, y and z"
std::string listed(std::span<const std::string> parts, std::string_view last = " and ");

// The nearest of the candidates for "did you mean", empty if none is near.
std::string nearest(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace cdot::derive
