// The bodies as arrays. Integrators and forces need only this header, no joints.
#pragma once

#include <algorithm>
#include <type_traits>
#include <vector>

#include <cdot/detail/state_array.hpp>
#include <cdot/kernel.hpp>
#include <cdot/precision.hpp>

namespace cdot {

// A copy of the struct in the number type of K.
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

// S is a space: Planar<double>, Planar<float>. All arrays are by body.
template <class S>
struct BodiesModel {
  std::vector<typename S::Pose> start;  // first pose of the body: zero of its potential energy
};

template <class S>
struct BodiesState {
  using Velocity = typename S::Velocity;
  StateArray<typename S::Pose> pose;
  StateArray<Velocity> velocity;
  StateArray<typename S::InverseMass> inverse_mass;  // exactly 0 where immovable; tensors turn with their bodies
  // The solvers' M^-1: inverse_mass, unless geometric stiffness has added to the inertias.
  StateArray<typename S::InverseMass> effective_mass;
  StateArray<Velocity> force;          // constant, beside gravity
  StateArray<Velocity> acceleration;   // M^-1 force + gravity
  StateArray<Velocity> velocity_rate;  // dv/dt, of integrators at acceleration level
};

template <class S>
struct BodiesWorkspace {
  using Velocity = typename S::Velocity;
  std::vector<Velocity> displacement;            // of the drift correction in this step
  std::vector<Velocity> increment;               // 0 between its uses
  std::vector<typename S::Stiffness> stiffness;  // of the last step's impulses
  std::vector<typename S::InverseMass> mass;     // M, for the energy of steps by sweeps
};

template <class S>
struct Bodies : BodiesModel<S>, BodiesState<S>, BodiesWorkspace<S> {
  using T = typename S::Scalar;
  int count() const { return static_cast<int>(this->pose.size()); }
  bool immovable(int body) const { return S::immovable(this->inverse_mass[static_cast<size_t>(body)]); }
};

}  // namespace cdot
