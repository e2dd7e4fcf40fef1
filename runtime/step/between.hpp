// The state between the ends of a Runge-Kutta step: at an event, by a shorter step; or by the method's interpolant,
// projected onto the joints. An adaptive step may thus end beyond the end of step(h). Later steps do not depend on the
// interpolated state.
#pragma once

#include "runtime/step/runge_kutta.hpp"

namespace cdot {

// True if a guarded row passed an event in the last step.
template <class S>
bool passed_event(const Flow<S>& flow);

// Goes to the first event of a step of h from `time` on that passed one, with `left` to the end of step(h). Returns the
// time from the step's start to the event, or to an earlier end; 0 if an implicit method finds no shorter step.
template <class S>
typename S::Scalar go_to_event(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method,
                               typename S::Scalar time, typename S::Scalar h, typename S::Scalar left);

// Moves the bodies to `ahead` before the end of the last step, of Flow::length, which is at `time`. C stays open.
template <class S>
void look_between(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar time,
                  typename S::Scalar ahead);

// Moves the bodies to Flow::ahead before the end of the last step; `time` is that of the end. C is closed.
template <class S>
void go_between(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar time);

// Moves the bodies back to the end, with forces and accelerations.
template <class S>
void go_to_end(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar time);

}  // namespace cdot
