// In space: J by the other forms of velocity, and isotropic bodies.
#include <cmath>

#include "tests/kernels/law.hpp"

using namespace cdot;

namespace {

constexpr double round_off = 1e-12;

void for_all_in_space(const std::function<void(const AnyBlock&, const Inputs&)>& law) {
  for_all([&](const AnyBlock& block, const Inputs& in) {
    if (!block.planar()) law(block, in);
  });
}

// J of the block with every body movable, the source of a variant's forms.
Eigen::MatrixXd general_jacobian(const AnyBlock& block, const Inputs& in) {
  return dense_jacobian(blocks<double>()[block.general], in);
}

const double* pose_of(const Inputs& in, Eigen::Index body) { return &in.q[16 * static_cast<std::size_t>(body)]; }

// A(e) from the pose.
Eigen::Matrix3d rotation(const double* pose) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(pose + 7);
}

// e0 e1 e2 e3
Eigen::Vector4d parameters(const double* pose) { return Eigen::Map<const Eigen::Vector4d>(pose + 3); }

// G with w = 2 G edot: rows by the components of w in world axes.
Eigen::Matrix<double, 3, 4> rates(const Eigen::Vector4d& e) {
  Eigen::Matrix<double, 3, 4> G;
  G << -e[1], e[0], -e[3], e[2], -e[2], e[3], e[0], -e[1], -e[3], -e[2], e[1], e[0];
  return G;
}

}  // namespace

TEST(Forms, local_is_J_times_A) {
  for_all_in_space([](const AnyBlock& block, const Inputs& in) {
    Eigen::MatrixXd J = general_jacobian(block, in);
    for (Eigen::Index b = 0; b < block.bodies; ++b) {
      J.middleCols<3>(6 * b + 3) *= rotation(pose_of(in, b));
    }
    expect_near(block, "J diag(E, A)", matrix(evaluate_one(block, in), local_jacobian, J.cols()), J, round_off);
  });
}

// K does not depend on the axes of J's columns: J_b with the inertia tensor in body axes gives the same K.
TEST(Forms, local_has_the_same_K) {
  for_all_in_space([](const AnyBlock& block, const Inputs& in) {
    const Outputs out = evaluate_one(block, in);
    const Eigen::MatrixXd J = matrix(out, local_jacobian, static_cast<Eigen::Index>(block.columns()));
    Eigen::MatrixXd inverse_mass = inverse_masses(block, in);
    for (Eigen::Index b = 0; b < block.bodies; ++b) {
      const Eigen::Matrix3d A = rotation(pose_of(in, b));
      auto I = inverse_mass.block<3, 3>(6 * b + 3, 6 * b + 3);
      I = (A.transpose() * I * A).eval();
    }
    const Eigen::MatrixXd K = symmetric(out.of[effective_mass], block.rows);
    expect_near(block, "J_b M_b^-1 J_b^T", J * inverse_mass * J.transpose(), K, round_off * (1 + K.norm()));
  });
}

TEST(Forms, euler_is_J_times_2G) {
  for_all_in_space([](const AnyBlock& block, const Inputs& in) {
    const Eigen::MatrixXd J = general_jacobian(block, in);
    Eigen::MatrixXd by_parameters(block.rows, 7 * block.bodies);
    for (Eigen::Index b = 0; b < block.bodies; ++b) {
      by_parameters.middleCols<3>(7 * b) = J.middleCols<3>(6 * b);
      by_parameters.middleCols<4>(7 * b + 3) = 2 * J.middleCols<3>(6 * b + 3) * rates(parameters(pose_of(in, b)));
    }
    expect_near(block, "J diag(E, 2 G)", matrix(evaluate_one(block, in), euler_jacobian, by_parameters.cols()),
                by_parameters, round_off);
  });
}

// Compares the columns of the Euler parameters with differences of C along rates with e . edot = 0.
TEST(Forms, euler_is_the_difference_of_position_where_parameters_stay_of_length_one) {
  for_all_in_space([](const AnyBlock& block, const Inputs& in) {
    for (const RowKind kind : block.row_kinds) {
      if (kind == RowKind::velocity) return;
    }
    const Outputs out = evaluate_one(block, in);
    const Eigen::MatrixXd J = matrix(out, euler_jacobian, 7 * block.bodies);
    for (Eigen::Index b = 0; b < block.bodies; ++b) {
      const Eigen::Vector4d e = parameters(pose_of(in, b));
      Eigen::Vector4d rate(0.3, -0.5, 0.7, 0.2);
      rate -= e.dot(rate) * e;
      const auto at = [&](double s) {
        Inputs moved = in;
        set_orientation(&moved.q[16 * static_cast<std::size_t>(b)], e + s * rate);
        return Eigen::MatrixXd(vector(evaluate_one(block, moved).of[position]));
      };
      expect_near(block, "J_c edot = Cdot", J.middleCols<4>(7 * b + 3) * rate, derivative_at_zero(at), 1e-8);
    }
  });
}

TEST(Forms, a_sphere_like_body_is_one_with_the_tensor_of_a_sphere) {
  for_all_in_space([](const AnyBlock& block, const Inputs& in) {
    Inputs ball = in;
    for (std::size_t b = 0; b < static_cast<std::size_t>(block.bodies); ++b) {
      const double m = in.m_isotropic[2 * b], I = in.m_isotropic[2 * b + 1];
      const double numbers[] = {m, I, I, I, 0, 0, 0};
      std::copy(std::begin(numbers), std::end(numbers), &ball.m[7 * b]);
    }
    const Outputs out = evaluate_one(block, ball);
    const auto same = [&](Function isotropic, Function general) {
      const Eigen::VectorXd expected = vector(out.of[general]);
      expect_near(block, function_names[isotropic], vector(out.of[isotropic]), expected,
                  round_off * (1 + expected.norm()));
    };
    same(effective_mass_isotropic, effective_mass);
    same(apply_isotropic, apply);
    same(inverse_mass_jacobian_isotropic, inverse_mass_jacobian);
  });
}
