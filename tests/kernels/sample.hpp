// Inputs for the laws: random ones in general position, and the places where formulas divide by
// zero.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/kernels/any_block.hpp"

namespace cdot {

// Poses within 2 m, any angle; velocities and impulses within 1; unit parameters of length 1,
// scalars around 1; masses around 1, with the variant's immovable body at rest and infinitely
// heavy. Equal seeds, equal numbers.
Inputs random_inputs(const AnyBlock& block, std::uint32_t seed);

struct SingularInputs {
  std::string name;
  Inputs inputs;
};
// Coincident points, zero lengths, zero parameters, infinite masses.
std::vector<SingularInputs> singular_inputs(const AnyBlock& block, std::uint32_t seed);

// The pose after the body's number `column` (x, y, angle of each body in turn) has grown by `step`.
void move(Inputs& in, std::size_t column, double step);

}  // namespace cdot
