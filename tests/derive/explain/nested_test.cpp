// Nested names: a lecture grows by a few lines for each, though the formulas written out would double each time.
#include <cstdio>
#include <gtest/gtest.h>

#include "derive/explain/explain.hpp"
#include "derive/language/read.hpp"

namespace cdot::derive {
namespace {

Joint nested(int names) {
  std::string text =
      "joint own planar\n  \"own\"\n  point pa on a\n  point pb on b\n  let u0 = dot(pa - pb, a.x)/(1 [m])\n";
  for (int i = 1; i <= names; ++i) {
    const std::string before = "u" + std::to_string(i - 1);
    text += "  let u" + std::to_string(i) + " = sin(" + before + ")*cos(" + before + ")\n";
  }
  text += "  u" + std::to_string(names) + " = 0\n";
  const ReadResult read = read_joint(std::make_shared<SourceFile>("own.joint", text), {});
  EXPECT_TRUE(read.joint) << render(*read.file, read.diagnostics);
  return *read.joint;
}

TEST(Nested, NamesStayNames) {
  constexpr std::size_t letters_of_a_name = 8000, letters_without = 40000;
  for (const int names : {4, 6, 7, 8, 16, 32}) {
    const Derivation derivation = derive(nested(names));
    const std::size_t text = explanation_text(explain(derivation)).size(), json = explanation_json(derivation).size();
    std::printf("%2d names: a lecture of %zu letters, JSON of %zu\n", names, text, json);
    const std::size_t most = letters_without + letters_of_a_name * static_cast<std::size_t>(names);
    EXPECT_LT(text, most) << names;
    EXPECT_LT(json, most) << names;
  }
}

}  // namespace
}  // namespace cdot::derive
