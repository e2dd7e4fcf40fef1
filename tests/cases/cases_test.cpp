// The format of case files: writing and reading keeps every byte, and errors name the line.
#include "tests/cases/cases.hpp"

#include <gtest/gtest.h>
#include <stdexcept>

namespace cdot::test {
namespace {

std::string mistake_in(const std::string& text) {
  try {
    parse_theme(text, "theme.cases");
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "none";
}

TEST(Cases, AreReadAsTheyAreTyped) {
  const Theme theme = parse_theme(
      "About this.\n\n--- case one.joint\na\n\nb\\x\n--- messages\nm\n\n--- case two.joint escaped\n"
      "\\xefa\\\\\n\\\n--- messages\n\n--- case three.joint\nc\n",
      "theme.cases");
  EXPECT_EQ(theme.about, "About this.\n\n");
  ASSERT_EQ(theme.cases.size(), 3u);
  EXPECT_EQ(theme.cases[0].name, "one.joint");
  EXPECT_EQ(theme.cases[0].input, "a\n\nb\\x\n");
  EXPECT_EQ(theme.cases[0].messages, "m\n");
  EXPECT_EQ(theme.cases[1].name, "two.joint");
  EXPECT_EQ(theme.cases[1].input,
            "\xef"
            "a\\\n");
  EXPECT_EQ(theme.cases[1].messages, "");
  EXPECT_EQ(theme.cases[2].input, "c\n");
  EXPECT_EQ(theme.cases[2].messages, "");
}

TEST(Cases, AreWrittenSuchThatTheyAreReadAgain) {
  std::string every_byte;
  for (int byte = 0; byte < 256; ++byte) every_byte += static_cast<char>(byte);
  Theme theme{"theme.cases", "About\n\n", {}};
  for (const std::string& text : {std::string(), std::string("\n"), std::string("a\n\n"), std::string("\n\n\n"),
                                  std::string("no end"), std::string("--- case x\n--- messages\n"), every_byte,
                                  std::string("\xef\xbb\xbf"
                                              "a\n"),
                                  std::string("tab\tand \xc3\xa9\n"), std::string("\\")})
    for (const std::string& messages : {std::string(), std::string("m\n"), text})
      theme.cases.push_back({"case_" + std::to_string(theme.cases.size()), text, messages});
  const std::string written = text_of(theme);
  const Theme again = parse_theme(written, "theme.cases");
  EXPECT_EQ(again.about, theme.about);
  ASSERT_EQ(again.cases.size(), theme.cases.size());
  for (std::size_t i = 0; i < again.cases.size(); ++i) {
    EXPECT_EQ(again.cases[i].name, theme.cases[i].name);
    EXPECT_EQ(again.cases[i].input, theme.cases[i].input) << i;
    EXPECT_EQ(again.cases[i].messages, theme.cases[i].messages) << i;
  }
  EXPECT_EQ(text_of(again), written);
}

TEST(Cases, MistakesAreNamedWithTheirLine) {
  EXPECT_EQ(mistake_in("--- case a\n--- case a\n"), "theme.cases:2: a second case of this name");
  EXPECT_EQ(mistake_in("--- case a\n--- message\n"),
            "theme.cases:1: `--- case NAME`, `--- messages` or `--- mended` belongs here: --- message\n");
  EXPECT_EQ(mistake_in("--- case a escaped\n\\n\n"),
            "theme.cases:1: an escape is `\\xNN`, `\\\\` or `\\` at the end of a line");
  EXPECT_EQ(mistake_in("--- case a escaped\n\\xg0\n"),
            "theme.cases:1: an escape is `\\xNN`, `\\\\` or `\\` at the end of a line");
}

}  // namespace
}  // namespace cdot::test
