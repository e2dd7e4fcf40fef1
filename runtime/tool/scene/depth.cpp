// Bounds the depth of a scene's text, before toml++ reads it.
#include <algorithm>
#include <cctype>

#include "runtime/tool/scene/read.hpp"

namespace cdot {
namespace {

// The end of the string that begins at `at`: "…", '…', """…""" or '''…'''. Strings in "" have escapes. One that is not
// closed ends with its line or with the text: toml++ reports it.
std::size_t end_of_string(std::string_view text, std::size_t at) {
  const char quote = text[at];
  const std::string_view mark = text.substr(at, text.substr(at, 3) == std::string(3, quote) ? 3 : 1);
  for (std::size_t i = at + mark.size(); i < text.size(); ++i) {
    if (text.substr(i, mark.size()) == mark) return i + mark.size();
    if (mark.size() == 1 && text[i] == '\n') return i;
    if (quote == '"' && text[i] == '\\') ++i;
  }
  return text.size();
}

bool may_stand_in_key(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-' || c == ' ' || c == '\t' || c == '.';
}

Span place_of(std::string_view text, std::size_t at) {
  const std::string_view before = text.substr(0, at);
  const int line = 1 + static_cast<int>(std::count(before.begin(), before.end(), '\n'));
  const std::size_t start = before.rfind('\n') + 1;  // npos + 1 = 0
  const int column = 1 + static_cast<int>(at - start);
  return {line, column, column + 1};
}

}  // namespace

std::optional<Span> find_deep_key(std::string_view text) {
  int parts = 1;
  for (std::size_t i = 0; i < text.size();) {
    const char c = text[i];
    if (c == '"' || c == '\'') {
      i = end_of_string(text, i);  // a part of a key may be quoted
      continue;
    }
    if (c == '#') i = std::min(text.find('\n', i), text.size() - 1);
    if (!may_stand_in_key(text[i])) parts = 1;
    if (c == '.' && ++parts > most_parts_of_key) return place_of(text, i + 1);
    ++i;
  }
  return std::nullopt;
}

}  // namespace cdot
