// What the operators of hand derivations amount to: masses, inertias, rotation matrices, skew
// matrices, Euler parameters.
#pragma once

#include <span>

#include "derive/language/value.hpp"

namespace cdot::derive {

Value build_mass(Pool& pool, std::span<const Value> arguments);
Value build_inertia(Pool& pool, std::span<const Value> arguments);
Value build_skew(Pool& pool, std::span<const Value> arguments);
Value build_inverse(Pool& pool, std::span<const Value> arguments);
Value build_rotation(Pool& pool, std::span<const Value> arguments);
Value build_euler_parameters(Pool& pool, std::span<const Value> arguments);
Value build_matrix_of_rates(Pool& pool, std::span<const Value> arguments);
Value build_euler_rates(Pool& pool, std::span<const Value> arguments);

}  // namespace cdot::derive
