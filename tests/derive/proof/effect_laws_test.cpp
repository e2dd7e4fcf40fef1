// The laws of effects' forces accept the catalogue and reject wrong slopes, and the check tells what a force does to
// momentum and energy.
#include <functional>
#include <gtest/gtest.h>
#include <set>

#include "derive/check/check.hpp"
#include "derive/kernel/plan.hpp"
#include "derive/language/read.hpp"
#include "derive/language/specs_folder.hpp"
#include "derive/proof/prove.hpp"

namespace cdot::derive {
namespace {

ReadResult effect_in(const std::string& statements) {
  return read_joint(std::make_shared<SourceFile>("own.effect", "effect own planar\n  \"own\"\n" + statements), {});
}

Derivation derivation_of(const std::string& statements) {
  const ReadResult read = effect_in(statements);
  EXPECT_TRUE(read.joint) << render(*read.file, read.diagnostics);
  return derive(*read.joint);
}

TEST(EffectLaws, HoldForTheCatalogue) {
  const SpecsFolder folder(CDOT_SOURCE_DIR "/specs");
  std::set<std::string> opposite;
  int effects = 0;
  for (const auto& path : folder.all()) {
    const ReadResult read = folder.read(path);
    if (!read.joint->law) continue;
    ++effects;
    const Proof proof = prove_blocks(derive(*read.joint)).front().proof;
    const bool forces = !read.joint->law->inputs.empty();
    for (const LawId id : forces ? std::vector{LawId::force, LawId::slopes} : std::vector{LawId::slopes})
      EXPECT_EQ(proof.of(id).verdict, Verdict::holds) << path << ": " << name_of(id) << ": " << proof.of(id).text;
    if (forces && proof.of(LawId::opposite).verdict == Verdict::holds)
      opposite.insert(name_of_space(*read.joint) + " " + read.joint->name);
  }
  std::printf("%d effects\n", effects);
  for (const char* pair : {"planar spring", "planar torsion_spring", "planar servo", "spatial spring"})
    EXPECT_TRUE(opposite.contains(pair)) << pair;
  for (const char* alone : {"planar drag", "planar wind", "planar thruster", "spatial drag"})
    EXPECT_FALSE(opposite.contains(alone)) << alone;
}

TEST(EffectLaws, RejectAWrongAcceleration) {
  const SpecsFolder folder(CDOT_SOURCE_DIR "/specs");
  Derivation derivation = derive(*folder.read(CDOT_SOURCE_DIR "/specs/planar/spindle.effect").joint);
  EXPECT_EQ(prove_blocks(derivation).front().proof.of(LawId::slopes).verdict, Verdict::holds);
  derivation.bounded[0].acceleration = Rational(2) * derivation.bounded[0].acceleration;
  const Law law = prove_blocks(derivation).front().proof.of(LawId::slopes);
  EXPECT_EQ(law.verdict, Verdict::fails);
  EXPECT_EQ(law.text, "drive: the acceleration is not the derivative of the rate by time");
}

constexpr const char* damped_spring =
    "  point pa on a\n  point pb on b\n  scalar k [N/m] above 0\n  scalar d [N*s/m]\n"
    "  coordinate s [m] = norm(pa - pb)\n  energy k/2*s^2\n  force on s = -d*rate(s)*s/(1 [m])\n";

// Mistakes in a derived law, one at a time.
TEST(EffectLaws, RejectWrongForcesAndSlopes) {
  struct Wrong {
    LawId broken;
    const char* words;
    std::function<void(DerivedLaw&)> spoil;
  };
  const Wrong all[] = {
      {LawId::force, "s: F is not -dE/dC", [](DerivedLaw& law) { law.force[0] = law.force[0] + law.rate[0]; }},
      {LawId::force, "s: F is not -dE/dC", [](DerivedLaw& law) { law.energy = 2 * law.energy; }},
      {LawId::slopes, "s, column s: k is not the slope",
       [](DerivedLaw& law) { law.stiffness[0][0] = -law.stiffness[0][0]; }},
      {LawId::slopes, "s, column s: d is not the slope",
       [](DerivedLaw& law) { law.damping[0][0] = law.damping[0][0] + law.value[0]; }},
  };
  const Derivation right = derivation_of(damped_spring);
  for (const Law& law : prove_blocks(right).front().proof.laws) EXPECT_FALSE(is_broken(law)) << law.text;
  for (const Wrong& wrong : all) {
    Derivation derivation = derivation_of(damped_spring);
    wrong.spoil(*derivation.law);
    const Proof proof = prove_blocks(derivation).front().proof;
    EXPECT_EQ(proof.of(wrong.broken).verdict, Verdict::fails) << wrong.words;
    EXPECT_NE(proof.of(wrong.broken).text.find(wrong.words), std::string::npos) << proof.of(wrong.broken).text;
  }
}

// Of a force with two components, the slope of one by the other.
TEST(EffectLaws, RejectWrongSlopesBesideTheDiagonal) {
  const std::string drag =
      "  point pa on a\n  scalar c [kg/m]\n  scalar k [N/m^2]\n"
      "  force on pa = -c*norm(v(pa))*v(pa) - k*norm(pa - x(b))*(pa - x(b))\n";
  ASSERT_EQ(prove_blocks(derivation_of(drag)).front().proof.of(LawId::slopes).verdict, Verdict::holds);
  for (const bool damping : {false, true}) {
    Derivation derivation = derivation_of(drag);
    Expr& slope = (damping ? derivation.law->damping : derivation.law->stiffness)[0][1];
    ASSERT_FALSE(is_zero(slope));
    slope = -slope;
    EXPECT_EQ(prove_blocks(derivation).front().proof.of(LawId::slopes).verdict, Verdict::fails);
  }
}

// A bound grows in proportion to its load: the solvers find both together.
TEST(EffectLaws, RejectBoundsThatAreNoMultipleOfTheirLoad) {
  const auto slopes_of = [](const std::string& most) {
    return prove_blocks(derivation_of("  point pa on a\n  scalar mu\n  coordinate gap [m] = dot(a.x, pa - x(b))\n"
                                      "  coordinate slip [m] = dot(a.y, pa - x(b))\n  contact: gap >= 0\n"
                                      "  grip: rate(slip) = 0, force in [-" +
                                      most + ", " + most + "]\n"))
        .front()
        .proof.of(LawId::slopes);
  };
  EXPECT_EQ(slopes_of("mu*load(contact)").verdict, Verdict::holds);
  const Law law = slopes_of("mu*load(contact)^2/(1 [N])");
  EXPECT_EQ(law.verdict, Verdict::fails);
  EXPECT_EQ(law.text, "grip: a bound is not a multiple of the load and a part without it");
}

// The quantities that a law reads have leaves of their own, whatever parameters and coordinates are called.
TEST(EffectLaws, ReadNoParameterInPlaceOfARate) {
  const auto symbols = [](const std::string& statements) {
    const Derivation derivation = derivation_of(statements);
    std::set<std::pair<std::string, Role>> found;
    for (const Expr leaf : leaves_of(derivation.law->force)) found.emplace(leaf->symbol, leaf->role);
    return found;
  };
  const auto of_rate = symbols(
      "  point pa on a\n  scalar d [N*s/m]\n  scalar s_rate [m/s]\n  coordinate s [m] = dot(world.x, pa - x(b))\n"
      "  force on s = -d*(rate(s) - s_rate)\n");
  EXPECT_TRUE(of_rate.contains({"s_rate", Role::parameter}));
  EXPECT_TRUE(of_rate.contains({"s_rate_", Role::given}));
  const auto of_direction = symbols(
      "  point pa on a\n  unit n on a\n  unit n_world on world\n  scalar F [N]\n  force on pa = F*(n - n_world)\n");
  EXPECT_TRUE(of_direction.contains({"n_world", Role::world_vector}));
  EXPECT_TRUE(of_direction.contains({"n_world__x", Role::given}));
  // A coordinate with the name that the centre of a body would have.
  const Derivation own_centre = derivation_of(
      "  coordinate centre_a [m] = dot(world.x, x(a) - x(b))\n  scalar k [N/m]\n"
      "  force on centre_a = -k*dot(world.x, x(a) - x(b))\n");
  EXPECT_EQ(own_centre.rows.rows.size(), 1u + 2 + 2);
}

constexpr const char* two_points = "  point pa on a\n  point pb on b\n  unit n on a\n  scalar F [N]\n";

TEST(EffectLaws, ForcesThatAreNotOppositeAreTold) {
  const auto text_of = [](const std::string& statements) {
    return prove_blocks(derivation_of(two_points + statements)).front().proof.of(LawId::opposite).text;
  };
  EXPECT_EQ(text_of("  force on pa = F*unit(pa - pb)\n  force on pb = F*unit(pb - pa)\n"), "");
  EXPECT_EQ(text_of("  force on pa = F*unit(pa - pb)\n  force on pb = F*unit(pa - pb)\n"),
            "momentum is not conserved: the forces do not add up to 0");
  EXPECT_EQ(text_of("  force on pa = F*n\n  force on pb = -F*n\n"),
            "angular momentum is not conserved: the forces are opposite, but not on one line");
  EXPECT_EQ(text_of("  torque on a = F*(1 [m])*dot(n, unit(pa - pb))\n  torque on b = 0\n"),
            "angular momentum is not conserved: the torques do not add up to 0");
  // The same with the torque that the lever leaves.
  EXPECT_EQ(text_of("  force on pa = F*n\n  force on pb = -F*n\n  torque on b = cross(pb - pa, F*n)\n"), "");
}

// The first note of a check about power.
std::string power_by(const std::string& statement) {
  const ReadResult read =
      effect_in("  scalar d [N*m*s/rad]\n  coordinate q [rad] = angle(a) - angle(b)\n  " + statement + "\n");
  const CheckReport report = check(read);
  EXPECT_TRUE(report.clean());
  for (const Finding& finding : report.findings)
    if (finding.kind == "power") return finding.message;
  return "";
}

std::string power_of(const std::string& force) { return power_by("force on q = " + force); }

TEST(EffectLaws, DampersTakeEnergyAndMotorsPutItIn) {
  EXPECT_NE(power_of("-d*rate(q)").find("only takes energy"), std::string::npos) << power_of("-d*rate(q)");
  EXPECT_NE(power_of("-d*rate(q)*abs(rate(q))/(1 [rad/s])").find("only takes energy"), std::string::npos);
  EXPECT_NE(power_of("d*rate(q)").find("can put energy in"), std::string::npos) << power_of("d*rate(q)");
  EXPECT_NE(power_of("d*(3 [rad/s] - rate(q))").find("rate"), std::string::npos);
  EXPECT_NE(power_of("-d*abs(rate(q))").find("can put energy in"), std::string::npos) << "at negative rates alone";
  const std::string within = ", force in [-d*(1 [rad/s]), d*(1 [rad/s])]";
  EXPECT_NE(power_by("rate(q) = 2 [rad/s]" + within).find("can put energy in"), std::string::npos);
  EXPECT_NE(power_by("rate(q) = 0" + within).find("only takes energy"), std::string::npos);
  EXPECT_EQ(check(effect_in(damped_spring)).findings.size(), 1u);
}

// An implicit step takes a law as linear only if its slopes cannot feed energy in.
TEST(EffectLaws, SlopesThatMayBeNegativeAreNotLinear) {
  const auto is_linear = [](const std::string& damping) {
    const Derivation derivation = derivation_of(
        "  scalar d [N*m*s/rad] above 0\n  scalar e [N*m*s/rad] above 0\n"
        "  coordinate q [rad] = angle(a) - angle(b)\n  force on q = -(" +
        damping + ")*rate(q)\n");
    return slopes_of(derivation.joint, *derivation.law).linear;
  };
  EXPECT_TRUE(is_linear("d + e"));
  EXPECT_FALSE(is_linear("d - e"));
}

// The powers of the rows cancel but for round-off, which is neither of both.
TEST(EffectLaws, AForceAcrossTheVelocityHasNoPower) {
  const auto power_of_force = [](const std::string& force) {
    const ReadResult read = effect_in("  point pa on a\n  scalar c [kg/m]\n  force on pa = " + force + "\n");
    for (const Finding& finding : check(read).findings)
      if (finding.kind == "power") return finding.message;
    return std::string();
  };
  EXPECT_NE(power_of_force("c*norm(v(pa))*perp(v(pa))").find("has no power"), std::string::npos);
  EXPECT_NE(power_of_force("c*norm(v(pa))*(perp(v(pa)) + 1e-6*v(pa))").find("can put energy in"), std::string::npos);
  EXPECT_NE(power_of_force("c*norm(v(pa))*(perp(v(pa)) - 1e-6*v(pa))").find("only takes energy"), std::string::npos);
}

}  // namespace
}  // namespace cdot::derive
