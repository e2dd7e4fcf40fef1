// `cdot check`: findings in bad specs.
#include "derive/check/check.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <sstream>

#include "derive/language/specs_folder.hpp"

namespace cdot::derive {
namespace {

CheckReport checked(const std::string& rows, std::string* said = nullptr, const std::string& space = "planar") {
  const std::string text = "joint own " + space + "\n  \"own\"\n  point pa on a\n  point pb on b\n" + rows;
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

// A vector row rotates with its bodies on C = 0, unless the angle of one of them scales a part of it.
TEST(Check, AVectorRowThatARotationChangesIsRejected) {
  std::string said;
  EXPECT_FALSE(checked("  pa - pb = angle(a) * arm(pa)\n", &said).clean());
  EXPECT_TRUE(mentions(said, "angular momentum is not conserved: C1_x")) << said;
}

TEST(Check, AFactorThatMayVanishIsNotRegularEverywhere) {
  std::string said;
  EXPECT_TRUE(checked("  pa = pb\n  scalar ratio [1]\n  (1 + ratio)*(angle(a) - angle(b)) = 0\n", &said).clean());
  EXPECT_FALSE(mentions(said, "regular at every pose")) << said;
  EXPECT_TRUE(mentions(said, "ratio + 1 = 0")) << said;
}

TEST(Check, SmallRowsAreAsGoodAsLargeOnes) {
  for (const char* factor : {"1e-7", "1", "1e7"})
    EXPECT_TRUE(checked(std::string("  ") + factor + "*(pa - pb) = 0\n").clean());
}

// A sleigh, as people write it first, and as the message shows it.
TEST(Check, AVelocityRowOfOneBodyNamesTheGround) {
  const std::string blade = "joint own planar\n  \"own\"\n  point pa on a\n  unit e on a\n";
  const auto said_of = [](const std::string& text) {
    const ReadResult read = read_joint(std::make_shared<SourceFile>("own.joint", text), {});
    std::string said;
    for (const Finding& f : check(read).findings) said += render(*read.file, f);
    return said;
  };
  EXPECT_TRUE(mentions(said_of(blade + "  velocity dot(e, v(pa)) = 0\n"),
                       "declare `point ground on world = pa` and write v(pa) - v(ground) in place of v(pa)"));
  const std::string mended =
      said_of(blade + "  point ground on world = pa\n  velocity dot(e, v(pa) - v(ground)) = 0\n");
  EXPECT_FALSE(mentions(mended, "error") || mentions(mended, "warning")) << mended;
}

// The offered rows are accepted: advice never goes round in a circle.
TEST(Check, ParallelDirectionsAreOfferedAsTwoRows) {
  std::string said;
  const std::string frames = "  frame fa on a\n  frame fb on b\n  pa = pb\n";
  EXPECT_FALSE(checked(frames + "  dot(fa.x, fb.x) = 1\n", &said, "spatial").clean());
  EXPECT_TRUE(mentions(said, "write `cross(fa.x, fb.x) = 0 keep 2`")) << said;
  EXPECT_TRUE(checked(frames + "  cross(fa.x, fb.x) = 0 keep 2\n", nullptr, "spatial").clean());
  said.clear();
  EXPECT_FALSE(checked("  unit na on a\n  unit nb on b\n  pa = pb\n  dot(na, nb) = 1\n", &said, "spatial").clean());
  EXPECT_TRUE(mentions(said, "write `cross(f.x, na) = 0 keep 2` with `frame f on b` in place of `nb`")) << said;
  said.clear();
  EXPECT_FALSE(checked("  unit na on a\n  unit nb on b\n  pa = pb\n  dot(na, nb) = 1\n", &said).clean());
  EXPECT_TRUE(mentions(said, "write `angle(na, nb) = 0`")) << said;
  EXPECT_TRUE(checked("  unit na on a\n  unit nb on b\n  pa = pb\n  angle(na, nb) = 0\n").clean());
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

TEST(Check, ABodyInNoRowIsAWarning) {
  std::string said;
  EXPECT_FALSE(checked("  pa = pb\n  coordinate gap = norm(pa - x(c))\n", &said).clean());
  EXPECT_TRUE(mentions(said, "warning: the velocity of c is in no row: the joint does not act on it")) << said;
}

// A quantity of the world excuses its own row only.
TEST(Check, MomentumIsTestedRowByRow) {
  std::string said;
  EXPECT_FALSE(checked("  unit n on world\n  dot(n, pa - pb) = 0\n  angle(a) + angle(b) = 0\n", &said).clean());
  EXPECT_TRUE(mentions(said, "angular momentum is not conserved: C2")) << said;
  EXPECT_TRUE(mentions(said, "angle(a) - angle(world) in place of angle(a)")) << said;
  EXPECT_TRUE(
      checked("  point g on world\n  let u = pa - g\n  dot(u, b.x) = 0\n  pa = pb\n  angle(a) - angle(world) = 0\n")
          .clean());
  said.clear();
  EXPECT_FALSE(checked("  dot(a.x, pa - pb) + angle(b) * 1 [m] = 0\n", &said).clean());
  EXPECT_TRUE(mentions(said, "which changes C by 1 per radian; the cause is angle(b)")) << said;
}

TEST(Check, DefaultsThatLeaveCAreTold) {
  std::string said;
  EXPECT_FALSE(checked("  scalar l [m] = 2 * norm(pa - pb)\n  norm(pa - pb) = l\n", &said).clean());
  EXPECT_TRUE(mentions(said, "with the default of `l` the row does not hold at the start")) << said;
  EXPECT_TRUE(mentions(said, "fix: make `norm(pa - pb)` its default")) << said;
  EXPECT_TRUE(checked("  scalar l [m] = norm(pa - pb)\n  norm(pa - pb) = l\n").clean());
  EXPECT_TRUE(checked("  scalar l [m] = 2 * norm(pa - pb)\n  norm(pa - pb) <= l\n").clean());
  said.clear();
  EXPECT_FALSE(
      checked("  unit na on a\n  unit nb on b = na\n  pa = pb\n  dot(na, nb) = 0\n", &said, "spatial").clean());
  EXPECT_TRUE(mentions(said, "C2: with the defaults |C| is 1 at every initial pose")) << said;
}

TEST(Check, ACoordinateThatARowHoldsIsAnError) {
  std::string said;
  const std::string rows = "  pa = pb\n  angle(b) = angle(a)\n  coordinate turn = angle(b) - angle(a)\n";
  EXPECT_FALSE(checked(rows, &said).clean());
  EXPECT_TRUE(mentions(said, "own.joint:7:14: error: the coordinate turn is not free: the row C2 constrains it"))
      << said;
  EXPECT_TRUE(mentions(said, "fix: remove the coordinate")) << said;
}

// An inequality does not constrain a coordinate, which is free below the limit.
TEST(Check, AnInequalityHoldsNoCoordinate) {
  EXPECT_TRUE(checked("  norm(pa - pb) <= 2 [m]\n  coordinate length = norm(pa - pb)\n").clean());
}

// A weld drops the angle of its included revolute without an error.
TEST(Check, WhatAnIncludeLeavesFreeAndARowHoldsIsDropped) {
  const SpecsFolder folder(std::filesystem::path(CDOT_SOURCE_DIR) / "specs");
  for (const auto& [name, row] : {std::pair{"weld", "angular"}, {"driven_crank", "crank"}}) {
    const ReadResult read = folder.read(folder.find(name));
    ASSERT_TRUE(read.joint);
    const Derivation derivation = derive(*read.joint);
    EXPECT_TRUE(derivation.joint.coordinates.empty());
    EXPECT_TRUE(derivation.coordinates.empty());
    ASSERT_EQ(derivation.joint.dropped.size(), 1u);
    const Coordinate& dropped = derivation.joint.dropped.front();
    EXPECT_EQ(dropped.name, "angle");
    EXPECT_EQ(dropped.from, "revolute");
    EXPECT_EQ(dropped.constrained_by, std::vector<std::string>{row});
    EXPECT_TRUE(check(read).clean());
  }
  const Derivation free = derive(*folder.read(folder.find("prismatic")).joint);
  EXPECT_EQ(free.joint.coordinates.size(), 1u);
  EXPECT_EQ(free.coordinates.size(), 1u);
  EXPECT_TRUE(free.joint.dropped.empty());
}

TEST(Check, TellsWhereTheEffectiveMassIsSingular) {
  std::string said;
  EXPECT_TRUE(checked("  pa = pb\n", &said).clean());
  EXPECT_TRUE(mentions(said, "K is regular at every pose while a or b can move")) << said;
}

// fa.x and fb.x are parallel where C = 0, so nothing is said of poses at which they are not.
TEST(Check, TellsWhereTheEffectiveMassIsSingularInSpace) {
  std::string said;
  const std::string frames = "  frame fa on a\n  frame fb on b\n";
  EXPECT_TRUE(checked(frames + "  pa = pb\n  cross(fa.x, fb.x) = 0 keep 2\n", &said, "spatial").clean());
  EXPECT_TRUE(mentions(said, "K is regular at every pose with C = 0 that was tried")) << said;
  EXPECT_TRUE(mentions(said, "while nothing can turn, K is singular at every pose")) << said;
  EXPECT_FALSE(mentions(said, "dot(fa.x, fb.x)")) << said;
  said.clear();
  EXPECT_TRUE(checked("  norm(pa - pb) = 2 [m]\n", &said, "spatial").clean());
  EXPECT_TRUE(mentions(said, "K is regular at every pose while a or b can move\n")) << said;
  EXPECT_FALSE(mentions(said, "direction")) << said;  // 2 m apart, the points do not meet
  said.clear();
  EXPECT_TRUE(checked("  scalar l [m]\n  norm(pa - pb) = l\n", &said, "spatial").clean());
  EXPECT_TRUE(mentions(said, "C1: where pa - pb = 0, which some parameters allow, the kernel takes (1, 0, 0)")) << said;
}

// Angles as the spec writes them, each place once, and no place that cannot be.
TEST(Check, TellsOfAnglesInTheWordsOfTheSpec) {
  const auto said_of = [](const std::string& rows, const std::string& space) {
    std::string said;
    EXPECT_TRUE(checked("  norm(pa - pb) = 1 [m]\n" + rows, &said, space).clean());
    return said;
  };
  const std::string about = said_of("  unit s on a\n  unit t on b\n  unit n on b\n  angle(t, s, n) = 0\n", "spatial");
  EXPECT_TRUE(mentions(about, "C2: angle(t, s, n) jumps by 2 pi at pi; where it is undefined the kernel")) << about;
  EXPECT_FALSE(mentions(about, "^2")) << about;
  const std::string plane = said_of("  unit s on a\n  unit t on b\n  angle(t, s) = 0\n", "planar");
  EXPECT_TRUE(mentions(plane, "C2: angle(t, s) jumps by 2 pi at pi\n")) << plane;
  // A latitude turns back at its ends, where its rate divides by the root.
  const std::string latitude = said_of(
      "  frame fa on a\n  frame fb on b\n"
      "  coordinate turn [rad] = atan2(dot(fa.x, fb.z), sqrt(dot(fa.y, fb.z)^2 + dot(fa.z, fb.z)^2))\n",
      "spatial");
  EXPECT_TRUE(
      mentions(latitude, "turn in [-pi/2, pi/2] has a corner at both ends; there the kernel takes 0 for its row"))
      << latitude;
  EXPECT_FALSE(mentions(latitude, "jumps")) << latitude;
}

TEST(Check, ARowOfOneBodyIsTold) {
  std::string said;
  EXPECT_FALSE(checked("  point pc on a\n  pa = pb\n  norm(pa - pc) = 1 [m]\n", &said).clean());
  EXPECT_TRUE(mentions(said, "the row of J of C2 is zero\n")) << said;
  EXPECT_TRUE(mentions(said, "no motion changes this row")) << said;
}

// cross(fa.x, nc) is stored with the opposite sign.
TEST(Check, AVanishingVectorHasNoSign) {
  std::string said;
  EXPECT_TRUE(checked("  norm(pa - pb) = 1 [m]\n  frame fa on a\n  frame fb on b\n  unit nc on c\n"
                      "  dot(fa.x, nc) = dot(fb.x, nc)\n",
                      &said, "spatial")
                  .clean());
  EXPECT_TRUE(mentions(said, "cross(nc, fa.x) = 0")) << said;
  EXPECT_FALSE(mentions(said, "where -")) << said;
}

TEST(Check, TellsThreeWaysToMoveAtMost) {
  std::string said;
  EXPECT_TRUE(checked("  point pc on c\n  unit t on c\n  angle(a) = angle(c)\n  angle(b) = angle(c)\n"
                      "  dot(t, pc - pa) = 0\n  dot(perp(t), pc - pb) = 0\n",
                      &said)
                  .clean());
  EXPECT_TRUE(mentions(said, "c can move and a and b can turn, or in 3 other ways\n")) << said;
}

TEST(Check, TellsWhereTheEffectiveMassIsSingularOnTheConstraint) {
  const auto said_of = [](const std::string& rows, const std::string& space) {
    std::string said;
    EXPECT_TRUE(checked(rows, &said, space).clean());
    return said;
  };
  const std::string third = "  point pc on c\n  let u = pa - pb\n  let s = pc - pb\n";
  EXPECT_TRUE(mentions(said_of(third + "  scalar share [1]\n  dot(u, s) / (norm(u) * norm(s)) = share\n", "planar"),
                       "K is singular where cross(u, s) = 0"));
  const std::string skate =
      "  unit n on world\n  unit t on a\n  let side = cross(n, t)\n  point g on world\n"
      "  pa - pb = 0\n  velocity dot(side, v(pa) - v(g)) = 0\n";
  EXPECT_TRUE(mentions(said_of(skate, "spatial"), "K is singular where side = 0\n"));
  EXPECT_TRUE(mentions(said_of("  frame fa on a\n  frame fb on b = fa\n  pa = pb\n  rotation(fa, fb) = 0\n", "spatial"),
                       "K is singular on a branch of C = 0 to which the defaults do not lead"));
  const std::string scaled = "  pa = pb\n  ratio * (angle(a) - angle(b)) = 0\n";
  EXPECT_TRUE(mentions(said_of("  scalar ratio [1]\n" + scaled, "planar"), "K is singular where ratio = 0\n"));
  EXPECT_FALSE(mentions(said_of("  scalar ratio [1] above 0\n" + scaled, "planar"), "ratio = 0"));
}

// Where two vectors are parallel their cross product has no direction; the kernel takes one that may leave J = 0.
TEST(Check, NothingIsRegularWhereAGuardMayMakeItSingular) {
  std::string said;
  const std::string third = "  point pc on c\n  let u = pa - pb\n  let s = pc - pb\n  scalar phi [rad] = angle(u, s)\n";
  EXPECT_TRUE(checked(third + "  angle(u, s) = phi\n", &said, "spatial").clean());
  EXPECT_TRUE(mentions(said, "but may be singular where cross(u, s) = 0")) << said;
  said.clear();
  const std::string bent = "  point pc on c\n  let u = pa - pb\n  let s = pc - pb\n  angle(u, s) = 1.9 [rad]\n";
  EXPECT_TRUE(checked(bent, &said, "spatial").clean());
  EXPECT_FALSE(mentions(said, "but may be singular")) << said;  // at 1.9 rad they are not parallel
}

// Notes on singular poses of a wrong joint would hide its error.
TEST(Check, AWrongJointHasNoNotesOnSingularPoses) {
  std::string said;
  EXPECT_FALSE(checked("  frame fa on a\n  frame fb on b\n  cross(fa.x, fb.x) = 0\n", &said, "spatial").clean());
  EXPECT_TRUE(mentions(said, "two of the three rows are independent: write `cross(fa.x, fb.x) = 0 keep 2`")) << said;
  EXPECT_FALSE(mentions(said, "singular")) << said;
}

TEST(Check, RowsThatVanishInSpaceAreFound) {
  std::string said;
  EXPECT_FALSE(checked("  dot(pa - pb, pa - pb) = 0\n", &said, "spatial").clean());
  EXPECT_TRUE(mentions(said, "write `pa = pb`")) << said;
  EXPECT_FALSE(checked("  frame fa on a\n  frame fb on b\n  dot(fa.x, fb.x) = 1\n", &said, "spatial").clean());
  EXPECT_TRUE(mentions(said, "J vanishes where C = 0")) << said;
}

TEST(Check, TellsWhatTheKernelDoesWhereADirectionIsUndefined) {
  std::string said;
  EXPECT_TRUE(checked("  point g on world\n  norm(pa - g) + norm(pb - g) = 2 [m]\n", &said).clean());
  EXPECT_TRUE(mentions(said, "C1: where pa - g or pb - g is 0 the kernel takes (1, 0) for its direction")) << said;
}

// Names of the spec, no sign, a condition once, and none that C = 0 excludes, as a rod of 1 m without length.
TEST(Check, NotesOnGuardsAreShortAndOnTheConstraint) {
  std::string said;
  EXPECT_TRUE(checked("  point pc on c\n  point pd on d\n  unit t on c\n  let u = unit(cross(pc - pd, pb - pc))\n"
                      "  norm(pa - pb) = 1 [m]\n  dot(t, unit(cross(u, pd - pa))) = 0.1\n"
                      "  norm(pc - pd) + norm(pb - pd) = 3 [m]\n  sqrt(dot(u, t)^2 + 1) = 1.2\n",
                      &said, "spatial")
                  .clean());
  EXPECT_TRUE(mentions(said, "cross(pd - pa, u)")) << said;
  for (const char* none : {"where -", "-cross", "where pa - pb", "its root"})
    EXPECT_FALSE(mentions(said, none)) << none << " in " << said;
  std::istringstream lines(said);
  int of_note = 0;
  for (std::string line; std::getline(lines, line);) {
    EXPECT_LE(line.size(), 120u) << line;
    of_note = mentions(line, ": note: ") ? 1 : line.starts_with("    ") && !mentions(line, " | ") ? of_note + 1 : 0;
    EXPECT_LE(of_note, 2) << said;
  }
}

// The axes of a hinge are never opposite: that is another branch of C = 0, half a turn away.
TEST(Check, AnotherBranchIsNoPlaceOfAGuard) {
  std::string said;
  const std::string frames = "  frame fa on a\n  frame fb on b = fa\n  pa = pb\n",
                    twist = "  coordinate t [rad] = twist(fa, fb)\n";
  EXPECT_TRUE(checked(frames + "  cross(fa.x, fb.x) = 0 keep 2\n" + twist, &said, "spatial").clean());
  EXPECT_FALSE(mentions(said, "dot(fa.x, fb.x) + 1")) << said;
  EXPECT_TRUE(checked(frames + twist, &said, "spatial").clean());
  EXPECT_TRUE(mentions(said, "where dot(fa.x, fb.x) + 1 = 0 the kernel takes 0 for 1 over it")) << said;
}

}  // namespace
}  // namespace cdot::derive
