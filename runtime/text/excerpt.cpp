#include "runtime/text/excerpt.hpp"

#include <algorithm>
#include <cstdint>

namespace cdot::text {
namespace {

bool is_continuation(char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; }

// The smallest code point that needs so many bytes; smaller ones are overlong and invalid.
std::uint32_t smallest_of_length(int length) { return length == 2 ? 0x80 : length == 3 ? 0x800 : 0x10000; }

// One column: a character, and the mark below it.
struct Cell {
  std::string text;
  char mark;
  bool tab;
};

char mark_at(const std::vector<Mark>& marks, int byte, char under) {
  char mark = ' ';
  for (const Mark& m : marks)
    if (byte == m.begin && m.primary) return '^';
    else if (byte >= m.begin && byte < m.end) mark = under;
  return mark;
}

// Cuts a very long line to the neighbourhood of its first mark. True if a part on the left was cut.
bool cut_far_left(std::string_view& line, std::vector<Mark>& marks, int columns) {
  const int kept = 8 * columns;  // bytes on either side, plenty for the columns that are shown
  const int focus = marks.front().begin, size = static_cast<int>(line.size());
  line = line.substr(0, static_cast<std::size_t>(std::min(size, focus + kept)));
  int begin = std::max(0, focus - kept);
  while (begin > 0 && begin < focus && is_continuation(line[static_cast<std::size_t>(begin)])) ++begin;
  line.remove_prefix(static_cast<std::size_t>(begin));
  for (Mark& m : marks) {
    m.begin -= begin;
    m.end -= begin;
  }
  return begin > 0;
}

// The cells of a line, and one behind its end for a caret there.
std::vector<Cell> cells_of(std::string_view line, const std::vector<Mark>& marks, const Look& look) {
  std::vector<Cell> cells;
  for (std::size_t i = 0; i < line.size();) {
    const Character c = character_at(line, i);
    const bool tab = line[i] == '\t';
    const std::string_view text = line.substr(i, static_cast<std::size_t>(c.length));
    cells.push_back({std::string(c.printable || tab || look.blank.empty() ? text : look.blank),
                     mark_at(marks, static_cast<int>(i), look.under), tab});
    i += static_cast<std::size_t>(c.length);
  }
  cells.push_back({"", mark_at(marks, static_cast<int>(line.size()), look.under), false});
  return cells;
}

// The number of characters that begin before a byte.
int characters(std::string_view line, std::size_t end) {
  int count = 0;
  for (std::size_t i = 0; i < std::min(end, line.size()); ++count)
    i += static_cast<std::size_t>(character_at(line, i).length);
  return count;
}

}  // namespace

Character character_at(std::string_view s, std::size_t i) {
  const auto lead = static_cast<unsigned char>(s[i]);
  if (lead < 0x80) return {1, true, lead >= 0x20 && lead != 0x7F};
  const int length = lead >= 0xF0 && lead < 0xF8   ? 4
                     : lead >= 0xE0 && lead < 0xF0 ? 3
                     : lead >= 0xC2 && lead < 0xE0 ? 2
                                                   : 0;
  if (length == 0 || i + static_cast<std::size_t>(length) > s.size()) return {};
  std::uint32_t code = lead & (0xFFu >> (length + 1));
  for (int k = 1; k < length; ++k) {
    const char c = s[i + static_cast<std::size_t>(k)];
    if (!is_continuation(c)) return {};
    code = code << 6 | (static_cast<unsigned char>(c) & 0x3Fu);
  }
  const bool surrogate = code >= 0xD800 && code < 0xE000;
  if (code < smallest_of_length(length) || code > 0x10FFFF || surrogate) return {};
  const bool control =
      code < 0xA0 || (code >= 0x200B && code <= 0x200F) || (code >= 0x2028 && code <= 0x202E) || code == 0xFEFF;
  return {length, true, !control};
}

Excerpt excerpt(std::string_view line, std::vector<Mark> marks, const Look& look) {
  const bool cut = cut_far_left(line, marks, look.columns);
  const std::vector<Cell> cells = cells_of(line, marks, look);
  const int columns = static_cast<int>(cells.size()) - (look.caret_at_end ? 0 : 1);
  const auto column = [&](int byte) { return characters(line, static_cast<std::size_t>(byte)); };
  const int first = look.first(columns, column(marks.front().begin), column(marks.front().end));
  const int last = first + look.columns;
  Excerpt shown;
  if (first > 0 || cut)
    shown = {std::string(look.cut), std::string(static_cast<std::size_t>(characters(look.cut, look.cut.size())), ' ')};
  for (int k = first; k < std::min(static_cast<int>(cells.size()), last); ++k) {
    const Cell& cell = cells[static_cast<std::size_t>(k)];
    shown.text += cell.text;
    shown.carets += cell.mark == ' ' && cell.tab ? '\t' : cell.mark;
  }
  if (last < columns) shown.text += look.cut;
  shown.carets.erase(shown.carets.find_last_not_of(" \t") + 1);
  return shown;
}

std::string numbered(int line, const Excerpt& shown, std::size_t width) {
  const std::string digits = std::to_string(line);
  const std::string before(width - std::min(width, digits.size()), ' ');
  return before + digits + " | " + shown.text + "\n" + std::string(width, ' ') + " | " + shown.carets + "\n";
}

}  // namespace cdot::text
