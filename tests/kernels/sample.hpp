// Inputs for the laws: random ones in general position, and the places where formulas divide by
// zero.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/kernels/any_block.hpp"

namespace cdot {

// Poses within 2 m, any orientation; velocities and impulses within 1; unit parameters of length 1,
// scalars around 1; masses around 1, with the variant's immovable body at rest and infinitely
// heavy. Equal seeds, equal numbers.
Inputs random_inputs(const AnyBlock& block, std::uint32_t seed);

struct SingularInputs {
  std::string name;
  Inputs inputs;
};
// Coincident points, zero lengths, zero parameters, infinite masses.
std::vector<SingularInputs> singular_inputs(const AnyBlock& block, std::uint32_t seed);

// The pose after a motion by `step` along one column of J: x, y, angle of each body in turn; in
// space x, y, z and a turn about a world axis.
void move(const AnyBlock& block, Inputs& in, std::size_t column, double step);
// The tensor of a spatial::InverseMass that starts at `mass`.
Eigen::Matrix3d inverse_inertia(const double* mass);
// e0 e1 e2 e3 of a spatial pose, made of length 1, and the rotation matrix that belongs to them.
void set_orientation(double* pose, const Eigen::Vector4d& parameters);
// All bodies turned together about the origin, and shifted.
Inputs moved_together(const AnyBlock& block, const Inputs& in);

}  // namespace cdot
