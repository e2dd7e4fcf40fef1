// Every case of broken/ gives exactly the messages below it (tests/cases/cases.hpp). CDOT_UPDATE=1 writes them: read
// each from the view of the user who made the error.
#include <algorithm>
#include <gtest/gtest.h>
#include <sstream>

#include "tests/cases/cases.hpp"
#include "tests/derive/language/reading.hpp"

namespace cdot::derive {
namespace {

using test::BrokenInput;
namespace fs = std::filesystem;

bool is_hand(const BrokenInput& broken) { return broken.name.ends_with(".hand"); }

std::string messages_about(const BrokenInput& broken) {
  Library library = library_of(CDOT_SOURCE_DIR "/tests/derive/language/parts");
  const auto file = std::make_shared<const SourceFile>(broken.name, broken.input);
  if (is_hand(broken)) return messages_about_hand(file, library.at("slider"), library);
  library[fs::path(broken.name).stem().string()] = file;
  return render(*file, read_joint(file, library).diagnostics);
}

std::vector<std::string> lines_with(const std::string& mark, const std::string& text) {
  std::vector<std::string> found;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (line.find(mark) != line.npos) found.push_back(line.substr(line.find(mark) + mark.size()));
  return found;
}

std::vector<std::string> fixes_in(const std::string& messages) { return lines_with("  fix: ", messages); }

std::string errors_in(const std::string& messages) {
  std::string errors;
  for (const std::string& error : lines_with(": error: ", messages)) errors += error + "\n";
  return errors;
}

// The words in backquotes of "did you mean `pa`?", "write `-`" and "call it `v1`"; of `norm(u)` the part before the
// operand.
std::vector<std::string> offered_by(const std::string& fix) {
  std::vector<std::string> words;
  const char* const offers[] = {"did you mean `", "write `", "call it `"};
  if (std::ranges::none_of(offers, [&](const char* offer) { return fix.starts_with(offer); })) return words;
  for (std::size_t at = fix.find('`'); at != fix.npos; at = fix.find('`', at + 1)) {
    const std::size_t end = fix.find('`', at + 1);
    const std::string word = fix.substr(at + 1, end - at - 1);
    const std::size_t operand = word.find('(');
    words.push_back(word == "s^2" ? "^2" : operand == word.npos ? word : word.substr(0, operand + 1));
    at = end;
  }
  return words;
}

const std::vector<BrokenInput>& corpus() {
  static const std::vector<BrokenInput> all = [] {
    auto themes = test::themes_in(CDOT_SOURCE_DIR "/tests/derive/language/broken");
    test::update_if_asked(themes, messages_about);
    return cases_of(themes);
  }();
  return all;
}

class Broken : public testing::TestWithParam<BrokenInput> {};

TEST_P(Broken, GivesItsMessages) {
  EXPECT_EQ(messages_about(GetParam()), GetParam().messages) << "CDOT_UPDATE=1 writes the messages: read them";
  EXPECT_FALSE(GetParam().messages.empty()) << "nothing is wrong with this input";
}

// Whoever follows the fixes gets an input without errors, in which the words that they offer stand.
TEST_P(Broken, IsMendedByItsFixes) {
  const BrokenInput& broken = GetParam();
  const std::vector<std::string> fixes = fixes_in(broken.messages);
  if (fixes.empty()) return;
  ASSERT_FALSE(broken.edits.empty()) << "write `--- mended` and the lines that follow the fixes";
  const std::string mended = test::mended(broken);
  EXPECT_EQ(errors_in(messages_about({broken.name, mended, ""})), "") << mended;
  for (const std::string& fix : fixes)
    for (const std::string& word : offered_by(fix)) EXPECT_NE(mended.find(word), mended.npos) << fix << "\n" << mended;
}

INSTANTIATE_TEST_SUITE_P(Corpus, Broken, testing::ValuesIn(corpus()), [](const auto& info) {
  std::string name = info.param.name;
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
});

TEST(Corpus, IsLarge) {
  const auto hands = std::count_if(corpus().begin(), corpus().end(), is_hand);
  EXPECT_GE(static_cast<std::ptrdiff_t>(corpus().size()) - hands, 159);
  EXPECT_GE(hands, 20);
}

}  // namespace
}  // namespace cdot::derive
