// The rows of a table -> a cubic for each piece between them.
#pragma once

#include <array>
#include <vector>

#include <cdot/profile.hpp>

namespace cdot {

// a + b t + c t^2 + d t^3, t the time since the first row of the piece.
using Cubic = std::array<double, 4>;

// One for each row but the last; of two rows of the same time it is never used.
std::vector<Cubic> pieces_of(const ProfileTable& table);

}  // namespace cdot
