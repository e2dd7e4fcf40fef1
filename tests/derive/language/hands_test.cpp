// Hand derivations: matrices from blocks, assumptions of entries, formulas without a value.
#include <gtest/gtest.h>

#include "tests/derive/language/reading.hpp"

namespace cdot::derive {
namespace {

struct Read {
  HandFile file;
  ReadResult joint;
  HandEntry entry;
  Diagnostics diagnostics;
};

// Reads one entry with the items `body` about the slider (a line and an angle).
std::unique_ptr<Read> read(const std::string& body) {
  auto r = std::make_unique<Read>();
  const Library library = library_of(CDOT_SOURCE_DIR "/tests/derive/language/parts");
  r->file = read_hand(std::make_shared<SourceFile>("slider.hand", "entry PRI-1.a \"title\"\n source \"s\"\n" + body));
  const HandEntryAst& ast = r->file.entries.at(0);
  r->joint = read_anchored(read_joint(library.at("slider"), library), ast.anchors);
  r->entry = elaborate_entry(ast, r->file, r->joint, stand_in(r->joint), r->diagnostics);
  EXPECT_FALSE(r->file.diagnostics.has_errors()) << render(*r->file.file, r->file.diagnostics);
  EXPECT_FALSE(r->diagnostics.has_errors()) << render(*r->file.file, r->diagnostics);
  return r;
}

std::string entries(const Matrix& m) {
  std::string out;
  for (int i = 0; i < m.rows; ++i) {
    for (int j = 0; j < m.columns; ++j) out += (j == 0 ? "" : ", ") + text(m.at(i, j));
    out += ";";
  }
  return out;
}

std::string first_value(const std::string& body) {
  const auto r = read(body);
  const HandItem& item = r->entry.parts.at(0).items.at(0);
  return item.value ? entries(*item.value) : item.problem;
}

TEST(Hands, BuildJacobiansFromBlocks) {
  EXPECT_EQ(first_value(" J = [ t', cross(ra, t), -t', -cross(rb + u, t) ; 0, 1, 0, -1 ]\n"),
            "t.x, t.y, cross(ra, t), -t.x, -t.y, -cross(rb + u, t);0, 0, 1, 0, 0, -1;");
  EXPECT_EQ(first_value(" J = [ 0, 1, 0, -1 ]\n"), "0, 0, 1, 0, 0, -1;");
  EXPECT_EQ(first_value(" J = [ E, S(ra), -E, -S(rb) ]\n"), "1, 0, -ra.y, -1, 0, rb.y;0, 1, ra.x, 0, -1, -rb.x;");
}

TEST(Hands, MultiplyMatrices) {
  EXPECT_EQ(first_value(" K = [1, 2 ; 3, 4] * [5 ; 6]\n"), "17;39;");
  EXPECT_EQ(first_value(" K = [1, 2 ; 3, 4]' - E\n"), "0, 3;2, 3;");
  EXPECT_EQ(first_value(" K = [1, 2 ; 3, 4] * [1, 2 ; 3, 4]^-1\n"), "1, 0;0, 1;");
  EXPECT_EQ(first_value(" K = [1, 2] * [3 ; 4] / 11\n"), "1;");
  EXPECT_EQ(first_value(" K = [ 1/m(a) * E, 0 ; 0, 1/I(a) ]\n"), "inv_m_a, 0, 0;0, inv_m_a, 0;0, 0, inv_I_a;");
  EXPECT_EQ(first_value(" K = cross([ra.x ; ra.y], t) * [2]\n"),
            "2*cross(ra.x*world.x + ra.y*perp(world.x), t);");  // a column of two is a vector
}

TEST(Hands, SkewIsWhatTurns) {
  // S(r) w = w x r
  EXPECT_EQ(first_value(" C = S(ra) * w(a) - cross(w(a), ra)\n"), "0;0;");
}

TEST(Hands, KnowWhatEntriesAssume) {
  const auto r = read(" assume t on a\n assume dot(t, t) = 1\n assume b immovable\n free h\n C = h * dot(t, u)\n");
  EXPECT_EQ(r->entry.id, "PRI-1.a");
  EXPECT_EQ(r->entry.anchors.at("t"), "a");
  EXPECT_EQ(r->joint.joint->pool->find("t")->body, 0);
  EXPECT_EQ(r->entry.immovable, std::vector<std::string>{"b"});
  ASSERT_EQ(r->entry.assumptions.size(), 3u);
  EXPECT_EQ(entries(*r->entry.assumptions[1].left), "1;");  // t is known to have length 1
  EXPECT_EQ(r->joint.joint->pool->find("h")->role, Role::given);
}

TEST(Hands, SplitIntoPartsByRows) {
  const auto r = read(" rows line\n K = 1/m(a)\n rows slide, angular\n lambda = K^-1 * [1 ; 2]\n");
  ASSERT_EQ(r->entry.parts.size(), 2u);
  EXPECT_EQ(r->entry.parts[0].rows, std::vector<std::string>{"line"});
  EXPECT_EQ(r->entry.parts[1].items[0].value->rows, 2);
}

TEST(Hands, ReadUpdatesBoundsAndClaims) {
  const auto r = read(
      " rows line\n update w(b) -= lambda / I(b)\n update v(a) += lambda * t\n bound lambda >= 0\n"
      " bound lambda free\n claim K: K = 1/m(a)\n");
  const auto& items = r->entry.parts.at(0).items;
  ASSERT_EQ(items.size(), 5u);
  EXPECT_EQ(items[0].target, HandItem::Target::spin);
  EXPECT_EQ(items[0].body, 1);
  EXPECT_EQ(text(items[0].expression), "-inv_I_b*lambda");
  EXPECT_EQ(items[1].value->rows, 2);
  EXPECT_TRUE(items[2].pushes_only);
  EXPECT_FALSE(items[3].pushes_only);
  EXPECT_EQ(items[4].what, "K");
  EXPECT_EQ(entries(*items[4].right), "inv_m_a;");
}

TEST(Hands, SayWhyAFormulaHasNoValue) {
  EXPECT_EQ(first_value(" C = dot(t, u) + t\n"), "a number and a vector cannot be added or compared: `t`");
  EXPECT_EQ(first_value(" K = [1, 2, 3] + [1, 2]\n"), "sizes differ: 1 x 3 and 1 x 2: `[1, 2]`");
}

TEST(Hands, RemarkOnUnitsWithoutRefusing) {
  const auto r = read(" rows line\n C = dot(t, u) + 2 [kg]\n");
  EXPECT_TRUE(r->entry.parts.at(0).items.at(0).value);
  ASSERT_EQ(r->entry.remarks.size(), 1u);
  EXPECT_EQ(r->entry.remarks[0].message, "adds kilograms to metres");
}

}  // namespace
}  // namespace cdot::derive
