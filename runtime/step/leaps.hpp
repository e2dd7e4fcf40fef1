// Events that a step leaps over: they begin and end within it. No estimate of the error sees them.
#pragma once

#include "runtime/step/runge_kutta.hpp"

namespace cdot {

// Call at the start of a step whose length the error chooses.
template <class S>
void note_ways(const WorldData<S>& world, Island<S>& island, typename S::Scalar time);

// Call after each stage of an explicit step, which is at `share` of it: of rows that are held, how near their forces
// come to a bound; of rows that slip without a place, how near to rest. Newton needs none of these at the stages of an
// implicit step: leaps() finds them there.
template <class S>
void note_forces(const WorldData<S>& world, Island<S>& island, int stage, typename S::Scalar time, double share);

// The share of the step at its earliest stage that has passed an event, by these forces; 1: none within the step.
template <class S>
double earliest_passed_stage(const Flow<S>& flow);

// True if the step of h from `time` on, whose end is the present state, leapt over an event: a row met its end and came
// back, or came to rest and slipped on, or let go and held again, or the bound of a force rose and fell, as over the
// tooth of a ratchet. The cubic way of a row tells; where it comes near an event, the method's interpolant decides.
template <class S>
bool leaps(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar time,
           typename S::Scalar h);

}  // namespace cdot
