// The measured functions of a row block and their inputs.
#pragma once

#include <array>
#include <string_view>
#include <vector>

namespace cdot::ulp {

enum Piece {
  poses,
  velocities,
  masses,
  isotropic_masses,
  parameters,
  instant,
  impulses,
  right_side,
  fields_of_J,
  mass_matrix,
  factors,
  number_of_pieces
};

template <class T>
using Arguments = std::array<std::vector<T>, number_of_pieces>;

enum class Measured {
  position,
  jacobian,  // J only; position measures C
  effective_mass,
  factor,
  solve,
  factor_and_solve,  // from K to the impulse
  velocity,
  apply,
  dense,
  inverse_mass_jacobian,
  gamma,
  time_derivative,
  stiffness,
  // In space only.
  effective_mass_isotropic,
  apply_isotropic,
  inverse_mass_jacobian_isotropic,
  local_jacobian,
  euler_jacobian,
  // From J and M^-1 to the impulse of several rows, by the forms of K (Settings::kernels).
  impulse_fast,
  impulse_balanced,
  impulse_robust,
  number
};
inline constexpr auto measured_functions = static_cast<std::size_t>(Measured::number);

constexpr bool only_in_space(Measured which) {
  return which >= Measured::effective_mass_isotropic && which <= Measured::euler_jacobian;
}

struct FunctionInfo {
  std::string_view name;  // as in the ledger; factor_and_solve is the sum of two
  std::vector<Piece> reads;
};
const FunctionInfo& info(Measured which);

}  // namespace cdot::ulp
