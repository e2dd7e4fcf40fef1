// The state between the ends of a Runge-Kutta step, by the method's own interpolant and back onto the constraints: a
// step of its own length need not end where a state is asked for. Nothing of it flows back into the steps that follow.
#pragma once

#include "runtime/step/runge_kutta.hpp"

namespace cdot {

// Brings the bodies from the end of the last step, or from where they stood in it, to Flow::ahead before that end;
// `time` is that of the end.
template <class S>
void go_between(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar time);

// And back to the end, forces and accelerations included.
template <class S>
void go_to_end(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar time);

}  // namespace cdot
