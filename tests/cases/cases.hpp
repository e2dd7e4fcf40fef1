// Many small inputs in one file, each with its expected messages:
//
//   A text about the theme, up to the first case.
//
//   --- case norm_of_body.joint
//   joint norm_of_body planar
//     norm(a) = 0
//   --- messages
//   norm_of_body.joint:2:8: error: ...
//
//   --- case ...
//
// After the messages may follow the input as their fixes mend it, by lines: `2>` and a text stands for line 2 (several
// such texts for several lines), `2>` alone removes it, `2-5>` removes four lines.
//
//   --- mended
//   2>  norm(x(a) - x(b)) = 1 [m]
//
// Messages count lines from the first line of their case. One empty line before `--- case` belongs to neither case.
// `--- case NAME escaped` is for bytes that an editor cannot show: there `\xNN` is a byte, `\\` a backslash, and `\` at
// the end of a line joins the line with the next. With CDOT_UPDATE=1 the test writes the messages.
#pragma once

#include <filesystem>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

namespace cdot::test {

struct BrokenInput {
  std::string name;  // as that of a file: norm_of_body.joint
  std::string input, messages;
  std::string edits{};  // the lines after `--- mended`

  friend void PrintTo(const BrokenInput& c, std::ostream* out) { *out << c.name; }  // for googletest
};

struct Theme {
  std::filesystem::path file;
  std::string about;
  std::vector<BrokenInput> cases;
};

// Throws std::runtime_error with the line if the file violates the format or two cases have the same name.
Theme read_theme(const std::filesystem::path& file);
Theme parse_theme(const std::string& text, const std::filesystem::path& file);
std::string text_of(const Theme& theme);

// The input with its edits. Throws std::runtime_error if an edit has no line number.
std::string mended(const BrokenInput& c);

// All *.cases files of a folder, sorted by name; names of cases are unique in the folder.
std::vector<Theme> themes_in(const std::filesystem::path& folder);
// The cases of all themes. The second function throws std::out_of_range if the name is unknown.
std::vector<BrokenInput> cases_of(const std::vector<Theme>& themes);
BrokenInput case_named(const std::vector<Theme>& themes, const std::string& name);

// With CDOT_UPDATE=1: replaces every case's messages by those of `say` and writes the files.
void update_if_asked(std::vector<Theme>& themes, const std::function<std::string(const BrokenInput&)>& say);

}  // namespace cdot::test
