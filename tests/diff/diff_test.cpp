// `cdot diff`: what it says of derivations that are wrong in known ways, and what it owes to every published one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <set>

#include "derive/diff.hpp"

namespace cdot::derive {
namespace {

namespace fs = std::filesystem;

const fs::path specs = fs::path(CDOT_SOURCE_DIR) / "specs";

// Judges one entry, written as a person would, against a joint of the catalogue.
Judgement judged(const std::string& joint, const std::string& items) {
  const fs::path folder = fs::path(testing::TempDir()) / "cdot_diff_test";
  fs::create_directories(folder);
  const fs::path hand = folder / (joint + ".hand");
  std::ofstream(hand) << "entry X-1 \"a person's own\"\n  source \"own\"\n" << items;
  const DiffReport report =
      judge(hand, specs / "planar" / (joint + ".joint"), SpecsFolder(specs));
  EXPECT_FALSE(report.diagnostics.has_errors()) << render(*report.file, report.diagnostics);
  if (report.judgements.size() != 1) {
    ADD_FAILURE() << "the entry was not judged";
    return {};
  }
  std::printf("%s\n", to_text(report, true).c_str());
  return report.judgements[0];
}

TEST(Diff, TeachesThatTheAxisTurnsWithItsBody) {
  const Judgement j = judged("prismatic",
                             "  J = [ t', cross(ra, t), -t', -cross(rb, t) ;\n"
                             "        0,  1,            0,   -1 ]\n");
  ASSERT_EQ(j.agreement, Agreement::differs);
  ASSERT_EQ(j.differences.size(), 1u);
  const Difference& d = j.differences[0];
  EXPECT_EQ(d.what, "J");
  EXPECT_EQ(d.row, "1");
  EXPECT_EQ(d.column, "w_b");
  EXPECT_EQ(d.kind, "missing term");
  EXPECT_EQ(d.generated, "-cross(rb + u, t)");
  EXPECT_EQ(d.hand, "-cross(rb, t)");
  EXPECT_EQ(d.difference, "cross(u, t)");
  EXPECT_NE(d.sentence.find("lacks -cross(u, t): t turns with b (dt/dt = w_b x t)"), std::string::npos)
      << d.sentence;
  ASSERT_EQ(j.remarks.size(), 1u);
  EXPECT_NE(j.remarks[0].find("angular momentum"), std::string::npos);
}

struct Kind {
  const char* joint;
  const char* items;
  const char* kind;
};

TEST(Diff, NamesTheKindOfEveryMistake) {
  const Kind table[] = {
      {"line", "  J = [ t', -cross(ra, t), -t', -cross(rb + u, t) ]\n", "sign"},
      {"line", "  J = [ t', 2 * cross(ra, t), -t', -cross(rb + u, t) ]\n", "factor"},
      {"line", "  J = [ t', -cross(rb + u, t), -t', -cross(rb + u, t) ]\n", "wrong body"},
      {"line", "  J = [ t', 0, -t', -cross(rb + u, t) ]\n", "missing term"},
      {"angle", "  J = [ 0, 1, [1, 0], -1 ]\n", "extra term"},
      {"line", "  J = [ t ; cross(ra, t) ; -t ; -cross(rb + u, t) ]\n", "transposed"},
      {"line", "  K = 1/m(a) + 1/m(b) + cross(ra, t)^2/I(b) + cross(rb + u, t)^2/I(b)\n", "wrong body"},
      {"line", "  claim C: dot(t, u) = 0\n", "undeclared assumption"},
  };
  for (const Kind& row : table) {
    const Judgement j = judged(row.joint, row.items);
    ASSERT_FALSE(j.differences.empty()) << row.items;
    const bool found = std::any_of(j.differences.begin(), j.differences.end(),
                                   [&](const Difference& d) { return d.kind == row.kind; });
    EXPECT_TRUE(found) << row.items << " is called " << j.differences[0].kind << ", not " << row.kind;
  }
}

TEST(Diff, ForgivesTheSignOfCAndSaysSo) {
  const Judgement j = judged("line", "  C = -dot(t, u)\n  J = [ -t', -cross(ra, t), t', cross(rb + u, t) ]\n");
  EXPECT_EQ(j.agreement, Agreement::agrees);
  ASSERT_EQ(j.remarks.size(), 1u);
  EXPECT_NE(j.remarks[0].find("the other way round"), std::string::npos);
}

TEST(Diff, AnAxisFixedInTheOtherBodyIsExactToo) {
  const Judgement j = judged("line",
                             "  assume t on a\n  let d = pb - pa\n"
                             "  J = [ -t', -cross(d + ra, t), t', cross(rb, t) ]\n");
  EXPECT_EQ(j.agreement, Agreement::agrees_if);
  EXPECT_EQ(j.condition, "t is fixed in a");
}

TEST(Diff, AnInequalityNeedsItsBound) {
  EXPECT_EQ(judged("max_distance", "  bound lambda >= 0\n").agreement, Agreement::agrees);
  EXPECT_EQ(judged("max_distance", "  bound lambda free\n").agreement, Agreement::differs);
}

TEST(Diff, UpdatesMustMakeTheVelocityConstraintHold) {
  const std::string right = "  lambda = -(w(a) - w(b)) / (1/I(a) + 1/I(b))\n  update w(a) += lambda / I(a)\n";
  EXPECT_EQ(judged("angle", right + "  update w(b) -= lambda / I(b)\n").agreement, Agreement::agrees);
  const Judgement wrong = judged("angle", right + "  update w(b) += lambda / I(b)\n");
  ASSERT_EQ(wrong.differences.size(), 1u);
  EXPECT_EQ(wrong.differences[0].column, "w_b");
  EXPECT_EQ(wrong.differences[0].kind, "sign");
}

// Published entries: no verdict is written down here; each is held against finite differences.
TEST(Diff, EveryPublishedMistakeIsConfirmedByFiniteDifferences) {
  const SpecsFolder folder(specs);
  int entries = 0, confirmed = 0;
  for (fs::path spec : folder.all()) {
    fs::path hand = spec;
    hand.replace_extension(".hand");
    if (!fs::exists(hand)) continue;
    const DiffReport report = judge(hand, spec, folder);
    EXPECT_FALSE(report.diagnostics.has_errors()) << render(*report.file, report.diagnostics);
    for (const Judgement& j : report.judgements) {
      ++entries;
      EXPECT_EQ(j.agreement == Agreement::differs, !j.differences.empty()) << j.id;
      for (const std::string& remark : j.remarks) {
        EXPECT_EQ(remark.find("algebra alone"), std::string::npos) << j.id << ": not proved";
      }
      for (const Difference& d : j.differences) {
        EXPECT_FALSE(d.sentence.empty()) << j.id;
        if (d.confirmed.empty()) continue;
        double generated = 1, published = 0;
        int poses = 0;
        ASSERT_EQ(std::sscanf(d.confirmed.c_str(),
                              "central differences of C at %d poses: generated off by %lf, published by %lf",
                              &poses, &generated, &published), 3) << d.confirmed;
        EXPECT_LT(generated, 1e-7) << j.id << " " << d.what;
        EXPECT_GT(published, 1e-3) << j.id << " " << d.what;
        ++confirmed;
      }
    }
  }
  std::printf("%d entries judged, %d differences confirmed by finite differences\n", entries, confirmed);
  EXPECT_GE(entries, 85);
  EXPECT_GE(confirmed, 25);
}

}  // namespace
}  // namespace cdot::derive
