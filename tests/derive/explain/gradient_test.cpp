// The gradient of a curve or surface has a name, and the axis of a turn: J reads as a person writes it, and every
// equation on the way is true.
#include <sstream>

#include "support.hpp"

using namespace cdot::derive;

namespace {

// The lines "n = ...", "grad_x = ...", "axis_x = ...", "s1 = ..." and "J = ..." of the summary above a kernel, without
// their notes.
std::vector<std::string> names_and_J(const Derivation& derivation) {
  std::vector<std::string> lines;
  for (const std::vector<Chain>& part : summarise(derivation)) {
    for (Chain chain : part) {
      const std::string name = chain.left.name;
      if (name[0] != 'n' && name[0] != 'J' && !name.starts_with("grad") && !name.starts_with("axis") && name != "s1")
        continue;
      chain.links[0].rule.clear();
      std::istringstream text(chain_text(chain, 1000));
      for (std::string line; std::getline(text, line);) lines.push_back(line);
    }
  }
  return lines;
}

std::vector<std::string> of_curve(const std::string& body) {
  return names_and_J(read_text("curve",
                               "joint curve planar\n  \"A point on a curve.\"\n  point pa on a\n  point pb on b\n"
                               "  let s = local(pa - pb, b)\n" +
                                   body));
}

using Lines = std::vector<std::string>;

}  // namespace

TEST(Gradient, HasANameInThePlane) {
  const Derivation ellipse =
      read_text("ellipse",
                "joint ellipse planar\n  \"A point on an ellipse.\"\n"
                "  point pa on a\n  point pb on b\n  frame f on b\n  scalar p [m]\n"
                "  let u = pa - pb\n  let s = local(u, f)\n  (s.x / p)^2 + 2 * (s.y / p)^2 = 1\n");
  EXPECT_EQ(names_and_J(ellipse),
            (Lines{"n = (2 s_x f_x - 4 (u × f_x) perp(f_x))/p^2", "J = [ n' | ra × n | -n' | -((rb + u) × n) ]"}));
}

TEST(Gradient, HasANameInSpace) {
  const Derivation bowl = read_text("bowl",
                                    "joint bowl spatial\n  \"A point in a bowl.\"\n"
                                    "  point pa on a\n  point pb on b\n  frame f on a\n  scalar k [1/m]\n"
                                    "  let d = pb - pa\n  let s = local(d, f)\n  s.z = k * (s.x^2 + s.y^2)\n");
  EXPECT_EQ(names_and_J(bowl),
            (Lines{"n = f_z - 2 k s_x f_x - 2 k s_y f_y", "J = [ -n' | -((ra + d) × n)' | n' | (rb × n)' ]"}));
}

// A product with the vector itself leaves one term of its lever: u × (u - h t) = -h (u × t).
TEST(Gradient, IsCollectedFromALeverOfItsOwn) {
  const Derivation cylinder = read_text("cylinder",
                                        "joint cylinder spatial\n  \"A point on a cylinder.\"\n"
                                        "  point pa on a\n  point pb on b\n  unit t on b\n  scalar r [m]\n"
                                        "  let u = pa - pb\n  dot(u, u) - dot(t, u)^2 = r^2\n");
  EXPECT_EQ(names_and_J(cylinder), (Lines{"n = 2 u - 2 (t · u) t", "J = [ n' | (ra × n)' | -n' | -((rb + u) × n)' ]"}));
}

// A turn of both bodies about the centre of b leaves C as it is: the lever of b follows from that of a.
TEST(Gradient, IsCollectedFromTheLeverOfTheOtherBody) {
  const auto of_axis = [](const std::string& rows) {
    return names_and_J(read_text("wall",
                                 "joint wall spatial\n  \"A point on a wall.\"\n  point pa on a\n  point pb on b\n"
                                 "  unit t on b\n  scalar R [m]\n  let d = pa - pb\n  let h = dot(t, d)\n" +
                                     rows));
  };
  const std::string J = "J = [ n' | (ra × n)' | -n' | -((pa - x_b) × n)' ]";
  EXPECT_EQ(of_axis("  let q = d - h*t\n  let rho = norm(q)\n  (rho - R)^2 + h^2 = R^2 / 4\n"),
            (Lines{"n = (2 rho - 2 R) unit(q) + 2 h t", J}));
  EXPECT_EQ(of_axis("  norm(cross(t, d)) - h = R\n"),
            (Lines{"J = [ (t × unit(d × t) - t)' | -(ra × (t - t × unit(d × t)))' | (t - t × unit(d × t))'"
                   " | -((pa - x_b) × (t × unit(d × t) - t))' ]"}));
}

