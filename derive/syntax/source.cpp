#include "derive/syntax/source.hpp"

#include <algorithm>
#include <map>

#include "runtime/text/excerpt.hpp"
#include "runtime/text/spelling.hpp"

namespace cdot::derive {
namespace {

constexpr int max_errors = 50;  // a file with more is most likely the wrong file

// The visible part of a long line contains the first mark.
constexpr text::Look look{
    96, "...", "\uFFFD", '~', true, [](int columns, int begin, int) {
      return columns <= look.columns ? 0 : std::clamp(begin - look.columns / 3, 0, columns - look.columns);
    }};

std::string_view line_text(const SourceFile& file, int line) {
  const int begin = file.line_starts[static_cast<std::size_t>(line - 1)];
  const bool last = line == static_cast<int>(file.line_starts.size());
  const int end = last ? static_cast<int>(file.text.size()) : file.line_starts[static_cast<std::size_t>(line)] - 1;
  auto text =
      std::string_view(file.text).substr(static_cast<std::size_t>(begin), static_cast<std::size_t>(end - begin));
  if (text.ends_with('\r')) text.remove_suffix(1);
  return text;
}

}  // namespace

int utf8_length(std::string_view text, std::size_t i) {
  const text::Character c = text::character_at(text, i);
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
    i += text::character_at(text, static_cast<std::size_t>(i)).length;
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
  std::map<int, std::vector<text::Mark>> lines;  // the primary mark first within its line
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
    text::Excerpt shown = text::excerpt(line_text(file, line), marks, look);
    shown.text.erase(shown.text.find_last_not_of(" \t") + 1);
    out += text::numbered(line, shown, width);
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
  return text::nearest(word, candidates, word.size() < 2 ? 0 : word.size() < 6 ? 1 : 2);
}

}  // namespace cdot::derive
