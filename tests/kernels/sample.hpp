// Inputs for the laws: random ones, and singular ones at which formulas divide by zero.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/kernels/any_block.hpp"

namespace cdot {

// Poses within 2 m, any orientation; velocities and impulses within 1; unit parameters of length 1, scalars around 1;
// masses around 1, with the variant's immovable body at rest and with inverse mass 0. Equal seeds give equal numbers.
Inputs random_inputs(const AnyBlock& block, std::uint32_t seed);

struct SingularInputs {
  std::string name;
  Inputs inputs;
};
// Coincident points, zero lengths, zero parameters, infinite masses.
std::vector<SingularInputs> singular_inputs(const AnyBlock& block, std::uint32_t seed);

// Moves a body by `step` along one column of J: x, y, angle of each body; in space x, y, z and rotations about the
// world axes.
void move(const AnyBlock& block, Inputs& in, std::size_t column, double step);
// The tensor of a spatial::InverseMass that starts at `mass`.
Eigen::Matrix3d inverse_inertia(const double* mass);
// Writes normalised e0 e1 e2 e3 and their rotation matrix to a spatial pose.
void set_orientation(double* pose, const Eigen::Vector4d& parameters);
// Rotates all bodies together about the origin and shifts them.
Inputs moved_together(const AnyBlock& block, const Inputs& in);

}  // namespace cdot
