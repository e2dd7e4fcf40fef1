#include "runtime/text/colour.hpp"

#include <algorithm>
#include <cstdlib>
#include <string_view>
#include <unistd.h>

namespace cdot::text {
namespace {

constexpr const char *normal = "\033[0m", *bold = "\033[1m", *green = "\033[32m";

constexpr struct {
  std::string_view word;
  const char* colour;
} kinds[] = {{"error: ", "\033[1;31m"}, {"warning: ", "\033[1;35m"}, {"note: ", "\033[1;36m"}};

std::string painted(std::string_view text, const char* colour) {
  return std::string(colour).append(text).append(normal);
}

// "  |   ^~~~ ~~": the marks under a line of a file.
bool is_marks(std::string_view line) {
  const std::size_t bar = line.find_first_not_of(' ');
  if (bar == line.npos || line[bar] != '|') return false;
  const std::string_view marks = line.substr(bar + 1);
  return marks.find('^') != marks.npos && marks.find_first_not_of(" ^~.") == marks.npos;
}

std::string painted_line(std::string_view line) {
  if (is_marks(line)) return painted(line, green);
  if (line.starts_with("  fix: ")) return "  " + painted("fix:", green) + std::string(line.substr(6));
  for (const auto& [word, colour] : kinds) {
    const std::size_t at = line.find(word);
    if (at == line.npos || (at > 0 && !line.substr(0, at).ends_with(": "))) continue;
    const std::string place = at == 0 ? "" : painted(line.substr(0, at), bold);
    return place + painted(word.substr(0, word.size() - 1), colour) + std::string(line.substr(at + word.size() - 1));
  }
  return std::string(line);
}

}  // namespace

bool has_colours(std::FILE* stream) {
  const char *refused = std::getenv("NO_COLOR"), *terminal = std::getenv("TERM");
  if ((refused && *refused) || !terminal || std::string_view(terminal) == "dumb") return false;
  return ::isatty(::fileno(stream)) == 1;
}

std::string in_colour(const std::string& text) {
  std::string result;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    result += painted_line(std::string_view(text).substr(begin, end - begin));
    if (end < text.size()) result += '\n';
    begin = end + 1;
  }
  return result;
}

void print_messages(std::FILE* stream, const std::string& text) {
  const std::string shown = has_colours(stream) ? in_colour(text) : text;
  std::fwrite(shown.data(), 1, shown.size(), stream);
}

}  // namespace cdot::text
