// Nested vectors: the search for a singular K ends, though the texts of its candidates would double with each name.
#include <gtest/gtest.h>

#include "derive/check/parts.hpp"

namespace cdot::derive {
namespace {

TEST(Nested, VectorsAreNotWrittenOut) {
  std::string text =
      "joint own planar\n  \"own\"\n  point pa on a\n  point pb on b\n  unit t on b\n  let u0 = pa - pb\n";
  for (int i = 1; i <= 30; ++i) {
    const std::string before = "u" + std::to_string(i - 1), next = "  let u" + std::to_string(i) + " = ";
    text += next + (i % 2 == 1 ? "(" + before + " + norm(" + before + ")*t)/2\n"
                               : "dot(" + before + ", t)*t - " + before + "/2\n");
  }
  const ReadResult read = read_joint(std::make_shared<SourceFile>("own.joint", text + "  norm(u30) = 1 [m]\n"), {});
  ASSERT_TRUE(read.joint) << render(*read.file, read.diagnostics);
  const Derivation derivation = derive(*read.joint);
  Findings findings;
  check_mass(subject_of(derivation), findings, nullptr);
  ASSERT_FALSE(findings.empty());
  EXPECT_EQ(findings[0].kind, "singular");
}

}  // namespace
}  // namespace cdot::derive
