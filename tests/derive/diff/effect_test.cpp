// `cdot diff` on the laws of effects: energies, forces, slopes and wrenches, with the mistakes that people make in
// them.
#include <algorithm>
#include <fstream>
#include <gtest/gtest.h>
#include <regex>

#include "tests/derive/diff/support.hpp"

namespace cdot::test {
namespace {

using derive::Agreement;
using derive::Judgement;

struct LawMistake {
  const char *effect, *items, *kind, *words;
};

void expect_found(const LawMistake& m) {
  const Judgement j = judged(m.effect, m.items);
  ASSERT_EQ(j.agreement, Agreement::differs) << m.items;
  ASSERT_EQ(j.differences.size(), 1u) << m.items;
  EXPECT_EQ(j.differences[0].kind, m.kind) << m.items;
  EXPECT_NE(j.differences[0].sentence.find(m.words), std::string::npos) << j.differences[0].sentence;
  const std::regex measured(".* at \\d+ poses: generated off by ([-+.e0-9]+), published by ([-+.e0-9]+)");
  std::smatch numbers;
  ASSERT_TRUE(std::regex_match(j.differences[0].confirmed, numbers, measured)) << j.differences[0].confirmed;
  EXPECT_LT(std::stod(numbers[1]), 1e-8) << j.differences[0].confirmed;
  EXPECT_GT(std::stod(numbers[2]), 1e-3) << j.differences[0].confirmed;
}

TEST(EffectDiff, MistakesAreNamed) {
  for (const LawMistake& m : {
           LawMistake{"spring", "  energy = k*(length - rest)^2\n", "factor",
                      "energy: it is 2 times what it should be"},
           {"spring", "  energy = k/2*(length + rest)^2\n", "sign", "energy"},
           {"spring", "  force = k*(length - rest) + d*rate(length)\n", "sign", "force, row length: the sign is wrong"},
           {"spring", "  force = -k*(length - rest)\n", "missing term", "force, row length"},
           {"spring", "  stiffness = -k\n", "sign", "stiffness, row length, length: the sign is wrong"},
           {"spring", "  damping = 2*d\n", "factor", "damping, row length, length: it is 2 times"},
           {"bushing", "  stiffness = [ kx, 0, 0; 0, kx, 0; 0, 0, k_turn ]\n", "factor",
            "stiffness, row across, across: it has kx where ky belongs"},
           {"dc_motor", "  force = stall*(1 + rate(turn)/idle)\n", "wrong body", "w_a and w_b are exchanged"},
           {"torsion_spring",
            "  wrench = [ 0; 0; -k*(angle_between - rest) - d*rate(angle_between); 0; 0; -k*(angle_between - rest) - "
            "d*rate(angle_between) ]\n",
            "sign", "wrench, row torque on b"},
           {"spatial/drag", "  force = -c*norm(v(pa))*v(a)\n", "missing term", "force"},
       })
    expect_found(m);
}

TEST(EffectDiff, RightFormulasAgree) {
  for (const auto& [effect, items] : {
           std::pair{"spring", "  energy = k/2*(norm(pa - pb) - rest)^2\n"},
           {"spring", "  force = k*(rest - length) - d*dot(unit(pa - pb), v(pa) - v(pb))\n"},
           {"spatial/spring",
            "  let f = -(k*(norm(pa - pb) - rest) + d*dot(v(pa) - v(pb), unit(pa - pb)))*unit(pa - pb)\n"
            "  wrench = [ f; cross(ra, f); -f; -cross(rb, f) ]\n"},
           {"spatial/thruster", "  wrench = [ F*n; cross(ra, F*n) ]\n"},
           {"servo", "  let e = k*(turn - target)\n  force = -e*most/sqrt(most^2 + e^2) - d*rate(turn)\n"},
           {"position_drive", "  stiffness = k\n  damping = d\n"},
       })
    EXPECT_EQ(judged(effect, items).agreement, Agreement::agrees) << effect << items;
}

TEST(EffectDiff, AConstantOfTheEnergyIsFree) {
  const Judgement j = judged("spring", "  free E0\n  energy = k/2*(length - rest)^2 + E0\n");
  EXPECT_EQ(j.agreement, Agreement::agrees);
  ASSERT_EQ(j.remarks.size(), 1u);
  EXPECT_EQ(j.remarks[0], "its energy is 0 elsewhere: a constant more or less changes no force");
}

TEST(EffectDiff, AnEnergyOfForcesThatHaveNoneDiffers) {
  const Judgement j = judged("drag", "  energy = c*norm(v(pa))^3/3\n");
  ASSERT_EQ(j.agreement, Agreement::differs);
  EXPECT_NE(j.differences[0].sentence.find("the forces of this effect have no energy"), std::string::npos);
}

TEST(EffectDiff, SizesThatDoNotFitAreTold) {
  const Judgement j = judged("spring", "  wrench = [ 1; 0; 0 ]\n");
  ASSERT_EQ(j.agreement, Agreement::differs);
  EXPECT_NE(j.differences[0].sentence.find("3 x 1 numbers stand where 6 x 1 belong"), std::string::npos)
      << j.differences[0].sentence;
}

// A joint has no force of its own.
TEST(EffectDiff, QuantitiesOfLawsAreForEffects) {
  const std::filesystem::path hand = write_hand("line", "  force = 1\n");
  const derive::SpecsFolder folder(specs_folder());
  const derive::DiffReport report = judge(hand, folder.read(specs_folder() / "planar/line.joint"));
  EXPECT_NE(render(*report.file, report.diagnostics).find("`force` is a quantity of an effect with a law of forces"),
            std::string::npos);
}

}  // namespace
}  // namespace cdot::test
