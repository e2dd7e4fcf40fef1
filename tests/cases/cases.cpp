#include "tests/cases/cases.hpp"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <stdexcept>

namespace cdot::test {
namespace {

const std::string case_mark = "--- case ", messages_mark = "--- messages", mended_mark = "--- mended",
                  escaped_mark = " escaped";

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error("cannot read " + file.string());
  return {std::istreambuf_iterator<char>(in), {}};
}

// The lines with their line ends.
std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t at = 0, end; at < text.size(); at = end) {
    end = std::min(text.find('\n', at), text.size() - 1) + 1;
    lines.push_back(text.substr(at, end - at));
  }
  return lines;
}

// Length of the character at `at` if it is printable and copied as a whole, else 1.
std::size_t length_of_plain_character(const std::string& text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
  const unsigned first = byte(at);
  if (first < 0x80) return first == '\n' || first == '\t' || (first >= 0x20 && first != 0x7f);
  const std::size_t length = first >= 0xc2 && first < 0xe0 ? 2 : first >= 0xe0 && first < 0xf0 ? 3 : 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(at + i) & 0xc0) != 0x80) return 0;
  return text.compare(at, 3, "\xef\xbb\xbf") == 0 ? 0 : length;
}

bool needs_escapes(const std::string& text) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = length_of_plain_character(text, at);
    if (length == 0) return true;
    at += length;
  }
  return (!text.empty() && text.back() != '\n') || text.starts_with("---") || text.find("\n---") != text.npos;
}

std::string escaped(const std::string& text) {
  const char* const digits = "0123456789abcdef";
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = length_of_plain_character(text, at);
    const bool mark = text.compare(at, 3, "---") == 0 && (at == 0 || text[at - 1] == '\n');
    if (length == 0 || mark) {
      const auto byte = static_cast<unsigned char>(text[at++]);
      out += {'\\', 'x', digits[byte / 16], digits[byte % 16]};
      continue;
    }
    out += text[at] == '\\' ? "\\\\" : text.substr(at, length);
    at += length;
  }
  if (!text.empty() && text.back() != '\n') out += "\\\n";
  return out;
}

std::string unescaped(const std::string& text) {
  std::string out;
  for (std::size_t at = 0; at < text.size(); ++at) {
    if (text[at] != '\\') {
      out += text[at];
      continue;
    }
    const char next = ++at < text.size() ? text[at] : ' ';
    if (next == 'x' && at + 2 < text.size() && std::isxdigit(text[at + 1]) && std::isxdigit(text[at + 2])) {
      out += static_cast<char>(std::stoi(text.substr(at + 1, 2), nullptr, 16));
      at += 2;
    } else if (next == '\\') {
      out += next;
    } else if (next != '\n') {
      throw std::runtime_error("an escape is `\\xNN`, `\\\\` or `\\` at the end of a line");
    }
  }
  return out;
}

std::string text_of(const BrokenInput& c) {
  const bool escapes = needs_escapes(c.input) || needs_escapes(c.messages);
  const auto written = [&](const std::string& text) { return escapes ? escaped(text) : text; };
  return case_mark + c.name + (escapes ? escaped_mark : "") + "\n" + written(c.input) + messages_mark + "\n" +
         written(c.messages) + (c.edits.empty() ? "" : mended_mark + "\n" + c.edits);
}

// Parses the lines of one case after its `--- case` line.
BrokenInput parse_case(std::string name, const std::vector<std::string>& lines) {
  const bool escapes = name.ends_with(escaped_mark);
  if (escapes) name.erase(name.size() - escaped_mark.size());
  BrokenInput c{std::move(name), "", ""};
  std::string* part = &c.input;
  for (const std::string& line : lines) {
    if (line == messages_mark + "\n" && part == &c.input) part = &c.messages;
    else if (line == mended_mark + "\n" && part == &c.messages) part = &c.edits;
    else if (line.starts_with("---"))
      throw std::runtime_error("`--- case NAME`, `--- messages` or `--- mended` belongs here: " + line);
    else *part += line;
  }
  if (escapes) c.input = unescaped(c.input), c.messages = unescaped(c.messages);
  return c;
}

}  // namespace

