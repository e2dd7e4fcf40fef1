// Compares K, its factors, the impulse and variants with results from the dense J.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <random>

#include "tests/kernels/law.hpp"

using namespace cdot;

namespace {

constexpr double mass_round_off = 1e-12;

bool all_finite(const std::vector<double>& numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); });
}

// Dense J, M^-1 and K = J M^-1 J^T.
struct Expected {
  Eigen::MatrixXd J, inverse_mass, K;
};

Expected expected(const AnyBlock& block, const Inputs& in) {
  Expected e;
  e.J = dense_jacobian(block, in);
  e.inverse_mass = inverse_masses(block, in);
  e.K = e.J * e.inverse_mass * e.J.transpose();
  return e;
}

}  // namespace

TEST(Laws, effective_mass_is_J_inverse_M_J_transposed) {
  for_all([](const AnyBlock& block, const Inputs& in) {
    const Eigen::MatrixXd K = symmetric(evaluate_one(block, in).of[effective_mass], block.rows);
    const Eigen::MatrixXd long_way = expected(block, in).K;
    expect_near(block, "K = J M^-1 J^T", K, long_way, mass_round_off * (1 + long_way.norm()));
    const double least = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K).eigenvalues().minCoeff();
    EXPECT_GE(least, -mass_round_off * K.norm())
        << block.space() << ' ' << block.joint << ", " << block.block << ": K is not semidefinite";
  });
}

TEST(Laws, solve_inverts_the_effective_mass) {
  for_all([](const AnyBlock& block, const Inputs& in) {
    if (block.is_effect) return;  // its rows may depend on each other
    const Outputs out = evaluate_one(block, in);
    const Eigen::MatrixXd K = symmetric(out.of[effective_mass], block.rows);
    const Eigen::VectorXd lambda = vector(out.of[solve]);
    const double tolerance = mass_round_off * (1 + K.norm() * lambda.norm());
    expect_near(block, "K solve(rhs) = rhs", K * lambda, vector(in.rhs), tolerance);
  });
}

TEST(Laws, velocity_is_J_times_v) {
  for_all([](const AnyBlock& block, const Inputs& in) {
    const Eigen::VectorXd Jv = vector(evaluate_one(block, in).of[velocity]);
    expect_near(block, "velocity = J v", Jv, dense_jacobian(block, in) * vector(in.v), mass_round_off);
  });
}

TEST(Laws, apply_adds_inverse_M_J_transposed_lambda) {
  for_all([](const AnyBlock& block, const Inputs& in) {
    const Outputs out = evaluate_one(block, in);
    const Expected e = expected(block, in);
    const Eigen::VectorXd v = vector(in.v) + e.inverse_mass * (e.J.transpose() * vector(in.lambda));
    expect_near(block, "v + M^-1 J^T lambda", vector(out.of[apply]), v, mass_round_off);
    expect_near(block, "(M^-1 J^T)^T", matrix(out, inverse_mass_jacobian, e.J.cols()), e.J * e.inverse_mass,
                mass_round_off);
  });
}

TEST(Laws, an_impulse_solved_for_stops_the_rate) {
  for_all([](const AnyBlock& block, const Inputs& in) {
    Inputs stopping = in;
    const Eigen::VectorXd b = -vector(evaluate_one(block, in).of[velocity]);
    stopping.rhs.assign(b.begin(), b.end());
    stopping.lambda = evaluate_one(block, stopping).of[solve];
    Inputs stopped = stopping;
    stopped.v = evaluate_one(block, stopping).of[apply];
    const Eigen::VectorXd rest = vector(evaluate_one(block, stopped).of[velocity]);
    const double scale = 1 + vector(stopping.lambda).norm() * expected(block, in).K.norm();
    expect_near(block, "J v = 0 after the impulse", rest, 0 * rest, mass_round_off * scale);
  });
}

TEST(Laws, a_variant_is_the_general_block_with_a_body_at_rest_and_infinitely_heavy) {
  int variants = 0;
  for_all([&](const AnyBlock& block, const Inputs& in) {
    if (block.immovable < 0) return;
    ++variants;
    const Outputs of_variant = evaluate_one(block, in);
    Outputs general = evaluate_one(blocks<double>()[block.general], in);
    const std::size_t n = static_cast<std::size_t>(block.bodies), width = block.width(),
                      held = static_cast<std::size_t>(block.immovable);
    for (std::size_t i = 0; i < general.of[dense].size(); ++i) {
      if (i % (width * n) / width == held) general.of[dense][i] = 0;
    }
    for (int f = 0; f < number_of_functions; ++f) {
      if (f == jacobian) continue;  // has other fields
      expect_near(block, function_names[static_cast<std::size_t>(f)], vector(of_variant.of[f]), vector(general.of[f]),
                  f == solve || f == factor ? 1e-9 : mass_round_off);
    }
  });
  EXPECT_GT(variants, 0);
}

TEST(Guards, infinite_masses_give_no_impulse) {
  for (const AnyBlock& block : blocks<double>()) {
    const std::vector<double> K(static_cast<std::size_t>(block.rows * (block.rows + 1) / 2), 0.0);
    const std::vector<double> rhs(static_cast<std::size_t>(block.rows), 1.0);
    const Eigen::VectorXd lambda = vector(block.factor_and_solve(K, rhs));
    expect_near(block, "K = 0", lambda, 0 * lambda, 0);
  }
}

// K = sum of g g^T over fewer vectors g than rows: some rows are redundant. A consistent right-hand side is satisfied
// with bounded impulses.
TEST(Guards, dependent_rows_share_the_impulse) {
  std::mt19937 random(7);
  const auto number = [&] { return static_cast<double>(random()) / 4294967296.0 - 0.5; };
  int blocks_with_several_rows = 0;
  for (const AnyBlock& block : blocks<double>()) {
    if (block.rows < 2) continue;
    ++blocks_with_several_rows;
    // The generated factor skips entries of K that are 0 at every pose, so the test uses K's own pattern.
    const std::vector<double> pattern = evaluate_one(block, random_inputs(block, 1)).of[effective_mass];
    if (std::count(pattern.begin(), pattern.end(), 0.0) > 0) continue;
    for (int repeat = 0; repeat < 200; ++repeat) {
      Eigen::VectorXd g(block.rows);
      for (double& x : g) x = number();
      if (repeat % 4 == 0) g.setConstant(number());
      const Eigen::MatrixXd K = g * g.transpose();
      std::vector<double> triangle;
      for (int i = 0; i < block.rows; ++i) {
        for (int j = 0; j <= i; ++j) triangle.push_back(K(i, j));
      }
      const Eigen::VectorXd rhs = number() * g;
      const std::vector<double> lambda = block.factor_and_solve(triangle, {rhs.begin(), rhs.end()});
      ASSERT_TRUE(all_finite(lambda)) << block.space() << ' ' << block.joint << ", " << block.block;
      expect_near(block, "K solve(rhs) = rhs, K of rank 1", K * vector(lambda), rhs, 1e-9);
    }
  }
  EXPECT_GT(blocks_with_several_rows, 0);
}

TEST(Guards, every_value_is_finite_at_singular_poses) {
  for (const AnyBlock& block : blocks<double>()) {
    for (const auto& [name, in] : singular_inputs(block, 3)) {
      const Outputs out = evaluate_one(block, in);
      for (std::size_t f = 0; f < number_of_functions; ++f) {
        EXPECT_TRUE(all_finite(out.of[f])) << block.space() << ' ' << block.joint << ", " << block.block << ": "
                                           << function_names[f] << " at: " << name;
      }
    }
  }
}
