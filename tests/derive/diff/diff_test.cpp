// `cdot diff` on derivations with known errors and with allowed deviations.
#include <algorithm>
#include <gtest/gtest.h>
#include <ostream>

#include "tests/derive/diff/support.hpp"

namespace cdot::test {
namespace {

using derive::Agreement;
using derive::Difference;
using derive::Judgement;

// A wrong Jacobian of the prismatic joint and the complete expected report.
struct Lesson {
  const char* mistake;
  const char* J;
  const char *column, *kind, *generated, *hand, *difference, *sentence;
};

void PrintTo(const Lesson& lesson, std::ostream* out) { *out << lesson.mistake; }

class Teaching : public testing::TestWithParam<Lesson> {};

TEST_P(Teaching, NamesTermRowBodyAndReason) {
  const Lesson& lesson = GetParam();
  const Judgement j = judged("prismatic", std::string("  J = ") + lesson.J + "\n");
  ASSERT_EQ(j.agreement, Agreement::differs);
  ASSERT_EQ(j.differences.size(), 1u);
  const Difference& d = j.differences[0];
  EXPECT_EQ(d.what, "J");
  EXPECT_EQ(d.row, "1");
  EXPECT_EQ(d.column, lesson.column);
  EXPECT_EQ(d.kind, lesson.kind);
  EXPECT_EQ(d.generated, lesson.generated);
  EXPECT_EQ(d.hand, lesson.hand);
  EXPECT_EQ(d.difference, lesson.difference);
  EXPECT_EQ(d.sentence, lesson.sentence);
  ASSERT_EQ(j.remarks.size(), 1u);
  EXPECT_EQ(j.remarks[0],
            "row 1 of this J breaks conservation of angular momentum: a common rotation of all "
            "bodies gives J v != 0");
}

INSTANTIATE_TEST_SUITE_P(
    Prismatic, Teaching,
    testing::Values(Lesson{"WithoutTheTermOfTheTurningAxis", "[ t', cross(ra, t), -t', -cross(rb, t) ; 0, 1, 0, -1 ]",
                           "w_b", "missing term", "-cross(rb + u, t)", "-cross(rb, t)", "cross(u, t)",
                           "J, row 1, w_b: the hand derivation lacks -cross(u, t): t turns with b "
                           "(dt/dt = w_b x t), so the "
                           "product rule has a term for it; equal where u = 0"},
                    Lesson{"AFlippedSign", "[ t', cross(ra, t), -t', -cross(rb - u, t) ; 0, 1, 0, -1 ]", "w_b", "sign",
                           "-cross(rb + u, t)", "-cross(rb - u, t)", "2*cross(u, t)",
                           "J, row 1, w_b: the term -cross(u, t) has the wrong sign: t turns with "
                           "b (dt/dt = w_b x t), so the "
                           "product rule has a term for it"},
                    Lesson{"ASwappedBody", "[ t', cross(rb, t), -t', -cross(rb + u, t) ; 0, 1, 0, -1 ]", "w_a",
                           "wrong body", "cross(ra, t)", "cross(rb, t)", "-cross(ra - rb, t)",
                           "J, row 1, w_a: rb stands where ra belongs"}),
    [](const auto& info) { return info.param.mistake; });

struct Kind {
  const char* joint;
  std::string items;
  const char* kind;
  const char* sentence;
};

Judgement expect_kind(const Kind& row) {
  const Judgement j = judged(row.joint, row.items);
  if (j.differences.empty()) {
    ADD_FAILURE() << row.items << " agrees";
    return j;
  }
  EXPECT_EQ(j.differences[0].kind, row.kind) << row.items;
  EXPECT_EQ(j.differences[0].sentence, row.sentence) << row.items;
  EXPECT_FALSE(j.differences[0].confirmed.empty()) << row.items;
  return j;
}

TEST(Diff, NamesTheKindOfEveryMistake) {
  const Kind table[] = {
      {"line", "  J = [ t', -cross(ra, t), -t', -cross(rb + u, t) ]\n", "sign", "J, row 1, w_a: the sign is wrong"},
      {"line", "  J = [ t', 2 * cross(ra, t), -t', -cross(rb + u, t) ]\n", "factor",
       "J, row 1, w_a: it is 2 times what it should be"},
      {"line", "  J = [ t', -cross(rb + u, t), -t', -cross(rb + u, t) ]\n", "wrong body",
       "J, row 1, w_a: -cross(rb + u, t) is what belongs to another body's column"},
      {"line", "  J = [ t', 0, -t', -cross(rb + u, t) ]\n", "missing term", "J, row 1, w_a: nothing stands here"},
      {"angle", "  J = [ 0, 1, [1, 0], -1 ]\n", "extra term", "J, row 1, v_b.x: nothing belongs here"},
      {"line", "  J = [ t ; cross(ra, t) ; -t ; -cross(rb + u, t) ]\n", "transposed",
       "J: 6 x 1 numbers stand where 1 x 6 belong: it is transposed"},
      {"prismatic", "  J = [ t', cross(ra, t), -t', -cross(rb + u, t) ]\n", "missing term",
       "J, row 2: 1 x 6 numbers stand where 2 x 6 belong: this row (0, 0, 1, 0, 0, -1) is missing"},
      {"line", "  K = 1/m(a) + 1/m(b) + cross(ra, t)^2/I(b) + cross(rb + u, t)^2/I(b)\n", "wrong body",
       "K, row 1, column 1: it has inv_I_b*cross(ra, t)^2 where inv_I_a*cross(ra, t)^2 belongs: "
       "inv_I_b stands "
       "where inv_I_a belongs"},
      {"line", "  claim C: dot(t, u) = 0\n", "undeclared assumption",
       "claim on C: nothing belongs here; equal where C = 0"},
      {"pulley", "  J = -[ na', cross(ra, na), nb', ratio * cross(rb, nb) ]\n", "factor",
       "J, row 1, v_b.x: the factor ratio is missing in -nb.x; equal where ratio = 1"},
      {"line", "  Cdot = dot(v(pa), t) - dot(v(b), t) + cross(rb + u, t) * v(b)\n", "factor",
       "Cdot, row 1: a number and a vector cannot be added or compared: `cross(rb + u, t) * v(b)`"},
  };
  for (const Kind& row : table) expect_kind(row);
}

TEST(Diff, ForgivesTheSignOfCAndSaysSo) {
  const Judgement j = judged("line", "  C = -dot(t, u)\n  J = [ -t', -cross(ra, t), t', cross(rb + u, t) ]\n");
  EXPECT_EQ(j.agreement, Agreement::agrees);
  ASSERT_EQ(j.remarks.size(), 1u);
  EXPECT_EQ(j.remarks[0], "C has the opposite sign: J changes its sign, K does not");
}

// C and J with one sign, b with the other: only b differs.
TEST(Diff, ChoosesTheSignWithWhichTheFewestItemsDiffer) {
  const Judgement b = judged("angle", "  C = angle(b) - angle(a) + phi\n  J = [ 0, -1, 0, 1 ]\n  b = w(b) - w(a)\n");
  ASSERT_EQ(b.differences.size(), 1u);
  EXPECT_EQ(b.differences[0].what, "b");
  EXPECT_EQ(b.differences[0].kind, "sign");
  // Neither sign makes this C right; with one sign only a single term is wrong.
  const Judgement C = judged("angle", "  C = angle(b) - angle(a) - phi\n");
  ASSERT_EQ(C.differences.size(), 1u);
  EXPECT_EQ(C.differences[0].sentence, "C, row 1: it has -phi where phi belongs");
  EXPECT_EQ(C.differences[0].kind, "sign");
}

TEST(Diff, AnAxisFixedInTheOtherBodyIsExactToo) {
  const Judgement j = judged("line",
                             "  assume t on a\n  let d = pb - pa\n"
                             "  J = [ -t', -cross(d + ra, t), t', cross(rb, t) ]\n");
  EXPECT_EQ(j.agreement, Agreement::agrees_if);
  EXPECT_EQ(j.condition, "t is fixed in a");
}

// Without b's columns a common motion of all bodies means nothing.
TEST(Diff, AnImmovableBodyBreaksNoMomentum) {
  const Judgement j = judged("revolute", "  assume b immovable\n  J = [ E, S(ra), 0, 0 ]\n");
  EXPECT_EQ(j.agreement, Agreement::agrees);
  EXPECT_TRUE(j.remarks.empty());
}

// The rows of one vector equation change their sign together, others alone.
TEST(Diff, AKAloneHasTheSignsOfItsEquations) {
  const std::string diagonal_x = "1/m(a) + 1/m(b) + ra.y^2/I(a) + rb.y^2/I(b)",
                    diagonal_y = "1/m(a) + 1/m(b) + ra.x^2/I(a) + rb.x^2/I(b)",
                    between = "(ra.x*ra.y/I(a) + rb.x*rb.y/I(b))";
  const auto K = [&](const std::string& off) {
    return "  K = [" + diagonal_x + ", " + off + " ; " + off + ", " + diagonal_y + "]\n";
  };
  EXPECT_EQ(judged("revolute", K("-" + between)).agreement, Agreement::agrees);
  const Judgement wrong = judged("revolute", K(between));
  EXPECT_EQ(wrong.agreement, Agreement::differs);
  const std::string s_a = "cross(ra, t)/I(a)", s_b = "cross(rb + u, t)/I(b)";
  const std::string line = "1/m(a) + 1/m(b) + cross(ra, t)^2/I(a) + cross(rb + u, t)^2/I(b)";
  const Judgement flipped = judged(
      "prismatic", "  K = [" + line + ", -" + s_a + " - " + s_b + " ; -" + s_a + " - " + s_b + ", 1/I(a) + 1/I(b)]\n");
  EXPECT_EQ(flipped.agreement, Agreement::agrees);
  ASSERT_EQ(flipped.remarks.size(), 1u);
  EXPECT_NE(flipped.remarks[0].find("has the opposite sign"), std::string::npos);
}

TEST(Diff, OneSlipOfAWholeMatrixIsOneSentence) {
  const std::string K =
      "[1/m(a) + 1/m(b) + ra.y^2/I(a) + rb.y^2/I(b), -ra.x*ra.y/I(a) - rb.x*rb.y/I(b) ; "
      "-ra.x*ra.y/I(a) - rb.x*rb.y/I(b), 1/m(a) + 1/m(b) + ra.x^2/I(a) + rb.x^2/I(b)]";
  const std::string of_masses =
      "[m(a) + m(b) + ra.y^2/I(a) + rb.y^2/I(b), -ra.x*ra.y/I(a) - rb.x*rb.y/I(b) ; "
      "-ra.x*ra.y/I(a) - rb.x*rb.y/I(b), m(a) + m(b) + ra.x^2/I(a) + rb.x^2/I(b)]";
  const Kind table[] = {
      {"revolute", "  K = inverse(" + K + ")\n", "inverse", "K: this is K^-1, the inverse of K"},
      {"revolute", "  K = " + of_masses + "\n", "inverse", "K: masses m stand where 1/m belongs"},
      {"revolute", "  J = [ -E, -S(rb), E, S(ra) ]\n", "wrong body", "J: ra and rb are exchanged"},
      {"revolute", "  J = [ E, S(ra)/2, -E, -S(rb) ]\n", "factor", "J: half of ra stands where ra belongs"},
      {"revolute",
       "  K = [1/m(a) + 1/m(b) + ra.y^2/I(a) + ra.y^2/I(b), -ra.x*ra.y/I(a) - ra.x*ra.y/I(b) ; "
       "-ra.x*ra.y/I(a) - ra.x*ra.y/I(b), 1/m(a) + 1/m(b) + ra.x^2/I(a) + ra.x^2/I(b)]\n",
       "wrong body", "K: in the terms of body b, ra stands where rb belongs"},
      {"prismatic",
       "  C = [ dot(t, u) ; angle(a) - angle(b) - phi ]\n"
       "  J = [ 0, 1, 0, -1 ; t', cross(ra, t), -t', -cross(rb + u, t) ]\n",
       "order", "J: rows 1 and 2 are exchanged"},
      {"prismatic", "  J = [ t', cross(ra, t), -t', -cross(rb + u, t) ; 0, 3, 0, -3 ]\n", "factor",
       "J: row 2 is 3 times what it should be"},
      {"spatial/n1", "  form local\n  J = [ 0, cross(na, nb)', 0, -cross(na, nb)' ]\n", "frame",
       "J: its columns of w are for angular velocities along the axes of the world: say `form global`"},
  };
  for (const Kind& row : table) EXPECT_EQ(expect_kind(row).differences.size(), 1u) << row.items;
}

TEST(Diff, ASignOfAllInertiasIsOneSentence) {
  const auto said = [](const std::string& of_a, const std::string& of_b) {
    const Judgement j = judged("spherical", "  K = (1/m(a) + 1/m(b))*E " + of_a + " skew(ra)*I(a)^-1*skew(ra) " + of_b +
                                                " skew(rb)*I(b)^-1*skew(rb)\n");
    return j.differences.size() == 1 ? j.differences[0].sentence : "";
  };
  EXPECT_EQ(said("+", "+"), "K: the terms with inertias have the wrong sign");
  EXPECT_EQ(said("-", "+"), "K: the terms with the inertias of b have the wrong sign");
}

// A stiffness above 0 is never 0.
TEST(Diff, NoConditionLiesOutsideTheRanges) {
  const Judgement j = judged("spring", "  force = -k*length - d*rate(length)\n");
  ASSERT_EQ(j.differences.size(), 1u);
  EXPECT_NE(j.differences[0].sentence.find("equal where rest = 0"), std::string::npos) << j.differences[0].sentence;
}

TEST(Diff, OrderAndScaleAreTheAuthorsChoice) {
  const Judgement order = judged("prismatic",
                                 "  C = [ angle(a) - angle(b) - phi ; dot(t, u) ]\n"
                                 "  J = [ 0, 1, 0, -1 ; t', cross(ra, t), -t', -cross(rb + u, t) ]\n");
  EXPECT_EQ(order.agreement, Agreement::agrees);
  ASSERT_FALSE(order.remarks.empty());
  EXPECT_NE(order.remarks[0].find("its rows stand in the order"), std::string::npos);
  const Judgement scale =
      judged("angle", "  C = 2*(angle(a) - angle(b) - phi)\n  J = [ 0, 2, 0, -2 ]\n  K = 4/I(a) + 4/I(b)\n");
  EXPECT_EQ(scale.agreement, Agreement::agrees);
  ASSERT_EQ(scale.remarks.size(), 1u);
  EXPECT_EQ(scale.remarks[0], "C is 2 times that of the spec: J is, too, and K twice over");
  EXPECT_EQ(
      judged("angle", "  C = 2*(angle(a) - angle(b) - phi)\n  J = [ 0, 2, 0, -2 ]\n  K = 1/I(a) + 1/I(b)\n").agreement,
      Agreement::differs);
}

// 1/l has no zero, l has one: there l C = 0 holds wherever the bodies are.
TEST(Diff, AScaleByAParameterIsTheAuthorsChoiceIfItHasNoZero) {
  const auto scaled = [](const std::string& by, const std::string& of_K) {
    return judged("distance", "  C = (norm(u) - l)" + by + "\n  J = [ n'" + by + ", cross(ra, n)" + by + ", -n'" + by +
                                  ", -cross(rb, n)" + by + " ]\n  K = (1/m(a) + 1/m(b) + cross(ra, n)^2/I(a) + " +
                                  "cross(rb, n)^2/I(b))" + of_K + "\n");
  };
  const Judgement right = scaled("/l", "/l^2");
  EXPECT_EQ(right.agreement, Agreement::agrees);
  ASSERT_EQ(right.remarks.size(), 1u);
  EXPECT_EQ(right.remarks[0], "C is scaled by 1/l: J is, too, and K twice over");
  EXPECT_EQ(scaled("/l", "/l").agreement, Agreement::differs);
  EXPECT_EQ(scaled("*l", "*l^2").agreement, Agreement::differs);
  const Judgement twice = scaled("*(-2)/l", "*4/l^2");
  EXPECT_EQ(twice.agreement, Agreement::agrees);
  EXPECT_EQ(twice.remarks.at(0), "C is scaled by -2/l: J is, too, and K twice over");
  const Judgement one_row = judged("prismatic",
                                   "  C = [ dot(t, u) ; (angle(a) - angle(b) - phi)/phi ]\n"
                                   "  J = [ t', cross(ra, t), -t', -cross(rb + u, t) ; 0, 1/phi, 0, -1/phi ]\n");
  EXPECT_EQ(one_row.agreement, Agreement::agrees);
  EXPECT_EQ(one_row.remarks.at(0), "C of `angular` is scaled by 1/phi: J is, too, and K twice over");
}

// |u|^2 - l^2 has the zeros of |u| - l; its J has the factor 2 |u| there.
TEST(Diff, AnotherFunctionWithTheSameZerosIsTheAuthorsChoice) {
  const auto squared = [](const std::string& of_J, const std::string& of_K) {
    return judged("distance", "  free beta, h\n  C = dot(u, u) - l^2\n  J = " + of_J +
                                  "*[ u', cross(ra, u), -u', -cross(rb, u) ]\n  K = " + of_K +
                                  "*(dot(u, u)/m(a) + dot(u, u)/m(b) + cross(ra, u)^2/I(a) + cross(rb, u)^2/I(b))\n"
                                  "  b = -2*dot(u, v(pa) - v(pb)) - beta/h*(dot(u, u) - l^2)\n");
  };
  const Judgement right = squared("2", "4");
  EXPECT_EQ(right.agreement, Agreement::agrees);
  ASSERT_EQ(right.remarks.size(), 2u);
  EXPECT_EQ(right.remarks[1], "C is another function with the same zeros: J is scaled by 2*norm(u), and K twice over");
  EXPECT_EQ(squared("1", "4").agreement, Agreement::differs);
  EXPECT_EQ(squared("2", "2").agreement, Agreement::differs);
  // The other way round, and with a B that a pose changes.
  const std::string unit = "[ -unit(d)', -cross(ra, unit(d))', unit(d)', cross(rb, unit(d))' ]";
  EXPECT_EQ(judged("spherical_spherical", "  C = norm(d) - l\n  J = " + unit + "\n").agreement, Agreement::agrees);
  EXPECT_EQ(judged("spherical_spherical", "  C = norm(d) - l\n  J = 2*" + unit + "\n").agreement, Agreement::differs);
  EXPECT_EQ(judged("pulley",
                   "  C = length^2 - (la + ratio*lb)^2\n  J = [ -na', -cross(ra, na), -ratio*nb', "
                   "-ratio*cross(rb, nb) ]\n")
                .agreement,
            Agreement::differs);
}

// Terms that a solver adds on purpose; with the wrong sign, or of a mass, they are mistakes.
TEST(Diff, BaumgarteTermsAndSoftnessAreNoMistakes) {
  const std::string C = "(angle(a) - angle(b) - phi)", rate = "(w(a) - w(b))";
  const Judgement b = judged("angle", "  free beta, h\n  b = -" + rate + " - beta/h*" + C + "\n");
  EXPECT_EQ(b.agreement, Agreement::agrees);
  ASSERT_EQ(b.remarks.size(), 1u);
  EXPECT_NE(b.remarks[0].find("plus a Baumgarte term"), std::string::npos);
  EXPECT_EQ(judged("angle", "  free beta, h\n  b = -" + rate + " + beta/h*" + C + "\n").agreement, Agreement::differs);
  const Judgement K = judged("angle", "  free softness\n  K = 1/I(a) + 1/I(b) + softness\n");
  EXPECT_EQ(K.agreement, Agreement::agrees);
  ASSERT_EQ(K.remarks.size(), 1u);
  EXPECT_NE(K.remarks[0].find("plus softness on the diagonal: softness"), std::string::npos);
  EXPECT_EQ(judged("angle", "  free softness\n  K = 1/I(a) + 1/I(b) - softness\n").agreement, Agreement::differs);
  EXPECT_EQ(judged("angle", "  K = 2/I(a) + 1/I(b)\n").agreement, Agreement::differs);
  const std::string twice = "  free softness\n  C = 2*" + C + "\n  J = [ 0, 2, 0, -2 ]\n";
  EXPECT_EQ(judged("angle", twice + "  K = 4/I(a) + 4/I(b) + softness\n").agreement, Agreement::agrees);
  EXPECT_EQ(judged("angle", twice + "  K = 1/I(a) + 1/I(b) + softness\n").agreement, Agreement::differs);
}

TEST(Diff, AnInequalityNeedsItsBound) {
  EXPECT_EQ(judged("max_distance", "  bound lambda >= 0\n").agreement, Agreement::agrees);
  EXPECT_EQ(judged("max_distance", "  bound lambda free\n").agreement, Agreement::differs);
  EXPECT_EQ(judged("distance", "  bound lambda >= 0\n").agreement, Agreement::differs);
}

TEST(Diff, UpdatesMustMakeTheVelocityConstraintHold) {
  const std::string right = "  lambda = -(w(a) - w(b)) / (1/I(a) + 1/I(b))\n  update w(a) += lambda / I(a)\n";
  EXPECT_EQ(judged("angle", right + "  update w(b) -= lambda / I(b)\n").agreement, Agreement::agrees);
  const Judgement wrong = judged("angle", right + "  update w(b) += lambda / I(b)\n");
  ASSERT_EQ(wrong.differences.size(), 1u);
  EXPECT_EQ(wrong.differences[0].column, "w_b");
  EXPECT_EQ(wrong.differences[0].kind, "sign");
  const Judgement swapped = judged("angle", right + "  update w(b) -= lambda / I(a)\n");
  ASSERT_EQ(swapped.differences.size(), 1u);
  EXPECT_EQ(swapped.differences[0].kind, "wrong body");
}

TEST(Diff, OneSlipOfAnUpdateIsOneSentence) {
  const auto update = [](const std::string& v_a, const std::string& w_a, const std::string& v_b,
                         const std::string& w_b) {
    return "  update v(a) += " + v_a + "\n  update w(a) += " + w_a + "\n  update v(b) -= " + v_b +
           "\n  update w(b) -= " + w_b + "\n";
  };
  const std::string v_a = "lambda/m(a)", v_b = "lambda/m(b)", w_a = "cross(ra, lambda)/I(a)",
                    w_b = "cross(rb, lambda)/I(b)";
  EXPECT_EQ(judged("revolute", update(v_a, w_a, v_b, w_b)).agreement, Agreement::agrees);
  const std::string to_a = "  update w(a) -= lambda/I(a)\n", to_b = "  update w(b) += lambda/I(b)\n";
  const std::string whole = "(w(a) - w(b))/(1/I(a) + 1/I(b))";
  const Kind table[] = {
      {"revolute", update("lambda", "cross(ra, lambda)", "lambda", "cross(rb, lambda)"), "missing term",
       "update: J^T lambda stands where M^-1 J^T lambda belongs"},
      {"revolute", update("lambda", w_a, "lambda", w_b), "missing term", "update: the inverse masses are missing"},
      {"revolute", update(v_a, "cross(ra, lambda)", v_b, "cross(rb, lambda)"), "missing term",
       "update: the inverse inertias are missing"},
      {"revolute", update("m(a)*lambda", w_a, "m(b)*lambda", w_b), "inverse",
       "update: masses m stand where 1/m belongs"},
      {"revolute", update(v_a, "cross(rb, lambda)/I(a)", v_b, "cross(ra, lambda)/I(b)"), "wrong body",
       "update: ra and rb are exchanged"},
      {"revolute", update(v_a, "-" + w_a, v_b, "-" + w_b), "sign", "update: the terms of w have the wrong sign"},
      {"revolute", update(v_a, w_a, "-" + v_b, "-" + w_b), "sign", "update: the terms of body b have the wrong sign"},
      {"angle", "  lambda = 2*" + whole + "\n" + to_a + to_b, "factor",
       "update: all of it is 2 times what it should be; the direction of the impulse is right, its size is not"},
      {"angle", "  lambda = -" + whole + "\n" + to_a + to_b, "sign", "update: all of it has the wrong sign"},
  };
  for (const Kind& row : table) EXPECT_EQ(expect_kind(row).differences.size(), 1u) << row.items;
}

// The entry's own condition stays in force during the search for others.
TEST(Diff, LooksForConditionsWithinWhatIsAssumed) {
  const std::string K = "  K = 1/I(b) + abs(ratio)/I(a)\n";
  const Judgement anywhere = judged("angle_ratio", K);
  ASSERT_EQ(anywhere.differences.size(), 1u);
  EXPECT_NE(anywhere.differences[0].sentence.find("equal where ratio = 1"), std::string::npos);
  const Judgement negative = judged("angle_ratio", "  free s\n  assume ratio = -s\n" + K);
  ASSERT_EQ(negative.differences.size(), 1u);
  EXPECT_NE(negative.differences[0].sentence.find("equal where ratio = -1"), std::string::npos);
}

// For vector rows in world axes a common rotation gives J v = w x C, which is 0 on C = 0.
TEST(Diff, MomentumIsJudgedWhereTheJointHolds) {
  EXPECT_TRUE(judged("revolute", "  J = [ E, S(ra), -E, -S(rb) ]\n").remarks.empty());
  const Judgement broken = judged("revolute", "  J = [ E, S(ra), -E, -S(ra) ]\n");
  ASSERT_EQ(broken.remarks.size(), 1u);
  EXPECT_EQ(broken.remarks[0],
            "rows 1, 2 of this J break conservation of angular momentum: a common rotation of all "
            "bodies gives J v != 0");
  const Judgement pushed = judged("revolute", "  J = [ E, S(ra), E, -S(rb) ]\n");
  ASSERT_FALSE(pushed.remarks.empty());
  EXPECT_NE(pushed.remarks[0].find("conservation of momentum"), std::string::npos);
}

}  // namespace
}  // namespace cdot::test
