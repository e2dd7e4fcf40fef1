#include "derive/syntax/source.hpp"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <map>

namespace cdot::derive {
namespace {

constexpr int max_errors = 50;     // a file with more is not the file that was meant
constexpr int shown_columns = 96;  // of a long line

struct Character {
  int length = 1;  // bytes
  bool valid = false, printable = false;
};

bool is_continuation(char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; }

// The smallest code point that needs so many bytes; smaller ones are overlong and invalid.
std::uint32_t smallest_of_length(int length) { return length == 2 ? 0x80 : length == 3 ? 0x800 : 0x10000; }

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

// One line of a file for display: its text between two columns, and what stands under them.
struct ShownLine {
  std::string text, carets;
};

struct Mark {
  int begin, end;  // bytes of the line
  bool primary;
};

char mark_at(const std::vector<Mark>& marks, int byte) {
  char mark = ' ';
  for (const Mark& m : marks)
    if (byte == m.begin && m.primary) return '^';
    else if (byte >= m.begin && byte < m.end) mark = '~';
  return mark;
}

// First column to show so that the column `focus` is in sight.
int first_shown(int columns, int focus) {
  if (columns <= shown_columns) return 0;
  return std::clamp(focus - shown_columns / 3, 0, columns - shown_columns);
}

// Keeps only the neighbourhood of the first mark of a very long line; whether something is gone on
// the left.
bool cut_far_left(std::string_view& line, std::vector<Mark>& marks) {
  constexpr int kept = 8 * shown_columns;  // bytes on either side, plenty for the columns that are shown
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

ShownLine show(std::string_view line, std::vector<Mark> marks) {
  const bool cut = cut_far_left(line, marks);
  struct Cell {
    std::string text;
    char mark;
    bool tab;
  };
  std::vector<Cell> cells;
  int focus = 0;
  std::size_t i = 0;
  while (i <= line.size()) {  // one cell beyond the end, for a caret there
    const int at = static_cast<int>(i);
    if (!marks.empty() && marks.front().begin == at) focus = static_cast<int>(cells.size());
    if (i == line.size()) {
      cells.push_back({"", mark_at(marks, at), false});
      break;
    }
    const Character c = character_at(line, i);
    const bool tab = line[i] == '\t';
    const std::string text(line.substr(i, static_cast<std::size_t>(c.length)));
    cells.push_back({c.printable || tab ? text : "\uFFFD", mark_at(marks, at), tab});
    i += static_cast<std::size_t>(c.length);
  }
  const int columns = static_cast<int>(cells.size());
  const int first = first_shown(columns, focus), last = std::min(columns, first + shown_columns);
  ShownLine shown;
  if (first > 0 || cut) shown = {"...", "   "};
  for (int k = first; k < last; ++k) {
    const Cell& cell = cells[static_cast<std::size_t>(k)];
    shown.text += cell.text;
    shown.carets += cell.mark == ' ' && cell.tab ? '\t' : cell.mark;
  }
  if (last < columns) shown.text += "...";
  shown.carets.erase(shown.carets.find_last_not_of(" \t") + 1);
  shown.text.erase(shown.text.find_last_not_of(" \t") + 1);
  return shown;
}

std::string_view line_text(const SourceFile& file, int line) {
  const int begin = file.line_starts[static_cast<std::size_t>(line - 1)];
  const bool last = line == static_cast<int>(file.line_starts.size());
  const int end = last ? static_cast<int>(file.text.size()) : file.line_starts[static_cast<std::size_t>(line)] - 1;
  auto text =
      std::string_view(file.text).substr(static_cast<std::size_t>(begin), static_cast<std::size_t>(end - begin));
  if (text.ends_with('\r')) text.remove_suffix(1);
  return text;
}

std::string number_column(int line, std::size_t width) {
  const std::string digits = line > 0 ? std::to_string(line) : "";
  return std::string(width - digits.size(), ' ') + digits + " | ";
}

int distance(std::string_view a, std::string_view b) {  // with swaps of neighbours
  std::vector<std::vector<int>> d(a.size() + 1, std::vector<int>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i)
    for (std::size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        d[i][j] = static_cast<int>(i + j);
        continue;
      }
      const int change = a[i - 1] == b[j - 1] ? 0 : 1;
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + change});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  return d[a.size()][b.size()];
}

std::string lower_case(std::string_view s) {
  std::string r(s);
  for (char& c : r) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return r;
}

}  // namespace

