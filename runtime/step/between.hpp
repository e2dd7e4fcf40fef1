// The state between the ends of an adaptive Runge-Kutta step: the method's interpolant, projected onto the joints. An
// adaptive step may thus end beyond the end of step(h). Later steps do not depend on this state.
#pragma once

#include "runtime/step/runge_kutta.hpp"

namespace cdot {

// Moves the bodies to Flow::ahead before the end of the last step; `time` is that of the end.
template <class S>
void go_between(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar time);

// Moves the bodies back to the end, with forces and accelerations.
template <class S>
void go_to_end(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar time);

}  // namespace cdot
