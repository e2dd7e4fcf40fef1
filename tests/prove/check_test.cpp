// `cdot check`: what it finds in specs that no kernel should be made of.
#include <gtest/gtest.h>

#include <algorithm>

#include "derive/check.hpp"
#include "derive/specs_folder.hpp"

namespace cdot::derive {
namespace {

CheckReport checked(const std::string& rows, std::string* said = nullptr) {
  const std::string text = "joint own planar\n  \"own\"\n  point pa on a\n  point pb on b\n" + rows;
  const ReadResult read = read_joint(std::make_shared<SourceFile>("own.joint", text), {});
  EXPECT_TRUE(read.joint) << render(*read.file, read.diagnostics);
  const CheckReport report = check(read);
  for (const Finding& f : report.findings) {
    const std::string rendered = render(*read.file, f);
    std::printf("%s\n", rendered.c_str());
    if (said != nullptr) *said += rendered;
  }
  return report;
}

bool mentions(const std::string& all, const std::string& words) { return all.find(words) != std::string::npos; }

TEST(Check, ARowThatOnlyTouchesZeroHasNoForce) {
  std::string said;
  EXPECT_FALSE(checked("  dot(pa - pb, pa - pb) = 0\n", &said).clean());
  EXPECT_TRUE(mentions(said, "J vanishes where C = 0")) << said;
  EXPECT_TRUE(mentions(said, "write `pa = pb`")) << said;
}

TEST(Check, ALengthHeldAtZeroHasNoDirection) {
  std::string said;
  EXPECT_FALSE(checked("  norm(pa - pb) = 0\n", &said).clean());
  EXPECT_TRUE(mentions(said, "J is undefined wherever C = 0")) << said;
}

TEST(Check, ASquaredAngleVanishesToo) {
  std::string said;
  EXPECT_FALSE(checked("  pa = pb\n  (angle(a) - angle(b))^2 = 0\n", &said).clean());
  EXPECT_TRUE(mentions(said, "J vanishes where C = 0")) << said;
}

TEST(Check, DependentRowsAreNamed) {
  std::string said;
  EXPECT_FALSE(checked("  pa = pb\n  dot(pa - pb, a.x) = 0\n", &said).clean());
  EXPECT_TRUE(mentions(said, "is a combination of the rows before it")) << said;
}

TEST(Check, AbsoluteAnglesDoNotConserveMomentum) {
  std::string said;
  EXPECT_FALSE(checked("  pa = pb\n  angle(a) + angle(b) = 0\n", &said).clean());
  EXPECT_TRUE(mentions(said, "angular momentum is not conserved")) << said;
  EXPECT_TRUE(mentions(said, "angle(a) and angle(b)")) << said;
}

TEST(Check, TellsWhereTheEffectiveMassIsSingular) {
  std::string said;
  EXPECT_TRUE(checked("  pa = pb\n", &said).clean());
  EXPECT_TRUE(mentions(said, "K is regular at every pose while a or b can move")) << said;
}

TEST(Check, TellsWhatTheKernelDoesWhereADirectionIsUndefined) {
  std::string said;
  EXPECT_TRUE(checked("  norm(pa - pb) = 2 [m]\n", &said).clean());
  EXPECT_TRUE(mentions(said, "the kernel takes (1, 0)")) << said;
}

TEST(Check, TheCatalogueIsClean) {
  const SpecsFolder folder(std::filesystem::path(CDOT_SOURCE_DIR) / "specs");
  for (const std::filesystem::path& spec : folder.all()) {
    const ReadResult read = folder.read(spec);
    ASSERT_TRUE(read.joint) << render(*read.file, read.diagnostics);
    const CheckReport report = check(read);
    for (const Finding& f : report.findings) {
      EXPECT_EQ(f.level, Level::note) << render(*read.file, f);
    }
  }
}

}  // namespace
}  // namespace cdot::derive
