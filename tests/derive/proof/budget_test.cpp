// Algebra that would take hours ends at a budget. The laws are then checked at random points, the same in every run,
// which still find a wrong derivation.
#include <cstdio>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "derive/language/read.hpp"
#include "derive/proof/prove.hpp"

namespace cdot::derive {
namespace {

Joint joint_with(const std::string& rows) {
  const std::string text =
      "joint own planar\n  \"own\"\n  point pa on a\n  point pb on b\n  scalar l [m]\n"
      "  let u = pa - pb\n  let q = norm(u) / l\n  let small = q / (1 + q)\n" +
      rows;
  const ReadResult read = read_joint(std::make_shared<SourceFile>("own.joint", text), {});
  EXPECT_TRUE(read.joint) << render(*read.file, read.diagnostics);
  return *read.joint;
}

// Every function at once: multiplied out, these formulas have millions of terms.
const char* const long_row = "  smooth: sqrt(1 + q) + exp(-q) - log(2 + q) + tan(small) + abs(2 + cos(q)) = q ^ 3\n";
const char* const short_row = "  short: tan(small) + abs(2 + cos(q)) = 3\n";
const char* const power_row = "  power: (dot(u, u) + l * norm(u) + dot(u, arm(pa)))^30 = l^60\n";

TEST(Budget, WhatIsTooLongIsShownAtRandomPoints) {
  for (const char* const row : {long_row, power_row}) {
    const Joint joint = joint_with(row);
    const Proof proof = prove(joint, derive_rows(joint));
    int shown = 0;
    for (const Law& law : proof.laws) {
      shown += law.verdict == Verdict::shown ? 1 : 0;
      EXPECT_NE(law.verdict, Verdict::fails) << name_of(law.id) << ": " << law.text;
      EXPECT_NE(law.verdict, Verdict::undecided) << name_of(law.id) << ": " << law.text;
    }
    std::printf("%d laws shown at %d random points, the others proved: %s", shown, exact_points, row);
    EXPECT_GE(shown, 1) << row;
    EXPECT_TRUE(proof.holds());
  }
}

// GiNaC's order of terms depends on earlier symbols.
TEST(Budget, TheSameLawsAreProvedWhateverCameBefore) {
  std::string first;
  for (int run = 0; run < 2; ++run) {
    const Joint joint = joint_with(short_row);
    std::string verdicts;
    for (const Law& law : prove(joint, derive_rows(joint)).laws) {
      verdicts += std::string(name_of(law.id)) + ": " + std::string(name_of(law.verdict)) + "\n";
    }
    if (run == 0) first = verdicts;
    EXPECT_EQ(verdicts, first);
  }
  std::printf("%s", first.c_str());
}

// GiNaC takes numbers out of powers: after 19 names they would have 3^19 digits.
TEST(Budget, NumbersOfNestedPowersAreRefused) {
  const auto nested = [](int names) {
    std::string lets = "  let u0 = q\n";
    for (int i = 1; i <= names; ++i) lets += fmt::format("  let u{0} = (u{1} - u{1}^3/6)/2\n", i, i - 1);
    return joint_with(lets + fmt::format("  deep: u{} = 1\n", names));
  };
  const Joint three = nested(3), nineteen = nested(19);
  EXPECT_TRUE(prove(three, derive_rows(three)).holds());
  EXPECT_THROW(prove(nineteen, derive_rows(nineteen)), NumberTooLarge);
}

// Each name occurs twice in the next one: written out, C has 2^16 terms, and its slopes more.
TEST(Budget, NestedNamesAreVisitedOnce) {
  std::string lets = "  let u0 = q\n";
  for (int i = 1; i <= 16; ++i) {
    const std::string before = "u" + std::to_string(i - 1);
    lets += "  let u" + std::to_string(i) + " = sin(" + before + ")*cos(" + before + ")\n";
  }
  const Joint joint = joint_with(lets + "  u16 = 0\n");
  for (const Law& law : prove(joint, derive_rows(joint)).laws)
    EXPECT_FALSE(is_broken(law)) << name_of(law.id) << ": " << law.text;
}

// Fourteen lengths, one point in 2^14 has them all; and directions made of thirds and halves of others, which are a
// third and a half as long at every point.
TEST(Budget, RootsAreFoundHoweverMany) {
  std::string many, row = "  many: norm(u)", nested = "  vector s [m] on a\n  let u0 = u + s\n";
  for (int i = 1; i <= 14; ++i) {
    many += fmt::format("  vector s{} [m] on {}\n", i, i % 2 ? "a" : "b");
    row += fmt::format(" + norm(u + s{})", i);
  }
  for (int i = 1; i <= 8; ++i)
    nested += fmt::format("  let u{0} = (norm(u{1})*unit(u{1}) + 2*u{1})/{2}\n", i, i - 1, i % 2 ? 9 : 5);
  for (const std::string& text : {many + row + " = l\n", nested + "  nested: norm(u8) = l\n"}) {
    const Joint joint = joint_with(text);
    Block block = derive_rows(joint);
    for (const Law& law : prove(joint, block).laws)
      EXPECT_FALSE(is_broken(law)) << name_of(law.id) << ": " << law.text << "\n" << text;
    block.rows[0].J[0].w = Rational(2) * block.rows[0].J[0].w;
    EXPECT_TRUE(is_broken(prove(joint, block).of(LawId::jacobian)));
  }
}

TEST(Budget, ABrokenDerivationIsFoundOut) {
  const Joint joint = joint_with(short_row);
  Block block = derive_rows(joint);
  block.K[0][0] = block.K[0][0] + body_symbols(joint, 0).inv_m;
  block.rows[0].gamma = Rational(2) * block.rows[0].gamma;
  const Proof proof = prove(joint, block);
  for (const LawId id : {LawId::mass, LawId::gamma}) {
    std::printf("%s: %s\n", std::string(name_of(id)).c_str(), proof.of(id).text.c_str());
    EXPECT_EQ(proof.of(id).verdict, Verdict::fails);
  }
}

}  // namespace
}  // namespace cdot::derive
