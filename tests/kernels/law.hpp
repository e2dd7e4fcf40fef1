// Helpers of the laws: a block's outputs as matrices, derivatives by differences, failures with their place.
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <gtest/gtest.h>
#include <string>

#include "tests/kernels/any_block.hpp"
#include "tests/kernels/sample.hpp"

namespace cdot {

inline constexpr std::uint32_t samples = 12;  // random inputs per block and law

// One function's outputs, row by row.
Eigen::MatrixXd matrix(const Outputs& out, Function function, Eigen::Index columns);
Eigen::VectorXd vector(const std::vector<double>& numbers);
// The full symmetric K from its lower triangle.
Eigen::MatrixXd symmetric(const std::vector<double>& triangle, int rows);
// M^-1: 1/m, 1/m, 1/I of each body on the diagonal; in space 1/m, 1/m, 1/m and a block I^-1.
Eigen::MatrixXd inverse_masses(const AnyBlock& block, const Inputs& in);

Outputs evaluate_one(const AnyBlock& block, const Inputs& in);
// J with its zeros.
Eigen::MatrixXd dense_jacobian(const AnyBlock& block, const Inputs& in);

// f'(0) by central differences at three steps, extrapolated: an error of sixth order in the step.
Eigen::MatrixXd derivative_at_zero(const std::function<Eigen::MatrixXd(double)>& f);

// Entry by entry within tolerance (1 + |expected|); a failure names joint, block, law, row and
// column.
void expect_near(const AnyBlock& block, std::string_view law, const Eigen::MatrixXd& actual,
                 const Eigen::MatrixXd& expected, double tolerance);

// Checks the law for every block at several random inputs.
void for_all(const std::function<void(const AnyBlock&, const Inputs&)>& law);

// The folder of the specs behind blocks<double>(). Each program that obeys the laws defines it.
std::string specs_folder();

// False where these laws run over specs without effects.
bool has_effects();

}  // namespace cdot
