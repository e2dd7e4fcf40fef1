// Where GiNaC's derivatives would be too long, slopes have values at random points alone. They must accept every right
// derivation and reject every wrong one.
#include <fmt/format.h>
#include <functional>
#include <gtest/gtest.h>

#include "derive/language/read.hpp"
#include "derive/language/specs_folder.hpp"
#include "derive/proof/prove.hpp"

namespace cdot::derive {
namespace {

constexpr std::int64_t none = 0;  // operands in derivatives of GiNaC

Joint joint_in(const std::string& text) {
  const ReadResult read = read_joint(std::make_shared<SourceFile>("own.joint", text), {});
  EXPECT_TRUE(read.joint) << render(*read.file, read.diagnostics);
  return *read.joint;
}

// Norms, quotients, angles and functions, with time.
Joint rich_joint(const std::string& space) {
  return joint_in("joint own " + space +
                  "\n  \"own\"\n  point pa on a\n  point pb on b\n  unit t on b\n  scalar l [m]\n"
                  "  let u = pa - pb\n  let q = norm(u)/l\n  let s = u + norm(u)*t\n"
                  "  long: norm(s)/l + exp(-q) + tan(q/(1 + q))/(2 + dot(unit(u), t))^3 = sin(time/1[s])\n"
                  "  flat: dot(s, t)*abs(1 + q) = l*log(2 + q)\n");
}

TEST(SlopesAtPoints, AcceptTheCatalogue) {
  const SpecsFolder folder(CDOT_SOURCE_DIR "/specs");
  int shown = 0;
  for (const auto& path : folder.all()) {
    const ReadResult read = folder.read(path);
    const Derivation derivation = derive(*read.joint);
    for (const Law& law : prove(derivation.joint, derivation.rows, none).laws) {
      EXPECT_FALSE(is_broken(law)) << path << ": " << name_of(law.id) << ": " << law.text;
      shown += law.verdict == Verdict::shown ? 1 : 0;
    }
  }
  std::printf("%d laws are shown\n", shown);
  EXPECT_GT(shown, 200);
}

// Mistakes that one derivation has at once, and the laws that each of them breaks.
struct Wrong {
  std::vector<LawId> broken;
  std::function<void(Joint&, Block&)> spoil;
};

TEST(SlopesAtPoints, RejectWrongDerivations) {
  const Rational half(1, 2);
  const Wrong all[] = {
      {{LawId::rate, LawId::mass, LawId::gamma, LawId::stiffness},
       [&](Joint& joint, Block& block) {
         block.rows[0].Cdot = half * block.rows[0].Cdot;
         block.K[1][0] = block.K[1][0] + body_symbols(joint, 0).inv_m;
         block.rows[0].gamma = half * block.rows[0].gamma;
         block.stiffness[2][2] = half * block.stiffness[2][2];
       }},
      {{LawId::jacobian, LawId::raw, LawId::gamma, LawId::stiffness},
       [&](Joint& joint, Block& block) {
         block.rows[0].J[1].v = -block.rows[0].J[1].v;
         block.rows[1].gamma_by_entries = -block.rows[1].gamma;
         block.stiffness[0][1] = block.stiffness[0][1] + joint.pool->number(1);
       }},
      {{LawId::raw, LawId::linear},
       [&](Joint&, Block& block) {
         block.rows[1].J[0].w = half * block.rows[1].J[0].w;
         block.rows[0].Cdot = pow(block.rows[0].Cdot, 2);
         block.rows[0].kind = RowKind::velocity;
       }},
  };
  for (const char* const space : {"planar", "spatial"}) {
    Joint joint = rich_joint(space);
    EXPECT_TRUE(prove(joint, derive_rows(joint), none).holds()) << space;
    for (const Wrong& wrong : all) {
      Block block = derive_rows(joint);
      wrong.spoil(joint, block);
      const Proof proof = prove(joint, block, none);
      for (const LawId id : wrong.broken) EXPECT_TRUE(is_broken(proof.of(id))) << space << ": " << name_of(id);
    }
  }
}

TEST(SlopesAtPoints, RejectJointsThatBreakMomentum) {
  const std::string points = "\n  \"own\"\n  point pa on a\n  point pb on b\n  scalar l [m]\n";
  for (const char* const row : {"pa - pb = angle(a)*arm(pa)", "(pa - pb).x = l", "norm(pa - pb) + angle(a)*l = l"}) {
    const Joint joint = joint_in("joint own planar" + points + "  " + row + "\n");
    EXPECT_EQ(prove(joint, derive_rows(joint), none).of(LawId::momentum).verdict, Verdict::fails) << row;
  }
  // It is kept where C = 0, which takes the slope of C by x.
  const Joint point = joint_in("joint own planar" + points + "  2*(pa - pb) = perp(pb - pa)\n  angle(a) = angle(b)\n");
  const Law kept = prove(point, derive_rows(point), none).of(LawId::momentum);
  EXPECT_FALSE(is_broken(kept)) << kept.text;
}

// Every name occurs four times in the next one.
TEST(SlopesAtPoints, EndNestedNames) {
  std::string text =
      "joint own planar\n  \"own\"\n  point pa on a\n  point pb on b\n  scalar l [m]\n"
      "  let u0 = dot(pa - pb, pa - pb)/l^2\n";
  for (int i = 1; i <= 7; ++i)
    text += fmt::format("  let u{0} = (u{1}*(pa - pb).x/l + 1)*(u{1} + exp(u{1}))/(2 + u{1})\n", i, i - 1);
  const Joint joint = joint_in(text + "  u7 = 1\n");
  const Proof proof = prove(joint, derive_rows(joint));
  for (const LawId id : {LawId::rate, LawId::jacobian, LawId::raw, LawId::gamma, LawId::stiffness})
    EXPECT_FALSE(is_broken(proof.of(id))) << name_of(id) << ": " << proof.of(id).text;
  EXPECT_EQ(proof.of(LawId::gamma).verdict, Verdict::shown);
  Block wrong = derive_rows(joint);
  wrong.rows[0].gamma = -wrong.rows[0].gamma;
  EXPECT_EQ(prove(joint, wrong).of(LawId::gamma).verdict, Verdict::fails);
}

}  // namespace
}  // namespace cdot::derive
