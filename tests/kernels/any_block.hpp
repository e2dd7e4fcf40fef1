// A row block of any joint or effect behind one interface of plain numbers. A law is then one ordinary function, and
// its failures name joint and block.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <cdot/kernel.hpp>

namespace cdot {

// The functions of the contract, in the order in which they are called.
enum Function {
  position,
  jacobian,  // C, then the stored fields
  effective_mass,
  factor,
  solve,
  velocity,
  apply,
  dense,
  inverse_mass_jacobian,
  gamma,
  time_derivative,
  stiffness,
  // Of effects; the energy only of those that have one, the unstored part only beside an energy.
  law_energy,
  law_force,
  law_unstored,
  law_slopes,  // k, then d
  law_limits,  // lower, then upper
  // In space only.
  effective_mass_isotropic,
  apply_isotropic,
  inverse_mass_jacobian_isotropic,
  local_jacobian,
  euler_jacobian,
  number_of_functions
};

// clang-format off
inline constexpr std::array<std::string_view, number_of_functions> function_names = {
    "position", "jacobian", "effective_mass", "factor", "solve", "velocity", "apply", "dense", "inverse_mass_jacobian",
    "gamma", "time_derivative", "stiffness", "energy", "force", "unstored", "slopes", "limits", "effective_mass_isotropic",
    "apply_isotropic", "inverse_mass_jacobian_isotropic", "local_jacobian", "euler_jacobian"};
// clang-format on

// True for functions that a variant inherits from its block.
constexpr bool inherited_by_variants(Function f) {
  return (f >= gamma && f <= law_limits) || f == local_jacobian || f == euler_jacobian;
}

// The inputs of a block's functions, laid out as in the contract: x y c s angle of each body, ... or, in space, x y z
// e0 e1 e2 e3 xx ... zz. m_isotropic has the masses of isotropic bodies.
struct Inputs {
  std::vector<double> q, v, m, m_isotropic, p, lambda, rhs, time;
};

struct Operations {
  int add = 0, multiply = 0, divide = 0, root = 0, compare = 0, call = 0;
  Operations& operator+=(const Operations& o) {
    add += o.add, multiply += o.multiply, divide += o.divide;
    root += o.root, compare += o.compare, call += o.call;
    return *this;
  }
  friend bool operator==(const Operations&, const Operations&) = default;
};

struct Outputs {
  std::array<std::vector<double>, number_of_functions> of;
  std::array<Operations, number_of_functions> cost;  // only with a counting scalar type
};

struct AnyBlock {
  int dimension;
  std::string joint, block;  // "line", "slide.a_immovable"; the ledger's names
  int bodies, rows;
  int immovable;        // index of a body, or -1
  std::size_t general;  // index of the same block with every body movable
  bool is_coordinate, is_effect, explicit_time;
  std::span<const std::string_view> row_names;
  std::span<const RowKind> row_kinds;
  std::span<const ParameterInfo> parameters;

  // Evaluates every function for one input per lane of the scalar type. A law reads its rates from `rhs`.
  std::vector<Outputs> (*evaluate)(std::span<const Inputs> lanes);
  // factor and solve for any K (lower triangle), also one that belongs to no pose.
  std::vector<double> (*factor_and_solve)(const std::vector<double>& K, const std::vector<double>& rhs);
  // Overwrites the parameters that have a default, in their order.
  void (*set_defaults)(Inputs& in);

  bool planar() const { return dimension == 2; }
  std::string_view space() const { return planar() ? "planar" : "spatial"; }
  // Numbers per body: of a pose, of a velocity (and of a row of J), of an inverse mass.
  std::size_t pose() const { return planar() ? 5 : 16; }
  std::size_t width() const { return planar() ? 3 : 6; }
  std::size_t mass() const { return planar() ? 2 : 7; }
  std::size_t columns() const { return width() * static_cast<std::size_t>(bodies); }
};

// Every block of the registry's joints and effects, computed in T.
template <class T>
const std::vector<AnyBlock>& blocks();

// The blocks of one planar and one spatial joint, in a pack T.
template <class T>
const std::vector<AnyBlock>& some_blocks();

}  // namespace cdot
