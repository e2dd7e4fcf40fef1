// One test per case, over all ways that claim to hold it. `hard_cases_tests --table` writes the table of README.md,
// `hard_cases_tests --try [CASE]` runs all ways, also those that claim nothing.
#include <algorithm>
#include <cstdio>
#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <string_view>

#include "tests/hard_cases/trial.hpp"

namespace cdot::hard {
namespace {

class HardCase : public testing::Test {
 public:
  explicit HardCase(Case hard_case) : case_(std::move(hard_case)) {}
  void TestBody() override {
    for (const Way& way : case_.ways) {
      for (const Finding& found : findings_of(case_, way)) {
        fmt::print("  {:24} {:36} {:.3e}  at most {:.3e}\n", name_of(way), found.what, found.value, found.bound);
        EXPECT_TRUE(found.held()) << name_of(way) << ": " << found.what << " is " << found.value << ", not at most "
                                  << found.bound;
      }
    }
  }

 private:
  Case case_;
};

// The method that the runtime chooses by itself holds the case.
class ByDefault : public testing::Test {
 public:
  explicit ByDefault(Case hard_case) : case_(std::move(hard_case)) {}
  void TestBody() override {
    std::string chosen;
    for (const Finding& found : findings_of(case_, by_default, &chosen)) {
      fmt::print("  {:36} {:.3e}  at most {:.3e}\n", found.what, found.value, found.bound);
      EXPECT_TRUE(found.held()) << found.what << " is " << found.value << ", not at most " << found.bound;
    }
    fmt::print("  by {}\n", chosen);
  }

 private:
  Case case_;
};

// Every way that claims nothing for a case reports the reason or stays together.
class Silence : public testing::Test {
 public:
  explicit Silence(Case hard_case) : case_(std::move(hard_case)) {}
  void TestBody() override {
    int held = 0, said = 0, inexact = 0;
    for (const Way& way : all_ways()) {
      if (std::find(case_.ways.begin(), case_.ways.end(), way) != case_.ways.end()) continue;
      const Verdict verdict = verdict_on(case_, way);
      const bool warned = !verdict.said.empty();
      ++(warned ? said : verdict.held ? held : inexact);
      EXPECT_TRUE(warned || verdict.held || verdict.together) << name_of(way) << " is lost in silence:" << verdict.off;
    }
    fmt::print("  of the ways that claim nothing {} say why, {} hold all the same, {} are inexact\n", said, held,
               inexact);
  }

 private:
  Case case_;
};

// README.md has exactly one row for every case, with the ways that claim to hold it.
class Table : public testing::Test {
 public:
  void TestBody() override {
    std::ifstream file(std::string(CDOT_HARD_CASES) + "/README.md");
    const std::string text(std::istreambuf_iterator<char>(file), {});
    std::size_t rows = 0;
    for (std::size_t at = 0; (at = text.find("\n| [", at)) != std::string::npos; ++at) ++rows;
    const std::vector<Case> cases = all_cases();
    EXPECT_EQ(rows, cases.size());
    for (const Case& hard_case : cases)
      EXPECT_NE(text.find(table_row_start(hard_case)), std::string::npos)
          << name_of(hard_case) << ": remake README.md with --table";
  }
};

// Prints the ways that hold a case, the reports of the others, and the findings of those without a report.
void try_all(std::string_view wanted) {
  for (const Case& hard_case : all_cases()) {
    if (wanted.empty() ? hard_case.large : hard_case.fault != wanted) continue;
    Ways held;
    std::string others;
    for (const Way& way : all_ways()) {
      const Verdict verdict = verdict_on(hard_case, way);
      if (verdict.held) held.push_back(way);
      else if (!verdict.said.empty()) others += fmt::format("    {:24}says: {}\n", name_of(way), verdict.said);
      else others += fmt::format("    {:24}SILENT{}\n", name_of(way), verdict.off);
    }
    fmt::print("{}: held in silence by {}\n{}", name_of(hard_case), text_of(held), others);
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace cdot::hard

int main(int count, char** arguments) {
  using namespace cdot::hard;
  const std::string_view first = count > 1 ? arguments[1] : "";
  if (first == "--table") {
    fmt::print("{}", table(all_cases()));
    return 0;
  }
  if (first == "--try") {
    try_all(count > 2 ? arguments[2] : "");
    return 0;
  }
  for (const Case& hard_case : all_cases())
    testing::RegisterTest("HardCases", name_of(hard_case).c_str(), nullptr, nullptr, __FILE__, __LINE__,
                          [hard_case]() -> testing::Test* { return new HardCase(hard_case); });
  for (const Case& hard_case : all_cases())
    testing::RegisterTest("ByDefault", name_of(hard_case).c_str(), nullptr, nullptr, __FILE__, __LINE__,
                          [hard_case]() -> testing::Test* { return new ByDefault(hard_case); });
  for (const Case& hard_case : all_cases())
    if (!hard_case.large && hard_case.ways.size() < all_ways().size())
      testing::RegisterTest("NoSilence", name_of(hard_case).c_str(), nullptr, nullptr, __FILE__, __LINE__,
                            [hard_case]() -> testing::Test* { return new Silence(hard_case); });
  testing::RegisterTest("HardCases", "table_is_current", nullptr, nullptr, __FILE__, __LINE__,
                        []() -> testing::Test* { return new Table; });
  testing::InitGoogleTest(&count, arguments);
  return RUN_ALL_TESTS();
}
