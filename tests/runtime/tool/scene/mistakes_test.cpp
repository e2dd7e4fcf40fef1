// Every case in broken/ gives exactly the report below it (tests/cases/cases.hpp; CDOT_UPDATE=1 writes the reports). No
// damaged file crashes the reader.
#include <gtest/gtest.h>
#include <random>

#include "tests/cases/cases.hpp"
#include "tests/runtime/tool/support.hpp"

namespace cdot::test {
namespace {

namespace fs = std::filesystem;

std::string report_on(std::string_view text, const std::string& name) {
  try {
    read_scene(text, name);
  } catch (const SceneError& error) {
    return error.what();
  }
  return "no mistakes\n";
}

std::vector<Theme> mistakes() { return themes_in(source_dir() / "tests/runtime/tool/scene/broken"); }

TEST(Mistakes, AreReportedWordForWord) {
  std::vector<Theme> themes = mistakes();
  update_if_asked(themes, [](const BrokenInput& broken) { return report_on(broken.input, broken.name); });
  EXPECT_GE(cases_of(themes).size(), 105u);
  for (const BrokenInput& broken : cases_of(themes))
    EXPECT_EQ(report_on(broken.input, broken.name), broken.messages) << broken.name;
}

// toml++ recurses once for each part of a key: 40,000 of them ended in a crash.
TEST(Mistakes, KeysOfAnyDepthAreRefused) {
  std::string key = "a";
  for (int k = 1; k < 40000; ++k) key += ".a";
  for (const std::string& text : {key + " = 1\n", "[" + key + "]\nx = 1\n", "[[" + key + "]]\n",
                                  "b = {" + key + " = 1}\n", R"('x'."y # \" z".)" + key + " = 1\n"}) {
    const std::string report = report_on(text, "deep.toml");
    EXPECT_NE(report.find("a key has more than 16 parts"), std::string::npos) << report.substr(0, 200);
  }
  const std::string dots(100, '.');
  for (const std::string& text : {"# " + dots + "\n", "title = \"" + dots + "\"\n", "title = '''\n" + dots + "'''\n",
                                  R"(title = """\" )" + dots + "\"\"\"\n", std::string("a.b.c.d = 1\n")}) {
    EXPECT_EQ(report_on(text, "dots.toml").find("parts"), std::string::npos) << text;
  }
}

TEST(Mistakes, AreCountedAndAllShown) {
  const BrokenInput many = case_named(mistakes(), "many_at_once.toml");
  try {
    read_scene(many.input, many.name);
    FAIL() << "no mistake found";
  } catch (const SceneError& error) {
    EXPECT_EQ(error.mistakes, 10);
  }
}

TEST(Mistakes, OfManyCopiesAreNotRepeatedWithoutEnd) {
  const std::string report = report_on(
      "[[body]]\nrepeat = 1000\nname = \"b{i}\"\nmass = 1\ninertia = 1\nshift = { mass = -1 }\n", "copies.toml");
  EXPECT_LT(std::count(report.begin(), report.end(), '\n'), 250);
  EXPECT_NE(report.find("copies.toml: 949 more"), std::string::npos) << report.substr(report.size() - 200);
}

// For every sequence of bytes the reader returns a scene or errors.
TEST(Mistakes, DamagedFilesAreReadOrRefused) {
  std::mt19937 random(1);
  const auto below = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
  int refused = 0;
  for (const fs::path& file : files_in(scenes_dir(), ".toml")) {
    if (file.stem() == "catenary_100") continue;
    const std::string whole = read_text(file);
    for (int k = 0; k < 150; ++k) {
      std::string text = whole;
      for (std::size_t edits = 1 + below(4); edits > 0; --edits) {
        const std::size_t at = below(text.size()), from = below(text.size());
        const std::string piece = text.substr(from, below(20));
        if (below(2) == 0) text[at] = static_cast<char>(below(256));
        if (below(2) == 0) text.erase(at, below(20));
        text.insert(std::min(at, text.size()), piece);
      }
      refused += report_on(text, "damaged.toml") != "no mistakes\n";
    }
  }
  EXPECT_GT(refused, 500);
}

TEST(Mistakes, HugeFilesAreRefusedInBoundedTime) {
  EXPECT_NE(report_on(std::string(1 << 20, '['), "deep.toml"), "no mistakes\n");
  EXPECT_NE(report_on("x = " + std::string(1 << 20, '['), "deep.toml"), "no mistakes\n");
  EXPECT_NE(report_on(std::string(1 << 20, 'x') + " = 1", "long.toml"), "no mistakes\n");
  EXPECT_LT(report_on("title = \"" + std::string(1 << 20, 'x'), "long.toml").size(), 1000u);
}

}  // namespace
}  // namespace cdot::test
