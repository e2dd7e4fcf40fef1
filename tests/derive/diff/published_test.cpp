// Every published entry beside the specs. The test has no list of verdicts: numbers confirm each difference.
#include <cstdio>
#include <gtest/gtest.h>
#include <map>
#include <regex>
#include <set>

#include "tests/derive/diff/support.hpp"

namespace cdot::test {
namespace {

namespace fs = std::filesystem;
using derive::Agreement;
using derive::Difference;
using derive::Judgement;

const std::vector<Judgement>& published() {
  static const std::vector<Judgement> all = [] {
    std::vector<Judgement> judgements;
    const derive::SpecsFolder folder(specs_folder());
    for (fs::path spec : folder.all()) {
      fs::path hand = spec;
      hand.replace_extension(".hand");
      if (!fs::exists(hand)) continue;
      const derive::DiffReport report = judge(hand, folder.read(spec));
      EXPECT_FALSE(report.diagnostics.has_errors()) << render(*report.file, report.diagnostics);
      judgements.insert(judgements.end(), report.judgements.begin(), report.judgements.end());
    }
    return judgements;
  }();
  return all;
}

bool breaks_momentum(const Judgement& j) {
  for (const std::string& remark : j.remarks) {
    if (remark.find(" conservation of ") != std::string::npos) return true;
  }
  return false;
}

TEST(Published, EveryDifferenceHasItsNumbers) {
  const std::regex measured(".* at \\d+ poses: generated off by ([-+.e0-9]+), published by ([-+.e0-9]+)");
  const std::regex claimed(
      "both sides at \\d+ poses: they differ by up to ([-+.e0-9]+); at the first ([-+.e0-9]+) "
      "stands where ([-+.e0-9]+) belongs");
  const std::regex read(
      "no value as published; with .* it is off by ([-+.e0-9]+) from central differences of C at "
      "\\d+ poses");
  const std::regex sizes("\\d+ x \\d+ and \\d+ x \\d+ numbers have no difference; .* at \\d+ poses");
  int counts[4] = {};
  for (const Judgement& j : published()) {
    EXPECT_EQ(j.agreement == Agreement::differs, !j.differences.empty()) << j.id;
    for (const Difference& d : j.differences) {
      std::smatch numbers;
      if (std::regex_match(d.confirmed, numbers, measured)) {
        EXPECT_LT(std::stod(numbers[1]), 1e-8) << j.id << " " << d.confirmed;
        EXPECT_GT(std::stod(numbers[2]), 1e-3) << j.id << " " << d.confirmed;
        ++counts[0];
      } else if (std::regex_match(d.confirmed, numbers, claimed)) {
        EXPECT_GT(std::stod(numbers[1]), 1e-3) << j.id << " " << d.confirmed;
        ++counts[1];
      } else if (std::regex_match(d.confirmed, numbers, read)) {
        EXPECT_LT(std::stod(numbers[1]), 1e-8) << j.id << " " << d.confirmed;
        ++counts[2];
      } else {
        EXPECT_TRUE(std::regex_match(d.confirmed, sizes)) << j.id << " is not confirmed: " << d.confirmed;
        ++counts[3];
      }
    }
  }
  std::printf(
      "%zu entries; differences: %d measured, %d claims evaluated, %d read otherwise, %d of other "
      "sizes\n",
      published().size(), counts[0], counts[1], counts[2], counts[3]);
  EXPECT_GE(published().size(), 90u);
}

TEST(Published, EqualityIsProvedAndNotOnlySeen) {
  for (const Judgement& j : published()) {
    for (const std::string& remark : j.remarks) {
      EXPECT_EQ(remark.find("algebra alone"), std::string::npos) << j.id << ": " << remark;
      EXPECT_EQ(remark.find("no pose"), std::string::npos) << j.id << ": " << remark;
    }
  }
}

TEST(Published, MomentumIsMissedOnlyWhereSomethingDiffers) {
  std::set<std::string> broken;
  for (const Judgement& j : published()) {
    if (!breaks_momentum(j)) continue;
    broken.insert(j.id);
    EXPECT_EQ(j.agreement, Agreement::differs) << j.id;
  }
  // Exact although in world axes: J times a common rotation is w x C.
  for (const char* id : {"P2P-1", "P2P-3", "P2P-4", "WLD-1", "WLD-4", "MOT-1"}) EXPECT_FALSE(broken.contains(id)) << id;
  for (const char* id : {"PRI-5", "GEA-3", "LIN-7", "FRI-1"}) EXPECT_TRUE(broken.contains(id)) << id;
}

// Sentences are short; long formulas are on the lines below.
TEST(Published, SentencesAreShort) {
  for (const Judgement& j : published()) {
    for (const Difference& d : j.differences) {
      EXPECT_LT(d.sentence.size(), 260u) << j.id << ": " << d.sentence;
      EXPECT_FALSE(d.kind.empty()) << j.id;
    }
  }
}

// Of names of bodies and joints, however many.
TEST(Published, EveryLineFitsTheTerminal) {
  derive::DiffReport report;
  report.file = std::make_shared<derive::SourceFile>("all.hand", "");
  report.judgements = published();
  std::istringstream text(to_text(report, {true, false}));
  int lines = 0;
  for (std::string line; std::getline(text, line); ++lines) EXPECT_LE(line.size(), 120u) << line;
  EXPECT_GT(lines, 500);
  EXPECT_EQ(text.str().find("publish ..."), std::string::npos) << "a number is cut off";
}

TEST(Published, SentencesNameWhatIsWrong) {
  const std::map<std::string, std::string> expected = {
      {"GEA-5", "missing term: K, row 1, column 1: the hand derivation lacks 2*inv_I_c*ratio"},
      {"PUL-4",
       "factor: Cdot, row 1: the factor w_unnamed stands where w_a belongs; equal where "
       "w_unnamed = w_a"},
      {"PRI-12", "sign: C, row angular: it has theta_initial = -phi where phi belongs"},
      {"WHL-2",
       "factor: Cdot, row line, w_b: a number and a vector cannot be added or compared: `cross(rb, "
       "ay) * v(b)`; with "
       "w(b) in place of v(b) it is right"},
      {"ANG-6",
       "factor: update, w_a: the factor sign stands where ratio belongs; equal where ratio = "
       "1"},
      {"ANG-9",
       "factor: update, w_a: the factor 1/k stands where ratio/(inv_I_b + inv_I_a*ratio^2) "
       "belongs"},
  };
  for (const auto& [id, sentence] : expected) {
    bool found = false;
    for (const Judgement& j : published()) {
      for (const Difference& d : j.differences) found = found || (j.id == id && d.kind + ": " + d.sentence == sentence);
    }
    EXPECT_TRUE(found) << id << ": " << sentence;
  }
}

}  // namespace
}  // namespace cdot::test
