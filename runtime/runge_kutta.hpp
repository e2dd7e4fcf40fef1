// One step of a Runge-Kutta method for the accelerations of an island: the index-1 form, in which gamma keeps J v =
// -dC/dt along the exact motion. What the step leaves of C and Cdot is then projected away. The last stage's factor
// serves the poses, that of the end the velocities and the first stage of the next step.
#pragma once

#include "runtime/runge_kutta_tables.hpp"
#include "runtime/stages.hpp"

namespace cdot {

inline const RungeKutta& runge_kutta(Integrator integrator) { return integrator == Integrator::rk4 ? rk4 : dop853; }

template <class S>
void prepare_flow(Island<S>& island, const RungeKutta& method);

// The present state, with its accelerations, is what the next steps start from; and back to it.
template <class S>
void keep_start(const WorldState<S>& world, Island<S>& island);
template <class S>
void go_back(WorldState<S>& world, Island<S>& island);

// The stages of a step of h that starts at `time`; leaves its end in the bodies, not yet projected.
template <class S>
void take_stages(WorldState<S>& world, Island<S>& island, const RungeKutta& method, typename S::Scalar time,
                 typename S::Scalar h);

// Onto the constraints, with the accelerations there.
template <class S>
void settle_end(WorldState<S>& world, Island<S>& island, const RungeKutta& method, typename S::Scalar time);

// The estimated error of the step in units of Settings::local_error; of velocities relative where they exceed 1.
template <class S>
double error_of_step(const WorldState<S>& world, const Island<S>& island, const RungeKutta& method,
                     typename S::Scalar h);

}  // namespace cdot