// A sum in front of an axis may stand with either sign.
TEST(Gradient, IsCollectedWithEitherSignOfASlope) {
  EXPECT_EQ(of_curve("  scalar k [1/m]\n  scalar m\n  s.y = k * s.x^2 - m * s.x\n"),
            (Lines{"n = (m - 2 k s_x) axis_b + perp(axis_b)", "J = [ n' | ra × n | -n' | -((pa - x_b) × n) ]"}));
}

TEST(Gradient, NeverTakesANameOfTheSpec) {
  EXPECT_EQ(of_curve("  scalar n [1/m]\n  s.y = n * s.x^2\n")[0].substr(0, 6), "n_1 = ");
  EXPECT_EQ(of_curve("  scalar n_y [1/m]\n  s.y = n_y * s.x^2\n")[0].substr(0, 6), "n_1 = ");
  EXPECT_EQ(of_curve("  scalar k [1/m]\n  let n = k * s.x\n  s.y = n * s.x\n")[0].substr(0, 4), "n = ") << "of the let";
}

TEST(Gradient, IsNamedAfterItsRow) {
  const Lines two = of_curve("  scalar k [1/m]\n  track: s.y = k * s.x^2\n  k * s.y^2 = s.x\n");
  ASSERT_EQ(two.size(), 4u);
  EXPECT_EQ(two[0].substr(0, 10), "n_track = ");
  EXPECT_EQ(two[1].substr(0, 6), "n_2 = ");
  const Lines coordinate = of_curve("  scalar k [1/m]\n  s.y = k * s.x^2\n  coordinate x [m] = s.x + k * s.y^2\n");
  ASSERT_EQ(coordinate.size(), 4u);
  EXPECT_EQ(coordinate[2].substr(0, 9), "grad_x = ") << "n_x is a component of n";
}

TEST(Gradient, LeavesAPlainDirectionAlone) {
  EXPECT_EQ(of_curve("  s.y = 0\n"),
            Lines{"J = [ perp(axis_b)' | axis_b · ra | -perp(axis_b)' | -axis_b · (pa - x_b) ]"});
}

namespace {

Lines of_frames(const std::string& row) {
  return names_and_J(
      read_text("turn", "joint turn spatial\n  \"A turn.\"\n  frame fa on a\n  frame fb on b\n  " + row + "\n"));
}

}  // namespace

TEST(Axis, HasAName) {
  EXPECT_EQ(of_frames("dot(fa.z, fb.y) = dot(fa.y, fb.z)"),
            (Lines{"axis = fa_z × fb_y - fa_y × fb_z", "J = [ 0 | axis' | 0 | -axis' ]"}));
  EXPECT_EQ(of_frames("atan2(dot(fa.x, fb.z), dot(fa.z, fb.z)) = 0"),
            (Lines{"s1 = (fa_x · fb_z)^2 + (fa_z · fb_z)^2",
                   "axis = (((fa_z · fb_z) fa_x - (fa_x · fb_z) fa_z)/s1) × fb_z", "J = [ 0 | axis' | 0 | -axis' ]"}));
  EXPECT_EQ(of_frames("atan2(dot(fa.x, fb.z), dot(fa.x, fb.y)) = 0"),
            (Lines{"s1 = (fa_x · fb_y)^2 + (fa_x · fb_z)^2",
                   "axis = (((fa_x · fb_z) fb_y - (fa_x · fb_y) fb_z)/s1) × fa_x", "J = [ 0 | axis' | 0 | -axis' ]"}))
      << "both columns are sums of their own";
  EXPECT_EQ(of_frames("unit k on a\n  unit z on a\n  unit m on b\n  atan2(dot(k, m), dot(z, m)) = 0"),
            (Lines{"s1 = (k · m)^2 + (m · z)^2", "axis = (((m · z) k - (k · m) z)/s1) × m",
                   "J = [ 0 | axis' | 0 | -axis' ]"}))
      << "m × z and k × m";
  EXPECT_EQ(of_frames("scalar p, q\n  unit k on a\n  unit z on a\n  unit m on b\n  p * dot(k, m) + q * dot(z, m) = 0"),
            (Lines{"axis = (p k + q z) × m", "J = [ 0 | axis' | 0 | -axis' ]"}))
      << "k × m and m × z";
  EXPECT_EQ(of_frames("dot(fa.x, fb.z) = 0"), Lines{"J = [ 0 | (fa_x × fb_z)' | 0 | -(fa_x × fb_z)' ]"})
      << "short enough";
}

