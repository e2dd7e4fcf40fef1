// One slip is one item in one sentence, however many entries it spoils; and the author's choices are no slips.
#include <gtest/gtest.h>

#include "tests/derive/diff/support.hpp"

namespace cdot::test {
namespace {

using derive::Agreement;
using derive::Judgement;

struct OneThing {
  const char *joint, *items, *sentence;
};

TEST(Slips, AreTheOnlySentence) {
  const OneThing table[] = {
      // A symmetric K is wrong at both sides of the diagonal.
      {"revolute",
       "  K = [1/m(a)+1/m(b)+ra.y^2/I(a)+rb.y^2/I(b), -ra.x*ra.y/I(a) ; "
       "-ra.x*ra.y/I(a), 1/m(a)+1/m(b)+ra.x^2/I(a)+rb.x^2/I(b)]\n",
       "K, row 1, column 2, and row 2, column 1: the hand derivation lacks -inv_I_b*rb.x*rb.y; equal where rb = 0"},
      {"universal",
       "  let n = cross(fa.y, fb.z)\n  K = [(1/m(a)+1/m(b))*E + skew(ra)*I(a)^-1*skew(ra)' + "
       "skew(rb)*I(b)^-1*skew(rb)', "
       "0 ; 0, n'*(I(a)^-1 + I(b)^-1)*n]\n",
       "K, rows 1-3, column 4, and row 4, columns 1-3: nothing stands here"},
      {"fixed",
       "  assume fb.x = fa.x\n  assume fb.y = fa.y\n  let k = skew(ra)*I(a)^-1 + skew(rb)*I(b)^-1\n"
       "  K = [(1/m(a)+1/m(b))*E + skew(ra)*I(a)^-1*skew(ra)' + skew(rb)*I(b)^-1*skew(rb)', k ; k, I(a)^-1 + "
       "I(b)^-1]\n",
       "K, rows 4-6, columns 1-3: the block is transposed"},
      // Masses.
      {"revolute",
       "  K = [1/m(a)+ra.y^2/I(a)+rb.y^2/I(b), -ra.x*ra.y/I(a)-rb.x*rb.y/I(b) ; "
       "-ra.x*ra.y/I(a)-rb.x*rb.y/I(b), 1/m(a)+ra.x^2/I(a)+rb.x^2/I(b)]\n",
       "K: the terms with the inverse mass of b are missing"},
      {"revolute",
       "  K = [1/(m(a)+m(b))+ra.y^2/I(a)+rb.y^2/I(b), -ra.x*ra.y/I(a)-rb.x*rb.y/I(b) ; "
       "-ra.x*ra.y/I(a)-rb.x*rb.y/I(b), 1/(m(a)+m(b))+ra.x^2/I(a)+rb.x^2/I(b)]\n",
       "K: 1/(m(a) + m(b)) stands where 1/m(a) + 1/m(b) belongs"},
      {"target",
       "  free gamma\n  K = [1/m(a)+ra.y^2/I(a)-gamma, -ra.x*ra.y/I(a) ; -ra.x*ra.y/I(a), "
       "1/m(a)+ra.x^2/I(a)-gamma]\n",
       "K: softness makes K larger: the diagonal has -gamma where +gamma belongs"},
      {"revolute",
       "  K = [2/m(a)+ra.y^2/I(a)+rb.y^2/I(b), -ra.x*ra.y/I(a)-rb.x*rb.y/I(b) ; "
       "-ra.x*ra.y/I(a)-rb.x*rb.y/I(b), 2/m(a)+ra.x^2/I(a)+rb.x^2/I(b)]\n",
       "K, rows 1 and 2 of the diagonal: it has 2*inv_m_a where inv_m_a + inv_m_b belongs"},
      {"spherical",
       "  update v(a) += lambda/m(a)\n  update w(a) += I(a)^-1*cross(ra, lambda)\n"
       "  update v(b) -= lambda/m(b)\n  update w(b) -= cross(rb, lambda)\n",
       "update: the inverse inertia of b is missing"},
      // Of one body alone.
      {"revolute",
       "  K = [1/m(a)+m(b)+ra.y^2/I(a)+rb.y^2/I(b), -ra.x*ra.y/I(a)-rb.x*rb.y/I(b) ; "
       "-ra.x*ra.y/I(a)-rb.x*rb.y/I(b), 1/m(a)+m(b)+ra.x^2/I(a)+rb.x^2/I(b)]\n",
       "K: the mass m of b stands where 1/m belongs"},
      {"revolute",
       "  K = [1/m(a)+1/m(b)+ra.y^2*I(a)+rb.y^2/I(b), -ra.x*ra.y*I(a)-rb.x*rb.y/I(b) ; "
       "-ra.x*ra.y*I(a)-rb.x*rb.y/I(b), 1/m(a)+1/m(b)+ra.x^2*I(a)+rb.x^2/I(b)]\n",
       "K: the inertia I of a stands where 1/I belongs"},
      {"spherical", "  K = (1/m(a)+1/m(b))*E - skew(ra)*R(a)'*I(a)^-1*R(a)*skew(ra) - skew(rb)*I(b)^-1*skew(rb)\n",
       "K: the inertia of a is left in the axes of its body: A^T I^-1 A stands where I^-1 belongs"},
      {"revolute", "  K = (1/m(a)+1/m(b)+dot(ra, ra)/I(a)+dot(rb, rb)/I(b))*E\n",
       "K: of all bodies, |r|^2 E stands where perp(r) perp(r)' belongs"},
      {"revolute", "  K = (1/m(a)+1/m(b)+dot(ra, ra)/I(a))*E + perp(rb)*perp(rb)'/I(b)\n",
       "K: |ra|^2 E stands where perp(ra) perp(ra)' belongs"},
      // A term in the columns of another body.
      {"line", "  J = [t', 0, -t', cross(ra, t) - cross(rb, t) - cross(u, t)]\n",
       "J: cross(ra, t) stands in the columns of w_b, but belongs in those of w_a"},
      {"line", "  J = [t', cross(ra, t) - cross(u, t), -t', -cross(rb, t)]\n",
       "J: -cross(u, t) stands in the columns of w_a, but belongs in those of w_b"},
      {"point_on_line",
       "  let y = fa.y\n  let z = fa.z\n  J = [-y', -cross(ra, y)', y', cross(rb - d, y)' ; -z', -cross(ra, z)', z', "
       "cross(rb - d, z)']\n",
       "J: terms stand in the columns of w_b, but belong in those of w_a"},
      {"n2", "  J = [-n', -cross(ra, n)', n', cross(rb - d, n)']\n",
       "J: -cross(d, n) stands in the columns of w_b, but belongs in those of w_a"},
      // Factors.
      {"angle_ratio", "  J = [0, -1, 0, 1/ratio]\n",
       "J: all of it is 1/ratio times what it should be, which is right only with a C scaled alike"},
      {"rope", "  rows length\n  let m = u/dot(u, u)\n  J = [-m', -cross(ra, m), m', cross(rb, m)]\n",
       "J: all of it is 1/norm(u) times what it should be, which is right only with a C scaled alike"},
      {"pulley", "  J = [na', cross(ra, na), nb', cross(rb, nb)]\n",
       "J: the factor ratio is missing in the columns of b"},
      {"spherical_spherical", "  J = [-2*d', -2*cross(ra, d)', 2*d', 2*cross(rb, d)']\n",
       "J: all of it is 2 times what it should be, which is right only with a C scaled alike"},
      // Zeros.
      {"revolute", "  J = [0, 0, 0, 0, 0, 0 ; 0, 0, 0, 0, 0, 0]\n", "J: only zeros stand here"},
      {"revolute", "  J = [1, 0, -ra.y, -1, 0, rb.y ; 0, 0, 0, 0, 0, 0]\n", "J: only zeros stand in row 2"},
      {"revolute", "  J = [0, 0, -E, -S(rb)]\n", "J: only zeros stand in the columns of a"},
      // Rows.
      {"revolute", "  J = [-1, 0, ra.y, 1, 0, -rb.y ; 0, 1, ra.x, 0, -1, -rb.x]\n",
       "J: row 1 has the wrong sign: the rows of one vector equation change it together"},
      {"point_on_line",
       "  let p = fa.y + fa.z\n  let q = fa.z - 2*fa.y\n  J = [-p', -cross(ra + d, p)', p', cross(rb, p)' ; "
       "-q', -cross(ra + d, q)', q', cross(rb, q)']\n",
       "J: its rows are combinations of the right ones, which is right only with a C combined alike"},
      {"point_on_line",
       "  let y = fa.y\n  J = [-y', -cross(ra + d, y)', y', cross(rb, y)' ; -y', -cross(ra + d, y)', y', cross(rb, "
       "y)']\n",
       "J: row 2 repeats row 1, so one row is missing"},
      // Symbols and names.
      {"rolling", "  J = [n', 0, -n', -cross(rb + u, n) ; e', -radius, -e', radius - cross(rb + u, e)]\n",
       "J: -radius stands where radius belongs"},
      {"rolling",
       "  J = [n', 0, -n', -cross(rb + u, n) ; e', 1/radius, -e', -1/radius - cross(rb + u, "
       "e)]\n",
       "J: 1/radius stands where radius belongs"},
      {"target", "  K = E/m(a) + ra*ra'/I(a)\n", "K: ra and perp(ra) are exchanged"},
      {"sine_track", "  let n = f.y - amplitude*cos(k*s.x)*f.x\n  J = [n', cross(ra, n), -n', -cross(rb + u, n)]\n",
       "J: in n: the factor k is missing in -amplitude*cos(k*s_x)*f_x"},
      {"hinge",
       "  rows parallel\n  J = [0, cross(fa.y, fb.y)', 0, -cross(fa.y, fb.y)' ; 0, cross(fa.z, fb.y)', 0, "
       "-cross(fa.z, fb.y)']\n",
       "J: fb.y stands where fb.x belongs"},
      {"pulley", "  J = [ua', cross(ra, ua), ratio*nb', ratio*cross(rb, nb)]\n", "J: ua stands where na belongs"},
      {"pulley", "  J = [nb', cross(ra, nb), ratio*na', ratio*cross(rb, na)]\n", "J: na and nb are exchanged"},
      {"pulley", "  J = [na', cross(rb, na), ratio*nb', ratio*cross(ra, nb)]\n", "J: ra and rb are exchanged"},
      {"surface",
       "  let fx = height*cos(k*s.x)*sin(k*s.y)\n  let fy = height*sin(k*s.x)*cos(k*s.y)\n"
       "  let n = fa.z - fx*fa.x - fy*fa.y\n  J = [-n', -cross(ra + d, n)', n', cross(rb, n)']\n",
       "J: in n: the factor k is missing in fy"},
      {"cylindrical",
       "  let n = cross(fa.y, fb.x)\n  let m = cross(fa.z, fb.x)\n  J = [0, n', 0, -n' ; 0, m', 0, -m' ; "
       "-fa.y', -cross(ra, fa.y)', fa.y', cross(rb, fa.y)' ; -fa.z', -cross(ra, fa.z)', fa.z', cross(rb, fa.z)']\n",
       "J: the terms with d are missing"},
      // Two bodies with opposite columns.
      {"universal", "  rows bend_a\n  J = [0, fa.y', 0, -fa.y']\n",
       "J, row bend_a, w_a and, with the opposite sign, w_b: it has fa.y where -axis_bend_a belongs; equal where C = "
       "0"},
  };
  for (const OneThing& row : table) {
    const Judgement j = judged(row.joint, row.items);
    EXPECT_EQ(j.agreement, Agreement::differs) << row.items;
    ASSERT_EQ(j.differences.size(), 1u) << row.items;
    EXPECT_EQ(j.differences[0].sentence, row.sentence) << row.items;
  }
}

// A block of nine numbers that no reading explains is one item at each body.
// I(a) as the argument of an operator is the inertia, not its inverse.
TEST(Slips, BothWaysToInvertAnInertiaAgree) {
  const char* const K =
      "  let s = cross(ra + d, n)\n  let t = cross(rb, n)\n"
      "  K = 1/m(a) + 1/m(b) + s'*inverse(I(a))*s + t'*I(b)^-1*t\n";
  EXPECT_EQ(judged("n2", K).agreement, Agreement::agrees);
}

TEST(Slips, ABlockIsToldAsAWhole) {
  const Judgement j =
      judged("fixed", "  let W = (fb.x*fa.x' + fb.y*fa.y' + fb.z*fa.z')/2\n  rows angular\n  J = [0, W, 0, -W']\n");
  ASSERT_EQ(j.differences.size(), 2u);
  EXPECT_EQ(j.differences[0].sentence,
            "J, row angular, w_a: it is not the generated one: 9 entries differ (the first is shown)");
}

// Numbers that look alike are not always the slip: n = unit(u) where the length of u is divided out otherwise.
TEST(Slips, AreNotNamedByChance) {
  const Judgement j =
      judged("rope", "  rows length\n  let m = u/sqrt(norm(u)/1)\n  J = [-m', -cross(ra, m), m', cross(rb, m)]\n");
  ASSERT_EQ(j.agreement, Agreement::differs);
  for (const derive::Difference& d : j.differences)
    EXPECT_EQ(d.sentence.find("stands where"), std::string::npos) << d.sentence;
}

TEST(Slips, AScaleThatTwoQuantitiesShowIsTheAuthorsChoice) {
  const std::string Cdot = "  Cdot = w(a)/ratio + w(b)\n", J = "  J = [0, 1/ratio, 0, 1]\n";
  const Judgement both = judged("gear", Cdot + J);
  EXPECT_EQ(both.agreement, Agreement::agrees);
  ASSERT_EQ(both.remarks.size(), 1u);
  EXPECT_EQ(both.remarks[0], "C is scaled by 1/ratio: J is, too, and K twice over");
  EXPECT_EQ(judged("gear", J + "  K = [1/I(a)/ratio^2 + 1/I(b)]\n").agreement, Agreement::agrees);
  EXPECT_EQ(judged("gear", J + "  K = [1/I(a) + ratio^2/I(b)]\n").agreement, Agreement::differs);
  EXPECT_EQ(judged("gear", Cdot + "  J = [0, 1, 0, ratio]\n").agreement, Agreement::differs);
  EXPECT_EQ(judged("gear", J).agreement, Agreement::differs);  // the source may have forgotten a factor
}

// `dot(fa.z, fb.y) = dot(fa.y, fb.z)` has a second branch, half a turn away, on which the joint is never assembled.
TEST(Slips, ARowThatTheEntryAssumesMeansTheAssembledJoint) {
  const std::string J = "  rows shafts\n  J = [0, (-fa.x - fb.x)', 0, (fa.x + fb.x)']\n";
  EXPECT_EQ(judged("constant_velocity", "  assume dot(fa.z, fb.y) = dot(fa.y, fb.z)\n" + J).agreement,
            Agreement::agrees_if);
  EXPECT_EQ(judged("constant_velocity", J).agreement, Agreement::differs);
}

TEST(Slips, ABaumgarteTermWithTheWrongSignIsNamed) {
  const std::string b = "  free beta, h\n  b = v(b) + cross(w(b), rb) - v(a) - cross(w(a), ra)";
  EXPECT_EQ(judged("spherical", b + " - beta/h*(pa - pb)\n").agreement, Agreement::agrees);
  const Judgement wrong = judged("spherical", b + " + beta/h*(pa - pb)\n");
  EXPECT_EQ(wrong.agreement, Agreement::differs);
  ASSERT_EQ(wrong.remarks.size(), 3u);
  EXPECT_EQ(wrong.remarks[0], "in row 1 of b a Baumgarte term has the wrong sign: it drives C away from 0");
}

}  // namespace
}  // namespace cdot::test
