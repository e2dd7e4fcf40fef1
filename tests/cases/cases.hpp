// Many small inputs in one file, each with the messages that it must give:
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
// A line of an input has in its messages the number that it has in its case. One empty line before `--- case` belongs
// to neither case. `--- case NAME escaped` is for bytes that an editor cannot show: there `\xNN` is a byte, `\\` a
// backslash, and `\` at the end of a line joins it with the next. A case without messages is one that is still being
// written; with CDOT_UPDATE=1 the test writes them.
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

  friend void PrintTo(const BrokenInput& c, std::ostream* out) { *out << c.name; }  // for googletest
};

struct Theme {
  std::filesystem::path file;
  std::string about;
  std::vector<BrokenInput> cases;
};

// Throws std::runtime_error, with the line, where the file is not as above, or two cases have one name.
Theme read_theme(const std::filesystem::path& file);
Theme parse_theme(const std::string& text, const std::filesystem::path& file);
std::string text_of(const Theme& theme);

// Every *.cases of a folder, by name; names of cases are unique among them.
std::vector<Theme> themes_in(const std::filesystem::path& folder);
// Those of all themes. Throws std::out_of_range if none has the name.
std::vector<BrokenInput> cases_of(const std::vector<Theme>& themes);
BrokenInput case_named(const std::vector<Theme>& themes, const std::string& name);

// With CDOT_UPDATE=1: gives every case the messages that `say` has of it, and writes the files anew.
void update_if_asked(std::vector<Theme>& themes, const std::function<std::string(const BrokenInput&)>& say);

}  // namespace cdot::test
