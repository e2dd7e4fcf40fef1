// Every case of broken/ gives exactly the messages below it (tests/cases/cases.hpp). CDOT_UPDATE=1 writes them: read
// each from the view of the user who made the error.
#include <algorithm>
#include <gtest/gtest.h>

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
