#include "tests/bench/ulp/function.hpp"

namespace cdot::ulp {

const FunctionInfo& info(Measured which) {
  static const std::array<FunctionInfo, measured_functions> all = {{
      {"position", {poses, parameters, instant}},
      {"jacobian", {poses, parameters, instant}},
      {"effective_mass", {fields_of_J, masses}},
      {"factor", {mass_matrix}},
      {"solve", {factors, right_side}},
      {"factor_and_solve", {mass_matrix, right_side}},
      {"velocity", {fields_of_J, velocities}},
      {"apply", {fields_of_J, masses, impulses, velocities}},
      {"dense", {fields_of_J}},
      {"inverse_mass_jacobian", {fields_of_J, masses}},
      {"gamma", {poses, velocities, parameters, instant}},
      {"time_derivative", {poses, parameters, instant}},
      {"stiffness", {poses, parameters, instant, impulses}},
      {"effective_mass_isotropic", {fields_of_J, isotropic_masses}},
      {"apply_isotropic", {fields_of_J, isotropic_masses, impulses, velocities}},
      {"inverse_mass_jacobian_isotropic", {fields_of_J, isotropic_masses}},
      {"local_jacobian", {poses, fields_of_J}},
      {"euler_jacobian", {poses, fields_of_J}},
      {"impulse_fast", {fields_of_J, masses, right_side}},
      {"impulse_balanced", {fields_of_J, masses, right_side}},
      {"impulse_robust", {fields_of_J, masses, right_side}},
  }};
  return all[static_cast<std::size_t>(which)];
}

}  // namespace cdot::ulp
