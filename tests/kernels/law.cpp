#include "tests/kernels/law.hpp"

#include <algorithm>
#include <cmath>

namespace cdot {

Eigen::MatrixXd matrix(const Outputs& out, Function function, Eigen::Index columns) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const std::vector<double>& numbers = out.of[function];
  return Eigen::Map<const RowMajor>(numbers.data(), static_cast<Eigen::Index>(numbers.size()) / columns, columns);
}

Eigen::VectorXd vector(const std::vector<double>& numbers) {
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(), static_cast<Eigen::Index>(numbers.size()));
}

Eigen::MatrixXd symmetric(const std::vector<double>& triangle, int rows) {
  Eigen::MatrixXd K(rows, rows);
  std::size_t next = 0;
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j <= i; ++j) K(i, j) = K(j, i) = triangle[next++];
  }
  return K;
}

Eigen::MatrixXd inverse_masses(const AnyBlock& block, const Inputs& in) {
  const auto columns = static_cast<Eigen::Index>(block.columns()), width = static_cast<Eigen::Index>(block.width());
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(columns, columns);
  for (Eigen::Index b = 0; b < block.bodies; ++b) {
    const double* const m = &in.m[block.mass() * static_cast<std::size_t>(b)];
    auto of_body = M.block(width * b, width * b, width, width);
    of_body.diagonal().setConstant(m[0]);
    if (block.planar()) {
      of_body(2, 2) = m[1];
    } else {
      of_body.bottomRightCorner<3, 3>() = inverse_inertia(m);
    }
  }
  return M;
}

Outputs evaluate_one(const AnyBlock& block, const Inputs& in) { return block.evaluate(std::span(&in, 1)).front(); }

Eigen::MatrixXd dense_jacobian(const AnyBlock& block, const Inputs& in) {
  return matrix(evaluate_one(block, in), dense, static_cast<Eigen::Index>(block.columns()));
}

Eigen::MatrixXd derivative_at_zero(const std::function<Eigen::MatrixXd(double)>& f) {
  const auto difference = [&](double h) -> Eigen::MatrixXd { return (f(h) - f(-h)) / (2 * h); };
  constexpr double h = 1e-3;
  const Eigen::MatrixXd wide = difference(h), middle = difference(h / 2), narrow = difference(h / 4);
  return (64 * narrow - 20 * middle + wide) / 45;
}

void expect_near(const AnyBlock& block, std::string_view law, const Eigen::MatrixXd& actual,
                 const Eigen::MatrixXd& expected, double tolerance) {
  ASSERT_EQ(actual.rows(), expected.rows()) << block.space() << ' ' << block.joint << ' ' << block.block << ": " << law;
  ASSERT_EQ(actual.cols(), expected.cols()) << block.space() << ' ' << block.joint << ' ' << block.block << ": " << law;
  for (Eigen::Index i = 0; i < actual.rows(); ++i) {
    for (Eigen::Index j = 0; j < actual.cols(); ++j) {
      const double a = actual(i, j), e = expected(i, j);
      // A NaN fails this comparison.
      if (std::abs(a - e) <= tolerance * (1 + std::abs(e))) continue;
      ADD_FAILURE() << block.space() << ' ' << block.joint << ", " << block.block << ": " << law << ": row " << i
                    << ", column " << j << " is " << a << ", not " << e;
    }
  }
}

void for_all(const std::function<void(const AnyBlock&, const Inputs&)>& law) {
  ASSERT_GE(blocks<double>().size(), 20u);
  for (const AnyBlock& block : blocks<double>()) {
    for (std::uint32_t seed = 1; seed <= samples; ++seed) law(block, random_inputs(block, seed));
  }
}

bool has_effects() { return std::ranges::any_of(blocks<double>(), &AnyBlock::is_effect); }

}  // namespace cdot