int utf8_length(std::string_view text, std::size_t i) {
  const Character c = character_at(text, i);
  const bool ascii = static_cast<unsigned char>(text[i]) < 0x80;
  return ascii || c.valid ? c.length : 0;
}

SourceFile::SourceFile(std::string path_, std::string text_)
    : path(std::move(path_)), text(std::move(text_)), line_starts{0} {
  for (std::size_t i = 0; i < text.size(); ++i)
    if (text[i] == '\n') line_starts.push_back(static_cast<int>(i) + 1);
}

int SourceFile::line(int offset) const {
  const auto after = std::upper_bound(line_starts.begin(), line_starts.end(), offset);
  return static_cast<int>(after - line_starts.begin());
}

int SourceFile::column(int offset) const {
  const int end = std::min(offset, static_cast<int>(text.size()));
  int column = 1;
  for (int i = line_starts[static_cast<std::size_t>(line(offset) - 1)]; i < end; ++column)
    i += character_at(text, static_cast<std::size_t>(i)).length;
  return column;
}

bool Diagnostics::has_errors() const {
  return std::any_of(list.begin(), list.end(), [](const Diagnostic& d) { return d.severity == Severity::error; });
}

void Diagnostics::sort() {
  std::stable_sort(list.begin(), list.end(),
                   [](const Diagnostic& a, const Diagnostic& b) { return a.where.begin < b.where.begin; });
}

void Diagnostics::error(Span where, std::string message, std::string fix, std::vector<Span> also) {
  const auto errors =
      std::count_if(list.begin(), list.end(), [](const Diagnostic& d) { return d.severity == Severity::error; });
  if (errors > max_errors) return;
  if (errors == max_errors)
    list.push_back({Severity::error, where, {}, "more errors follow; these are the first 50", ""});
  else list.push_back({Severity::error, where, std::move(also), std::move(message), std::move(fix)});
}

void Diagnostics::warning(Span where, std::string message, std::string fix, std::vector<Span> also) {
  if (static_cast<int>(list.size()) > 2 * max_errors) return;
  list.push_back({Severity::warning, where, std::move(also), std::move(message), std::move(fix)});
}

std::string render(const SourceFile& file, const Diagnostic& d) {
  std::string out = file.path + ":" + std::to_string(file.line(d.where.begin)) + ":" +
                    std::to_string(file.column(d.where.begin)) + ": " +
                    (d.severity == Severity::error ? "error: " : "warning: ") + d.message + "\n";
  std::map<int, std::vector<Mark>> lines;  // the primary mark first within its line
  const auto add = [&](Span s, bool primary) {
    const int line = file.line(s.begin);
    const int start = file.line_starts[static_cast<std::size_t>(line - 1)];
    const int length = static_cast<int>(line_text(file, line).size());
    const int begin = std::min(s.begin - start, length);
    lines[line].push_back({begin, std::clamp(s.end - start, begin, length), primary});
  };
  add(d.where, true);
  for (const Span& s : d.also) add(s, false);
  const std::size_t width = std::max<std::size_t>(5, std::to_string(lines.rbegin()->first).size());
  for (const auto& [line, marks] : lines) {
    const ShownLine shown = show(line_text(file, line), marks);
    out += number_column(line, width) + shown.text + "\n";
    out += number_column(0, width) + shown.carets + "\n";
  }
  if (!d.fix.empty()) out += "  fix: " + d.fix + "\n";
  return out;
}

std::string render(const SourceFile& file, const Diagnostics& all) {
  std::string out;
  for (const Diagnostic& d : all.list) out += render(file, d);
  return out;
}

std::string listed(std::span<const std::string> parts, std::string_view last) {
  std::string s;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    s += i == 0 ? "" : i + 1 == parts.size() ? last : ", ";
    s += parts[i];
  }
  return s;
}

std::string nearest(std::string_view word, const std::vector<std::string>& candidates) {
  if (word.size() > 64) return {};
  const std::string lower = lower_case(word);
  const int allowed = word.size() < 2 ? 0 : word.size() < 6 ? 1 : 2;
  std::string best;
  int best_distance = allowed + 1;
  for (const std::string& c : candidates) {
    if (c.size() > 64) continue;
    const int d = distance(lower, lower_case(c));
    if (d < best_distance || (d == best_distance && d <= allowed && c < best)) {
      best = c;
      best_distance = d;
    }
  }
  return best;
}

}  // namespace cdot::derive
