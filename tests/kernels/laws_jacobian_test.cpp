// C, J and what derives from both by one more derivative: each against differences of the function
// before it.
#include <algorithm>

#include "tests/kernels/law.hpp"

using namespace cdot;

namespace {

// Columns of the body that a variant holds still are absent from its J.
bool held(const AnyBlock& block, std::size_t column) {
  return static_cast<int>(column / 3) == block.immovable;
}

// Along the motion with constant v: q(s) = q + s v, t + s.
Inputs after(Inputs in, double s) {
  for (std::size_t c = 0; c < in.v.size(); ++c) move(in, c, s * in.v[c]);
  in.time[0] += s;
  return in;
}

Eigen::MatrixXd position_at(const AnyBlock& block, const Inputs& in) {
  return vector(evaluate_one(block, in).of[position]);
}

// J^T lambda
Eigen::MatrixXd force_at(const AnyBlock& block, const Inputs& in) {
  return dense_jacobian(block, in).transpose() * vector(in.lambda);
}

// Cdot = J v + dC/dt
Eigen::MatrixXd rate_at(const AnyBlock& block, const Inputs& in) {
  return dense_jacobian(block, in) * vector(in.v) +
         vector(evaluate_one(block, in).of[time_derivative]);
}

// d f / dq, column by column; zero for the held body.
Eigen::MatrixXd gradient(const AnyBlock& block, const Inputs& in,
                         Eigen::MatrixXd (*f)(const AnyBlock&, const Inputs&)) {
  Eigen::MatrixXd G = Eigen::MatrixXd::Zero(f(block, in).rows(), 3 * block.bodies);
  for (std::size_t c = 0; c < block.columns(); ++c) {
    if (held(block, c)) continue;
    G.col(static_cast<Eigen::Index>(c)) = derivative_at_zero([&](double s) {
      Inputs moved = in;
      move(moved, c, s);
      return f(block, moved);
    });
  }
  return G;
}

bool has_velocity_row(const AnyBlock& block) {
  return std::count(block.row_kinds.begin(), block.row_kinds.end(), RowKind::velocity) > 0;
}

}  // namespace

TEST(Laws, jacobian_is_the_difference_of_position) {
  for_all([](const AnyBlock& block, const Inputs& in) {
    if (has_velocity_row(block)) return;
    expect_near(block, "J = dC/dq", dense_jacobian(block, in), gradient(block, in, position_at),
                1e-8);
  });
}

TEST(Laws, position_is_the_same_with_and_without_jacobian) {
  for_all([](const AnyBlock& block, const Inputs& in) {
    const Outputs out = evaluate_one(block, in);
    const Eigen::VectorXd C = vector(out.of[position]);
    expect_near(block, "C beside J", vector(out.of[jacobian]).head(C.size()), C, 1e-13);
  });
}

TEST(Laws, time_derivative_is_the_difference_in_time) {
  int explicit_blocks = 0;
  for_all([&](const AnyBlock& block, const Inputs& in) {
    const Eigen::VectorXd C_t = vector(evaluate_one(block, in).of[time_derivative]);
    const Eigen::MatrixXd difference = derivative_at_zero([&](double s) {
      Inputs later = in;
      later.time[0] += s;
      return position_at(block, later);
    });
    expect_near(block, "dC/dt at fixed q", C_t, difference, 1e-8);
    EXPECT_EQ(block.explicit_time, !C_t.isZero(0))
        << block.joint << ", " << block.block << ": explicit_time";
    explicit_blocks += block.explicit_time;
  });
  EXPECT_GT(explicit_blocks, 0) << "no joint of the catalogue depends on time";
}

TEST(Laws, rate_is_the_difference_of_position_along_the_motion) {
  for_all([](const AnyBlock& block, const Inputs& in) {
    if (has_velocity_row(block)) return;
    const auto along = [&](double s) { return position_at(block, after(in, s)); };
    expect_near(block, "J v + dC/dt = Cdot", rate_at(block, in), derivative_at_zero(along), 1e-8);
  });
}

TEST(Laws, gamma_is_minus_the_difference_of_the_rate_at_constant_velocity) {
  for_all([](const AnyBlock& block, const Inputs& in) {
    const auto along = [&](double s) { return rate_at(block, after(in, s)); };
    const Eigen::MatrixXd g = vector(evaluate_one(block, in).of[Function::gamma]);
    expect_near(block, "gamma = -Jdot v - d/dt(dC/dt)", g, -derivative_at_zero(along), 1e-7);
  });
}

TEST(Laws, stiffness_is_the_difference_of_the_force) {
  for_all([](const AnyBlock& block, const Inputs& in) {
    const Eigen::MatrixXd H = matrix(evaluate_one(block, in), stiffness, 3 * block.bodies);
    expect_near(block, "H = d(J^T lambda)/dq", H, gradient(block, in, force_at), 1e-7);
    if (!has_velocity_row(block)) expect_near(block, "H is symmetric", H, H.transpose(), 1e-12);
  });
}