std::string mended(const BrokenInput& c) {
  std::map<int, std::string> lines;
  int count = 0;
  for (const std::string& line : lines_of(c.input)) lines[++count] = line;
  std::set<int> replaced;
  for (const std::string& edit : lines_of(c.edits)) {
    const std::size_t mark = edit.find('>'), dash = edit.find('-');
    if (mark == edit.npos) throw std::runtime_error("an edit is `2>` and a text: " + edit);
    const int first = std::stoi(edit), last = dash < mark ? std::stoi(edit.substr(dash + 1)) : first;
    for (int n = first; n <= last; ++n)
      if (replaced.insert(n).second) lines[n].clear();
    if (edit.size() > mark + 2) lines[first] += edit.substr(mark + 1);
  }
  std::string text;
  for (const auto& [n, line] : lines) text += line;
  return text;
}

Theme parse_theme(const std::string& text, const std::filesystem::path& file) {
  Theme theme{file, "", {}};
  const std::vector<std::string> lines = lines_of(text);
  std::set<std::string> names;
  for (std::size_t at = 0, end; at < lines.size(); at = end) {
    if (!lines[at].starts_with(case_mark)) {
      theme.about += lines[at];
      end = at + 1;
      continue;
    }
    end = at + 1;
    while (end < lines.size() && !lines[end].starts_with(case_mark)) ++end;
    const bool separated = end < lines.size() && lines[end - 1] == "\n";
    const auto first = lines.begin() + static_cast<std::ptrdiff_t>(at);
    const auto last = lines.begin() + static_cast<std::ptrdiff_t>(separated ? end - 1 : end);
    try {
      std::string name = lines[at].substr(case_mark.size());
      name.erase(name.find_last_not_of("\n") + 1);
      theme.cases.push_back(parse_case(std::move(name), {first + 1, last}));
      if (!names.insert(theme.cases.back().name).second) throw std::runtime_error("a second case of this name");
    } catch (const std::exception& error) {
      throw std::runtime_error(file.string() + ":" + std::to_string(at + 1) + ": " + error.what());
    }
  }
  return theme;
}

Theme read_theme(const std::filesystem::path& file) { return parse_theme(bytes_of(file), file); }

std::string text_of(const Theme& theme) {
  std::string out = theme.about;
  for (const BrokenInput& c : theme.cases) out += (&c == &theme.cases.front() ? "" : "\n") + text_of(c);
  return out;
}

std::vector<Theme> themes_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".cases") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::vector<Theme> themes;
  std::set<std::string> names;
  for (const auto& file : files) {
    themes.push_back(read_theme(file));
    for (const BrokenInput& c : themes.back().cases)
      if (!names.insert(c.name).second) throw std::runtime_error(file.string() + ": " + c.name + " is in another file");
  }
  return themes;
}

std::vector<BrokenInput> cases_of(const std::vector<Theme>& themes) {
  std::vector<BrokenInput> all;
  for (const Theme& theme : themes) all.insert(all.end(), theme.cases.begin(), theme.cases.end());
  return all;
}

BrokenInput case_named(const std::vector<Theme>& themes, const std::string& name) {
  for (const BrokenInput& c : cases_of(themes))
    if (c.name == name) return c;
  throw std::out_of_range("no case is called " + name);
}

void update_if_asked(std::vector<Theme>& themes, const std::function<std::string(const BrokenInput&)>& say) {
  if (!std::getenv("CDOT_UPDATE")) return;
  for (Theme& theme : themes) {
    for (BrokenInput& c : theme.cases) c.messages = say(c);
    std::ofstream(theme.file, std::ios::binary) << text_of(theme);
  }
}

}  // namespace cdot::test
