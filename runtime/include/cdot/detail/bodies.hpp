// The bodies as arrays. Apart from the joints: an integrator or a force needs nothing else.
#pragma once

#include <algorithm>
#include <type_traits>
#include <vector>

#include <cdot/kernel.hpp>
#include <cdot/precision.hpp>

namespace cdot {

// The same struct of numbers as K is formed of.
template <class Exact, class T, class Struct>
Exact exact(const Struct& of) {
  using Real = ExactNumber<T>;
  static_assert(sizeof(Exact) / sizeof(Real) == sizeof(Struct) / sizeof(T));
  Exact to{};
  if constexpr (std::is_same_v<Exact, Struct>) {
    to = of;
  } else if constexpr (!std::is_empty_v<Struct>) {
    const T* from = reinterpret_cast<const T*>(&of);
    std::copy_n(from, sizeof(Struct) / sizeof(T), reinterpret_cast<Real*>(&to));
  }
  return to;
}

// S is a space: Planar<double>, Planar<float>.
template <class S>
struct Bodies {
  using T = typename S::Scalar;

  std::vector<typename S::Pose> pose;
  std::vector<typename S::Velocity> velocity;
  std::vector<typename S::InverseMass> inverse_mass;  // exactly 0 where immovable
  // What the solvers divide by: inverse_mass, unless the geometric stiffness has added to the
  // inertias.
  std::vector<typename S::InverseMass> effective_mass;
  std::vector<typename S::Velocity> force;          // constant, beside gravity
  std::vector<typename S::Velocity> acceleration;   // M^-1 force + gravity, constant between calls to set_force
  std::vector<typename S::Velocity> velocity_rate;  // dv/dt, of integrators at acceleration level
  std::vector<typename S::Velocity> displacement;   // of the drift correction in this step
  std::vector<typename S::Velocity> increment;      // scratch: 0 between its uses
  std::vector<typename S::Stiffness> stiffness;     // of the last step's impulses
  std::vector<typename S::Pose> start;              // where the body was added: zero of its potential energy

  int count() const { return static_cast<int>(pose.size()); }
  bool immovable(int body) const { return S::immovable(inverse_mass[static_cast<size_t>(body)]); }
};

}  // namespace cdot
