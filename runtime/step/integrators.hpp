// How the integrators of <cdot/integrators.hpp> take their steps.
#pragma once

#include "runtime/state/world_data.hpp"

namespace cdot {

template <class S>
struct Stepper {
  Integrator integrator;
  // One step of h of one island, from the impulses of one of WorldData::last_step.
  void (*step)(WorldData<S>&, Island<S>&, typename S::Scalar h);
  // Makes room in Island::flow; allocates.
  void (*prepare)(Island<S>&);
  // A step begins with the factor of all rows that the one before left.
  bool starts_from_factor;
};

template <class S>
const Stepper<S>& stepper_of(Integrator integrator);

// Euler's step of h, where the impulses at hand are those of a step of `last_step`; 0: there are none. Linearly
// implicit if the island is `stiffened`: then it is what others fall back on.
template <class S>
void step_euler(WorldData<S>& world, Island<S>& island, typename S::Scalar h, double last_step);

}  // namespace cdot
