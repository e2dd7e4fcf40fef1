// The step functions of the integrators in <cdot/integrators.hpp>.
#pragma once

#include "runtime/state/world_data.hpp"

namespace cdot {

template <class S>
struct Stepper {
  Integrator integrator;
  // One step of h of one island. The present impulses are those of a step of WorldData::last_step.
  void (*step)(WorldData<S>&, Island<S>&, typename S::Scalar h);
  // Allocates the numbers of Island::flow.
  void (*prepare)(Island<S>&);
  // True if a step begins with the last step's factor of all rows.
  bool starts_from_factor;
  // True if the method ends its own steps where numbers in time jump.
  bool finds_pieces = false;
};

template <class S>
const Stepper<S>& stepper_of(Integrator integrator);

// Euler's step of h. The present impulses are those of a step of `last_step`; 0: none. Linearly implicit if the island
// is `stiffened`, as in the fallback of other integrators.
template <class S>
void step_euler(WorldData<S>& world, Island<S>& island, typename S::Scalar h, double last_step);

template <class S>
void step_rattle(WorldData<S>& world, Island<S>& island, typename S::Scalar h);
template <class S>
void prepare_rattle(Island<S>& island);

// The implicit midpoint rule's step of h, in parts where h is too long. The present impulses are those of a step of
// WorldData::last_step.
template <class S>
void step_midpoint(WorldData<S>& world, Island<S>& island, typename S::Scalar h);
// The same from `time` on, in parts that turn no body far; the impulses of both halves become one, `lambda`.
template <class S>
void step_midpoint_from(WorldData<S>& world, Island<S>& island, typename S::Scalar time, typename S::Scalar h);
template <class S>
void prepare_midpoint(Island<S>& island);

}  // namespace cdot
