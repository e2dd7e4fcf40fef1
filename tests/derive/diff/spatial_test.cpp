// `cdot diff` in space: three-wide blocks, the three forms of velocity, tensors, one report for an error in vectors.
#include <fstream>
#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/derive/diff/support.hpp"

namespace cdot::test {
namespace {

namespace fs = std::filesystem;
using derive::Agreement;
using derive::Judgement;

const char* const ball =
    "joint ball spatial\n"
    "  point pa on a\n"
    "  point pb on b = pa\n"
    "  pin: pa = pb\n";

// Two directions at a right angle.
const char* const square =
    "joint square spatial\n"
    "  unit na on a\n"
    "  unit nb on b\n"
    "  angular: dot(na, nb) = 0\n";

Judgement judged_beside(const std::string& spec, const std::string& items) {
  const fs::path folder = fs::path(testing::TempDir()) / ("cdot_diff_spatial_" + std::to_string(getpid()));
  fs::create_directories(folder);
  std::ofstream(folder / "own.joint") << spec;
  std::ofstream(folder / "own.hand") << "entry X-1 \"own\"\n  source \"own\"\n" << items;
  const derive::DiffReport report =
      judge(folder / "own.hand", derive::SpecsFolder(specs_folder()).read(folder / "own.joint"));
  fs::remove_all(folder);
  EXPECT_FALSE(report.diagnostics.has_errors()) << render(*report.file, report.diagnostics);
  std::printf("%s\n", to_text(report, {.all = true}).c_str());
  return report.judgements.empty() ? Judgement{} : report.judgements[0];
}

void expect_proved(const Judgement& j) {
  EXPECT_EQ(j.agreement, Agreement::agrees);
  for (const std::string& remark : j.remarks) EXPECT_EQ(remark.find("algebra alone"), std::string::npos) << remark;
}

TEST(Spatial, BlocksAreThreeWide) {
  expect_proved(judged_beside(ball,
                              "  C = pa - pb\n"
                              "  J = [ E, -skew(ra), -E, skew(rb) ]\n"
                              "  K = (1/m(a) + 1/m(b)) * E + skew(ra) * I(a)^-1 * skew(ra)' + "
                              "skew(rb) * I(b)^-1 * skew(rb)'\n"
                              "  b = -v(a) + skew(ra) * w(a) + v(b) - skew(rb) * w(b)\n"));
}

TEST(Spatial, JIsComparedInAllThreeForms) {
  expect_proved(judged_beside(square, "  form global\n  J = [ 0, -nb' * skew(na), 0, nb' * skew(na) ]\n"));
  expect_proved(judged_beside(square,
                              "  form local\n"
                              "  J = [ 0, -nb' * skew(na) * R(a), 0, nb' * skew(na) * R(b) ]\n"));
  expect_proved(judged_beside(square,
                              "  form euler\n"
                              "  J = [ 0, -2 * nb' * skew(na) * G(a), 0, 2 * nb' * skew(na) * G(b) ]\n"));
  expect_proved(judged_beside(ball, "  form euler\n  J = [ E, -2 * skew(ra) * G(a), -E, 2 * skew(rb) * G(b) ]\n"));
}

TEST(Spatial, WrongFormsDifferAndAreMeasured) {
  const Judgement local =
      judged_beside(square, "  form local\n  J = [ 0, -nb' * skew(na), 0, nb' * skew(na) * R(b) ]\n");
  EXPECT_EQ(local.agreement, Agreement::differs);
  for (const auto& d : local.differences) {
    EXPECT_EQ(d.column.substr(0, 4), "w'_a");
    EXPECT_NE(d.confirmed.find("central differences"), std::string::npos);
  }
  const Judgement euler =
      judged_beside(square, "  form euler\n  J = [ 0, -nb' * skew(na) * G(a), 0, 2 * nb' * skew(na) * G(b) ]\n");
  ASSERT_EQ(euler.differences.size(), 1u);
  EXPECT_EQ(euler.differences[0].column, "edot_a");
  EXPECT_EQ(euler.differences[0].kind, "factor");
  EXPECT_NE(euler.differences[0].sentence.find("it is 0.5 times what it should be"), std::string::npos);
}

TEST(Spatial, EulerParametersTurnTheirBody) {
  expect_proved(judged_beside(ball,
                              "  claim Cdot: 2 * G(a) * edot(a) = w(a)\n"
                              "  claim Cdot: -2 * skew(ra) * G(a) * edot(a) = v(pa) - v(a)\n"
                              "  claim K: e(a)' * e(a) = 1\n"
                              "  claim K: G(a) * G(a)' = [1, 0, 0 ; 0, 1, 0 ; 0, 0, 1]\n"));
}

TEST(Spatial, OneMistakeInVectorsIsToldOnce) {
  const Judgement sign = judged_beside(ball, "  J = [ E, skew(ra), -E, skew(rb) ]\n");
  ASSERT_EQ(sign.differences.size(), 1u);
  EXPECT_EQ(sign.differences[0].sentence, "J, rows 1-3, w_a: the sign is wrong");
  EXPECT_EQ(sign.differences[0].hand, "[0, -ra.z, ra.y ; ra.z, 0, -ra.x ; -ra.y, ra.x, 0]");
  ASSERT_EQ(sign.remarks.size(), 1u);
  EXPECT_EQ(sign.remarks[0],
            "rows 1, 2, 3 of this J break conservation of angular momentum: a common rotation of "
            "all bodies gives "
            "J v != 0");
  const Judgement body = judged_beside(ball, "  J = [ E, -skew(rb), -E, skew(rb) ]\n");
  ASSERT_EQ(body.differences.size(), 1u);
  EXPECT_EQ(body.differences[0].sentence, "J, rows 1-3, w_a: rb stands where ra belongs");
}

TEST(Spatial, TheTermOfATurningDirectionIsNamed) {
  const char* const plane =
      "joint plane spatial\n  point pa on a\n  point pb on b = pa\n  unit n on a\n  let d = pb - "
      "pa\n"
      "  normal: dot(n, d) = 0\n";
  const Judgement j = judged_beside(plane, "  J = [ -n', -cross(ra, n)', n', cross(rb, n)' ]\n");
  ASSERT_EQ(j.differences.size(), 1u);
  EXPECT_EQ(j.differences[0].kind, "missing term");
  EXPECT_EQ(j.differences[0].sentence,
            "J, row 1, w_a: the hand derivation lacks -cross(d, n): n turns with a (dn/dt = w_a x "
            "n), so the product "
            "rule has a term for it; equal where d = 0");
  ASSERT_EQ(j.remarks.size(), 1u);
  EXPECT_NE(j.remarks[0].find("angular momentum"), std::string::npos);
}

TEST(Spatial, UpdatesUseTensors) {
  const char* const right =
      "  update v(a) += 1/m(a) * lambda\n  update w(a) -= I(a)^-1 * skew(ra)' * lambda * (-1)\n"
      "  update v(b) -= 1/m(b) * lambda\n  update w(b) += I(b)^-1 * skew(rb) * lambda * (-1)\n";
  const Judgement j = judged_beside(ball, right);
  EXPECT_EQ(j.agreement, Agreement::differs);
  ASSERT_EQ(j.differences.size(), 1u);
  EXPECT_EQ(j.differences[0].column, "w_a");
  EXPECT_EQ(j.differences[0].kind, "sign");
  EXPECT_NE(j.differences[0].confirmed.find("work along motions that C allows"), std::string::npos);
}

}  // namespace
}  // namespace cdot::test
