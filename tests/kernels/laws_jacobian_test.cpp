// Compares J, gamma, dC/dt, the stiffness and the laws of effects with differences of the function that they
// differentiate.
#include <algorithm>
#include <set>
#include <string>

#include "tests/kernels/law.hpp"

using namespace cdot;

namespace {

// True for columns of a variant's immovable body, which its J lacks.
bool held(const AnyBlock& block, std::size_t column) {
  return static_cast<int>(column / block.width()) == block.immovable;
}

// The inputs along a motion with velocity v: q(s) = q + s v to first order, t + s.
Inputs after(const AnyBlock& block, Inputs in, double s) {
  for (std::size_t c = 0; c < in.v.size(); ++c) move(block, in, c, s * in.v[c]);
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
  return dense_jacobian(block, in) * vector(in.v) + vector(evaluate_one(block, in).of[time_derivative]);
}

// d f / dq, column by column; 0 for the immovable body.
Eigen::MatrixXd gradient(const AnyBlock& block, const Inputs& in,
                         Eigen::MatrixXd (*f)(const AnyBlock&, const Inputs&)) {
  Eigen::MatrixXd G = Eigen::MatrixXd::Zero(f(block, in).rows(), static_cast<Eigen::Index>(block.columns()));
  for (std::size_t c = 0; c < block.columns(); ++c) {
    if (held(block, c)) continue;
    G.col(static_cast<Eigen::Index>(c)) = derivative_at_zero([&](double s) {
      Inputs moved = in;
      move(block, moved, c, s);
      return f(block, moved);
    });
  }
  return G;
}

// H - H^T: 0 in the plane. In space small rotations do not commute: second derivatives along rotations about axes i and
// j differ by the first derivative along i x j. Each body's block of rotations therefore contains -skew(torque) with
// the torque of J^T lambda.
Eigen::MatrixXd turning_part(const AnyBlock& block, const Inputs& in) {
  const auto columns = static_cast<Eigen::Index>(block.columns());
  Eigen::MatrixXd part = Eigen::MatrixXd::Zero(columns, columns);
  if (block.planar()) return part;
  const Eigen::MatrixXd force = force_at(block, in);
  for (Eigen::Index first = 3; first < columns; first += 6) {
    const Eigen::Vector3d torque = force.col(0).segment<3>(first);
    for (Eigen::Index i = 0; i < 3; ++i) {
      part.block<3, 3>(first, first).col(i) = Eigen::Vector3d::Unit(i).cross(torque);
    }
  }
  return part;
}

bool has_velocity_row(const AnyBlock& block) {
  return std::count(block.row_kinds.begin(), block.row_kinds.end(), RowKind::velocity) > 0;
}

}  // namespace

TEST(Laws, jacobian_is_the_difference_of_position) {
  for_all([](const AnyBlock& block, const Inputs& in) {
    if (has_velocity_row(block)) return;
    expect_near(block, "J = dC/dq", dense_jacobian(block, in), gradient(block, in, position_at), 1e-8);
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
    EXPECT_EQ(block.explicit_time, !C_t.isZero(0)) << block.joint << ", " << block.block << ": explicit_time";
    explicit_blocks += block.explicit_time;
  });
  EXPECT_GT(explicit_blocks, 0) << "no joint of the catalogue depends on time";
}

TEST(Laws, rate_is_the_difference_of_position_along_the_motion) {
  for_all([](const AnyBlock& block, const Inputs& in) {
    if (has_velocity_row(block)) return;
    const auto along = [&](double s) { return position_at(block, after(block, in, s)); };
    expect_near(block, "J v + dC/dt = Cdot", rate_at(block, in), derivative_at_zero(along), 1e-8);
  });
}

TEST(Laws, gamma_is_minus_the_difference_of_the_rate_at_constant_velocity) {
  for_all([](const AnyBlock& block, const Inputs& in) {
    const auto along = [&](double s) { return rate_at(block, after(block, in, s)); };
    const Eigen::MatrixXd g = vector(evaluate_one(block, in).of[Function::gamma]);
    expect_near(block, "gamma = -Jdot v - d/dt(dC/dt)", g, -derivative_at_zero(along), 1e-7);
  });
}

TEST(Laws, stiffness_is_the_difference_of_the_force) {
  for_all([](const AnyBlock& block, const Inputs& in) {
    if (block.immovable >= 0) return;  // inherited from the general block
    const Eigen::MatrixXd H = matrix(evaluate_one(block, in), stiffness, static_cast<Eigen::Index>(block.columns()));
    expect_near(block, "H = d(J^T lambda)/dq", H, gradient(block, in, force_at), 1e-7);
    if (!has_velocity_row(block)) {
      expect_near(block, "H - H^T", H - H.transpose(), turning_part(block, in), 1e-11);
    }
  });
}

// Along a motion with Cdot the energy grows by -(F - U) . Cdot, with U the unstored part of the force.
TEST(Laws, force_is_the_slope_of_the_energy) {
  std::set<std::string> with_energy;
  for_all([&](const AnyBlock& block, const Inputs& in) {
    const Outputs out = evaluate_one(block, in);
    if (out.of[law_energy].empty()) return;
    with_energy.insert(block.joint);
    Eigen::VectorXd stored = vector(out.of[law_force]);
    if (!out.of[law_unstored].empty()) stored -= vector(out.of[law_unstored]);
    const Eigen::MatrixXd slope = derivative_at_zero(
        [&](double s) -> Eigen::MatrixXd { return vector(evaluate_one(block, after(block, in, s)).of[law_energy]); });
    expect_near(block, "dE/dt = -F . Cdot", slope, -stored.transpose() * rate_at(block, in), 1e-8);
  });
  if (has_effects()) {
    EXPECT_GE(with_energy.size(), 3u) << "springs and gravity have energies";
  }
}

// Along a motion with Cdot, and rates that change by lambda, the force changes by -k Cdot - d lambda.
TEST(Laws, slopes_are_the_differences_of_the_force) {
  std::set<std::string> effects;
  for_all([&](const AnyBlock& block, const Inputs& in) {
    if (!block.is_effect) return;
    effects.insert(block.joint);
    const Eigen::MatrixXd slopes = matrix(evaluate_one(block, in), law_slopes, block.rows);
    const Eigen::MatrixXd k = slopes.topRows(block.rows), d = slopes.bottomRows(block.rows);
    const Eigen::MatrixXd change = derivative_at_zero([&](double s) -> Eigen::MatrixXd {
      Inputs later = after(block, in, s);
      later.time = in.time;
      for (std::size_t i = 0; i < later.rhs.size(); ++i) later.rhs[i] += s * in.lambda[i];
      return vector(evaluate_one(block, later).of[law_force]);
    });
    const Eigen::MatrixXd moves = dense_jacobian(block, in) * vector(in.v);
    expect_near(block, "dF = -k dC - d dCdot", change, -k * moves - d * vector(in.lambda), 1e-7);
  });
  if (has_effects()) {
    EXPECT_GE(effects.size(), 6u) << "the effects of the catalogue";
  }
}
