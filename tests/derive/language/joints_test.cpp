// The meaning of specs: parameters and their leaves, rows, includes, anchors.
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "derive/numbers/numeric.hpp"
#include "tests/derive/language/reading.hpp"

namespace cdot::derive {
namespace {

const Library& parts() {
  static const Library library = library_of(CDOT_SOURCE_DIR "/tests/derive/language/parts");
  return library;
}

ReadResult read_body(const std::string& body, const Anchors& anchors = {}, const std::string& space = "planar") {
  const auto file = std::make_shared<SourceFile>("j.joint", "joint j " + space + "\n" + body);
  ReadResult r = read_anchored(read_joint(file, parts()), anchors);
  EXPECT_TRUE(r.joint) << render(*r.file, r.diagnostics);
  return r;
}

TEST(Joints, NameTheirLeavesAfterTheSpec) {
  const ReadResult r = read_body(
      " point pa on a\n point q on b = pa\n unit t on b\n frame f on world\n scalar l [m] = 2 [m]\n"
      " dot(t, pa - q) = l\n dot(f.x, pa - q) = l\n");
  const auto& p = r.joint->parameters;
  ASSERT_EQ(p.size(), 5u);
  EXPECT_EQ(p[0].symbol->symbol, "ra");
  EXPECT_EQ(text(p[0].value), "x_a + ra");
  EXPECT_EQ(p[1].symbol->symbol, "r_q");
  EXPECT_EQ(p[1].default_value, p[0].value);
  EXPECT_EQ(p[2].symbol->role, Role::body_vector);
  EXPECT_TRUE(p[2].symbol->unit_length);
  EXPECT_EQ(p[2].symbol->body, 1);
  EXPECT_EQ(p[3].symbol->symbol, "f_x");
  EXPECT_EQ(p[3].symbol->role, Role::world_vector);
  EXPECT_TRUE(is_number(p[4].default_value, 2));
  EXPECT_TRUE(r.joint->uses_world);
  EXPECT_EQ(r.joint->bodies, (std::vector<std::string>{"a", "b"}));
}

// Bounds are constants; samples lie between them.
TEST(Joints, HoldTheRangesOfTheirNumbers) {
  const ReadResult r = read_body(
      " scalar h [rad] between 0 and pi/2 = 1 [rad]\n scalar k above 2\n scalar l [m] below -3 [m]\n scalar n\n"
      " angle(a) - angle(b) <= h\n n * k * dot(x(a) - x(b), world.x) = l\n");
  const auto& p = r.joint->parameters;
  ASSERT_EQ(p.size(), 4u);
  EXPECT_EQ(p[0].above, 0);
  EXPECT_EQ(p[0].below, std::numbers::pi / 2);
  EXPECT_EQ(p[0].range, "between 0 and pi/2");
  EXPECT_TRUE(p[0].default_value);
  EXPECT_EQ(p[1].above, 2);
  EXPECT_EQ(p[2].below, -3);
  EXPECT_TRUE(p[3].range.empty());
  EXPECT_TRUE(std::isinf(p[3].below));
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const std::vector<Expr> leaves = {p[0].symbol, p[1].symbol, p[2].symbol, p[3].symbol};
    const Sample sample = random_sample(*r.joint, leaves, seed);
    for (const Parameter& one : {p[0], p[1], p[2], p[3]}) {
      const double value = sample.scalars.at(one.name);
      EXPECT_TRUE(one.above < value && value < one.below) << one.name << " = " << value;
    }
  }
}

// A default without a unit is in the declared one.
TEST(Joints, NumbersTakeTheDeclaredUnit) {
  const ReadResult r = read_body(
      " scalar k [1/m] = 0.25\n scalar h [rad] above -1 = 0.5\n scalar l [m] = 2\n"
      " k * norm(x(a) - x(b)) = 1\n angle(a) - angle(b) <= h\n norm(x(a) - x(b)) >= l\n");
  const auto& p = r.joint->parameters;
  ASSERT_EQ(p.size(), 3u);
  EXPECT_EQ(text(p[0].unit), "1/m");
  EXPECT_EQ(text(p[1].unit), "rad");
  EXPECT_EQ(text(p[2].unit), "m");
  EXPECT_TRUE(is_number(p[2].default_value, 2));
}

TEST(Joints, TellEqualitiesFromInequalitiesAndVelocities) {
  const ReadResult r = read_body(
      " point pa on a\n point pb on b\n unit t on b\n scalar l [m]\n pa = pb\n far: norm(pa - pb) "
      "<= l\n"
      " norm(pa - pb) >= l\n velocity dot(t, v(pa) - v(pb)) = 0\n");
  const auto& rows = r.joint->rows;
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_EQ(rows[0].name, "C1");
  EXPECT_TRUE(rows[0].C->vector);
  EXPECT_EQ(rows[1].name, "far");
  EXPECT_EQ(rows[1].kind, RowKind::inequality);
  EXPECT_EQ(rows[1].C, -rows[2].C);
  const auto& p = r.joint->parameters;
  EXPECT_EQ(rows[1].C, p[3].value - norm(p[0].value - p[1].value));
  EXPECT_EQ(rows[2].name, "C3");
  EXPECT_EQ(rows[3].kind, RowKind::velocity);
  EXPECT_EQ(rows[3].text, "velocity dot(t, v(pa) - v(pb)) = 0");
  EXPECT_EQ(text(rows[3].unit), "m/s");
}

// cross(f.x, n) = 0 leaves f.y . n = 0 and f.z . n = 0.
TEST(Joints, KeepTwoRowsOfACrossProduct) {
  const ReadResult r = read_body(" frame f on a\n unit n on b\n lock: cross(f.x, n) = 0 keep 2\n", {}, "spatial");
  ASSERT_EQ(r.joint->rows.size(), 2u);
  const auto& p = r.joint->parameters;
  EXPECT_EQ(r.joint->rows[0].C, dot(p[0].axes[1], p[1].value));
  EXPECT_EQ(r.joint->rows[1].C, dot(p[0].axes[2], p[1].value));
}

TEST(Joints, IncludeOthersOnOtherBodiesAndUnderPrefixes) {
  const ReadResult r = read_body(" include line(b, c) as left, line(a, c) as right, angle\n");
  EXPECT_EQ(r.joint->includes, (std::vector<std::string>{"line", "line", "angle"}));
  ASSERT_EQ(r.joint->rows.size(), 3u);
  EXPECT_EQ(r.joint->rows[0].name, "left_line");
  EXPECT_EQ(r.joint->rows[0].from, "line");
  EXPECT_EQ(r.joint->rows[0].text, "dot(left_t, left_u) = 0");
  EXPECT_EQ(r.joint->parameters[0].name, "left_pa");
  EXPECT_EQ(r.joint->parameters[0].symbol->symbol, "left_ra");
  EXPECT_EQ(r.joint->parameters[0].body, 1);
  EXPECT_EQ(r.joint->coordinates[1].name, "right_slide");
  EXPECT_EQ(r.joint->bodies.size(), 3u);
}

TEST(Joints, CountTheSameDeclarationOnce) {
  const ReadResult r = read_body(" include revolute, line, revolute\n");
  EXPECT_EQ(r.joint->parameters.size(), 3u);  // pa, pb, t
  EXPECT_EQ(r.joint->rows.size(), 2u);
  EXPECT_EQ(r.joint->coordinates.size(), 2u);
}

TEST(Joints, SayWhatParametersOfAnIncludeAre) {
  const ReadResult r = read_body(
      " unit up on b\n point q on a\n include line(pa = q, t = up), line(b, a, t = unit(2 * up)) "
      "as back\n");
  std::vector<std::string> names;
  for (const Parameter& p : r.joint->parameters) names.push_back(p.name);
  EXPECT_EQ(names, (std::vector<std::string>{"up", "q", "pb", "back_pa", "back_pb"}));
  ASSERT_EQ(r.joint->rows.size(), 2u);
  EXPECT_EQ(r.joint->rows[0].text, "dot(up, u) = 0");
  EXPECT_EQ(r.joint->rows[0].C, dot(r.names.at("up").e, r.names.at("u").e));
  EXPECT_EQ(r.joint->rows[1].text, "dot(unit(2 * up), back_u) = 0");
  EXPECT_EQ(r.joint->rows[1].C, dot(r.names.at("up").e, r.names.at("back_u").e));
}

TEST(Joints, GiveAPointWithItsArm) {
  const ReadResult r = read_body(" point q on a\n include with_arm(pa = q)\n");
  EXPECT_EQ(text(r.joint->rows[0].C), "norm(r_q) - l");
  const ReadResult sum = read_body(" include stretched(k = 1 + 2)\n");
  EXPECT_EQ(sum.joint->rows[0].text, "(1 + 2) * norm(u) = 2 [m]");
}

TEST(Joints, CanBeAnchoredElsewhere) {
  const ReadResult r = read_body(" include line\n", {{"t", "a"}});
  EXPECT_EQ(r.joint->parameters[2].symbol->body, 0);
  const ReadResult world = read_body(" include line\n", {{"t", "world"}});
  EXPECT_EQ(world.joint->parameters[2].symbol->role, Role::world_vector);
  EXPECT_TRUE(world.joint->uses_world);
}

TEST(Joints, KeepTheirComment) {
  const auto above = std::make_shared<SourceFile>(
      "j", "# drawn\n#   /\\\njoint j planar\n point pa on a\n point g on world\n pa = g # not this\n");
  EXPECT_EQ(read_joint(above, {}).joint->comment, "drawn\n  /\\\n");
  const auto below = std::make_shared<SourceFile>("j",
                                                  "joint j planar\n # drawn\n # twice\n point pa on a\n # not "
                                                  "this\n point g on world\n pa = g\n");
  EXPECT_EQ(read_joint(below, {}).joint->comment, "drawn\ntwice\n");
}

TEST(Joints, MayDependOnTimeAndOnTheAnglesOfTheWorld) {
  const ReadResult r = read_body(" scalar rate [rad/s]\n angle(a) - angle(world) = rate * time\n");
  EXPECT_TRUE(r.joint->uses_time);
  EXPECT_TRUE(r.joint->uses_world);
}

TEST(Joints, ReadTheSameUnderAnyLineEnd) {
  const std::string text = "joint j planar\n point pa on a\n point g on world\n pa = g\n";
  std::string windows;
  for (const char c : text) windows += c == '\n' ? std::string("\r\n") : std::string(1, c);
  const ReadResult r = read_joint(std::make_shared<SourceFile>("j", "\uFEFF" + windows), {});
  ASSERT_TRUE(r.joint);
  EXPECT_EQ(r.joint->rows[0].text, "pa = g");
}

TEST(Joints, RefuseWhatIsTooLarge) {
  std::string text = "joint j planar\n" + std::string(2 << 20, ' ');
  const ReadResult r = read_joint(std::make_shared<SourceFile>("j", text), {});
  EXPECT_FALSE(r.joint);
  EXPECT_EQ(r.diagnostics.list.size(), 1u);
}

TEST(Joints, BoundWhatIncludesMultiply) {
  Library library;
  library["j0"] = parts().at("revolute");
  for (int i = 1; i < 12; ++i) {
    const std::string below = "j" + std::to_string(i - 1), name = "j" + std::to_string(i);
    library[name] = std::make_shared<SourceFile>(
        name, "joint " + name + " planar\n include " + below + " as p, " + below + " as q\n");
  }
  const ReadResult r = read_joint(library.at("j11"), library);
  EXPECT_FALSE(r.joint);
  EXPECT_TRUE(r.diagnostics.has_errors());
}

}  // namespace
}  // namespace cdot::derive
