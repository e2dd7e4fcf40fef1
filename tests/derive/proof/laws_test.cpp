// Each law fails for a derivation that breaks it; and J, in plain numbers, is the slope of C for every spec of the
// catalogue. That the laws hold for all of it is in catalogue_test.cpp.
#include <cmath>
#include <cstdio>
#include <functional>
#include <gtest/gtest.h>

#include "derive/derivation/specs_folder.hpp"
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

// all: C, then the columns of J body by body.
void expect_finite_differences(const Joint& joint, const ScalarRow& row, const std::vector<Expr>& all,
                               const Sample& sample, int dimension) {
  const std::size_t width = (all.size() - 1) / joint.bodies.size();
  const auto moved = [&](std::size_t body, std::size_t column, double step) {
    Sample there = sample;
    there.bodies[body].move(dimension, column, step);
    return evaluate(row.C, world_values(joint, there));
  };
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    for (std::size_t k = 0; k < width; ++k) {
      const double J = evaluate(all[1 + width * b + k], world_values(joint, sample));
      const double step = 1e-6, slope = (moved(b, k, step) - moved(b, k, -step)) / (2 * step);
      EXPECT_NEAR(J, slope, 1e-6 * (1 + std::fabs(J)))
          << joint.name << ", row " << row.name << ", body " << joint.bodies[b] << ", column " << k;
    }
  }
}

// A third route, in plain numbers: no algebra, no rule of differentiation.
TEST(Laws, JacobianEqualsFiniteDifferences) {
  const SpecsFolder folder(specs_folder);
  for (const std::filesystem::path& spec : folder.all()) {
    const Joint joint = joint_of(spec.string());
    const int dimension = joint.pool->dimension();
    for (const ScalarRow& row : derive_rows(joint).rows) {
      if (row.kind == RowKind::velocity) continue;  // has no C
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
