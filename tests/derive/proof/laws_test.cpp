// Each law fails for a derivation that breaks it, and J equals finite differences of C for every spec of the catalogue.
// catalogue_test.cpp tests the laws for the catalogue.
#include <cmath>
#include <cstdio>
#include <functional>
#include <gtest/gtest.h>

#include "derive/language/specs_folder.hpp"
#include "derive/numbers/numeric.hpp"
#include "derive/proof/prove.hpp"

namespace cdot::derive {
namespace {

const std::filesystem::path specs_folder = std::filesystem::path(CDOT_SOURCE_DIR) / "specs";

Joint joint_of(const std::string& name) {
  const SpecsFolder folder(specs_folder);
  const ReadResult read = folder.read(folder.find(name));
  EXPECT_TRUE(read.joint) << render(*read.file, read.diagnostics);
  return *read.joint;
}

struct Broken {
  const char* what;
  LawId law;
  std::function<void(Block&)> damage;
};

TEST(Laws, EachFailsForADerivationThatBreaksIt) {
  const Joint joint = joint_of("line");
  const Broken table[] = {
      {"J with a flipped sign", LawId::jacobian, [](Block& b) { b.rows[0].J[0].w = -b.rows[0].J[0].w; }},
      {"J without the turning axis", LawId::raw,
       [&](Block& b) {
         const Expr rb = joint.pool->find("rb"), t = joint.pool->find("t");
         b.rows[0].J[1].w = -cross(rb, t);
       }},
      {"Cdot with a factor", LawId::rate, [](Block& b) { b.rows[0].Cdot = Rational(2) * b.rows[0].Cdot; }},
      {"K with a body left out", LawId::mass, [&](Block& b) { b.K[0][0] = b.K[0][0] - body_symbols(joint, 1).inv_m; }},
      {"gamma of the wrong sign", LawId::gamma, [](Block& b) { b.rows[0].gamma = -b.rows[0].gamma; }},
      {"a stiffness entry dropped", LawId::stiffness, [&](Block& b) { b.stiffness[2][2] = joint.pool->number(0); }},
  };
  for (const Broken& broken : table) {
    Block block = derive_rows(joint);
    broken.damage(block);
    const Proof proof = prove(joint, block);
    const Law& law = proof.of(broken.law);
    std::printf("%s: %s: %s\n", broken.what, std::string(name_of(law.id)).c_str(), law.text.c_str());
    EXPECT_EQ(law.verdict, Verdict::fails) << broken.what;
    EXPECT_FALSE(law.text.empty());
    EXPECT_FALSE(proof.holds());
  }
}

struct BrokenEmission {
  const char* what;
  const char* joint;
  LawId law;
  std::function<void(Derivation&)> damage;
};

// Variants, coordinates and K of isotropic bodies each have their own proof.
TEST(Laws, EachFailsForADerivationThatWouldEmitSomethingElse) {
  const BrokenEmission table[] = {
      {"a variant with a flipped sign in J", "line", LawId::immovable,
       [](Derivation& d) { d.rows.variants[0].rows[0].J[1].w = -d.rows.variants[0].rows[0].J[1].w; }},
      {"a variant that lets the immovable body move", "line", LawId::immovable,
       [](Derivation& d) { d.rows.variants[0].rows[0].J[0] = d.rows.rows[0].J[0]; }},
      {"a variant with the K of the block", "line", LawId::immovable,
       [](Derivation& d) { d.rows.variants[1].K = d.rows.K; }},
      {"a variant of another C", "line", LawId::immovable,
       [](Derivation& d) { d.rows.variants[0].rows[0].C = -d.rows.variants[0].rows[0].C; }},
      {"variants in each other's place", "line", LawId::immovable,
       [](Derivation& d) { std::swap(d.rows.variants[0].immovable, d.rows.variants[1].immovable); }},
      {"K doubled beside its diagonal", "weld", LawId::mass,
       [](Derivation& d) { d.rows.K[1][0] = Rational(2) * d.rows.K[1][0]; }},
      {"a stiffness of the second body with a wrong sign", "line", LawId::stiffness,
       [](Derivation& d) { d.rows.stiffness[5][5] = -d.rows.stiffness[5][5]; }},
      {"a coordinate's J of the wrong sign", "line", LawId::raw,
       [](Derivation& d) { d.coordinates[0].rows[0].J[0].v = -d.coordinates[0].rows[0].J[0].v; }},
      {"a coordinate's gamma doubled", "line", LawId::gamma,
       [](Derivation& d) { d.coordinates[0].rows[0].gamma = Rational(2) * d.coordinates[0].rows[0].gamma; }},
      {"a coordinate's variant without its mass", "line", LawId::immovable,
       [](Derivation& d) { d.coordinates[0].variants[0].K[0][0] = d.joint.pool->number(0); }},
      {"K of isotropic bodies without an inertia", "spherical", LawId::isotropic,
       [](Derivation& d) {
         d.rows.K_isotropic[0][0] = substitute(
             d.rows.K_isotropic[0][0], {{&*body_symbols(d.joint, 0).inv_I, d.joint.pool->number(0)}}, KeepNames::no);
       }},
      {"K of isotropic bodies of a variant doubled", "spherical", LawId::isotropic,
       [](Derivation& d) {
         Expr& K = d.rows.variants[1].K_isotropic[1][1];
         K = Rational(2) * K;
       }},
  };
  for (const BrokenEmission& broken : table) {
    Derivation derivation = derive(joint_of(broken.joint));
    broken.damage(derivation);
    bool found = false;
    for (const Proved& proved : prove(derivation)) {
      const Law& law = proved.proof.of(broken.law);
      found = found || (law.verdict == Verdict::fails && !law.text.empty() && !proved.proof.holds());
      if (law.verdict == Verdict::fails) std::printf("%s: %s\n", broken.what, law.text.c_str());
    }
    EXPECT_TRUE(found) << broken.what;
  }
}

TEST(Laws, AllHoldOfWhatIsEmitted) {
  for (const char* name : {"line", "wheel", "spherical"}) {
    const Derivation derivation = derive(joint_of(name));
    const std::vector<Proved> proofs = prove(derivation);
    EXPECT_EQ(proofs.size(), 1 + derivation.coordinates.size());
    EXPECT_EQ(derivation.rows.variants.size(), 2u);
    for (const Proved& proved : proofs) {
      EXPECT_TRUE(proved.proof.holds()) << name;
      EXPECT_EQ(proved.proof.of(LawId::immovable).verdict, Verdict::holds) << name;
      const bool spatial = derivation.joint.dimension == 3;
      EXPECT_EQ(proved.proof.of(LawId::isotropic).verdict, spatial ? Verdict::holds : Verdict::does_not_apply) << name;
    }
  }
}

// all: C, then the columns of J, body by body.
void expect_finite_differences(const Joint& joint, const ScalarRow& row, const std::vector<Expr>& all,
                               const Sample& sample, int dimension) {
  const std::size_t width = (all.size() - 1) / joint.bodies.size();
  const auto moved = [&](std::size_t body, std::size_t column, double step) {
    Sample there = sample;
    there.bodies[body].move(dimension, column, step);
    return Numbers(there).scalar(row.C);
  };
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    for (std::size_t k = 0; k < width; ++k) {
      const double J = Numbers(sample).scalar(all[1 + width * b + k]);
      const double step = 1e-6, slope = (moved(b, k, step) - moved(b, k, -step)) / (2 * step);
      EXPECT_NEAR(J, slope, 1e-6 * (1 + std::fabs(J)))
          << joint.name << ", row " << row.name << ", body " << joint.bodies[b] << ", column " << k;
    }
  }
}

// A third route by numbers, without algebra or rules of differentiation.
TEST(Laws, JacobianEqualsFiniteDifferences) {
  const SpecsFolder folder(specs_folder);
  for (const std::filesystem::path& spec : folder.all()) {
    const Joint joint = joint_of(spec.string());
    const int dimension = joint.pool->dimension();
    for (const ScalarRow& row : derive_rows(joint).rows) {
      if (row.kind == RowKind::velocity) continue;  // without C
      std::vector<Expr> all = {row.C};
      for (const JacobianEntry& e : row.J) {
        const std::vector<Expr> columns = columns_of(e);
        all.insert(all.end(), columns.begin(), columns.end());
      }
      for (std::uint64_t seed = 1; seed <= 5; ++seed)
        expect_finite_differences(joint, row, all, random_sample(joint, all, seed), dimension);
    }
  }
}

}  // namespace
}  // namespace cdot::derive