TEST(Axis, NeverTakesANameOfTheSpec) {
  EXPECT_EQ(of_frames("scalar axis_x\n  dot(fa.z, fb.y) = axis_x * dot(fa.y, fb.z)")[0].substr(0, 9), "axis_1 = ");
}

// An angle about an axis of the frame reads two of its axes: fa.x · (fa.y × fb.y) = fa.z · fb.y.
TEST(Axis, OfAnAngleAboutAnAxisOfAFrame) {
  EXPECT_EQ(of_frames("angle(fa.y, fb.y, fa.x) = 0"),
            (Lines{"s1 = (fa_y · fb_y)^2 + (fa_z · fb_y)^2",
                   "axis = (((fa_y · fb_y) fa_z - (fa_z · fb_y) fa_y)/s1) × fb_y", "J = [ 0 | axis' | 0 | -axis' ]"}));
  EXPECT_EQ(of_frames("angle(fb.y, fa.y, fb.z) = 0"),
            (Lines{"s1 = (fa_y · fb_x)^2 + (fa_y · fb_y)^2",
                   "axis = (((fa_y · fb_y) fb_x - (fa_y · fb_x) fb_y)/s1) × fa_y", "J = [ 0 | axis' | 0 | -axis' ]"}));
}

// A twist is one about any axis, whoever writes it out; and a latitude has the rate of an arc sine.
TEST(Axis, OfATwistIsHalfwayBetweenBoth) {
  EXPECT_EQ(of_frames("atan2(dot(fa.x, fb.z) - dot(fa.z, fb.x), dot(fa.x, fb.x) + dot(fa.z, fb.z)) = 0"),
            (Lines{"axis = (1/(fa_y · fb_y + 1)) (fa_y + fb_y)", "J = [ 0 | -axis' | 0 | axis' ]"}));
  EXPECT_EQ(of_frames("atan2(dot(fa.y, fb.x) - dot(fa.x, fb.y), dot(fa.x, fb.x) + dot(fa.y, fb.y)) = 0"),
            (Lines{"axis = (1/(fa_z · fb_z + 1)) (fa_z + fb_z)", "J = [ 0 | -axis' | 0 | axis' ]"}));
}

TEST(Axis, OfALatitude) {
  const Lines latitude = of_frames("atan2(dot(fa.x, fb.z), sqrt(dot(fa.y, fb.z)^2 + dot(fa.z, fb.z)^2)) = 0");
  EXPECT_EQ(latitude, (Lines{"s1 = (fa_y · fb_z)^2 + (fa_z · fb_z)^2", "axis = (1/sqrt(s1)) (fa_x × fb_z)",
                             "J = [ 0 | axis' | 0 | -axis' ]"}));
  const Lines colatitude = of_frames("atan2(norm(cross(fa.x, fb.z)), dot(fa.x, fb.z)) = 0");
  EXPECT_EQ(colatitude, Lines{"J = [ 0 | -unit(fa_x × fb_z)' | 0 | unit(fa_x × fb_z)' ]"});
}
