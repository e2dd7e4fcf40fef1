// One step of a Runge-Kutta method for the accelerations of an island: the index-1 form, in which gamma keeps J v =
// -dC/dt along the exact motion. What the step leaves of C and Cdot is then projected away. The last stage's factor
// serves the poses, that of the end the velocities and the first stage of the next step.
#pragma once

#include "runtime/state/world_data.hpp"
#include "runtime/step/runge_kutta_tables.hpp"

namespace cdot {

// As exact as what computes with it.
template <class S>
using RungeKuttaOf = RungeKutta<ExactNumber<typename S::Scalar>>;

template <class S>
void step_runge_kutta(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar h);
template <class S>
void prepare_runge_kutta(Island<S>& island, const RungeKuttaOf<S>& method);

// The present state, with its accelerations, is what the next steps start from; and back to it.
template <class S>
void keep_start(const WorldData<S>& world, Island<S>& island);
template <class S>
void go_back(WorldData<S>& world, Island<S>& island);

// Numbers of one body among those of a Flow.
template <class S>
inline constexpr int numbers_per_body = S::pose_numbers + S::freedom;

// The bodies' poses and velocities, and dv/dt with the poses' rates, from and to arrays of a Flow.
template <class S>
void read_numbers(const WorldData<S>& world, const Island<S>& island, typename S::Scalar* to);
template <class S>
void set_numbers(WorldData<S>& world, const Island<S>& island, const typename S::Scalar* from);

// The k of a stage at start + h sum_j a_stage,j k_j.
template <class S>
void take_stage(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, int stage,
                typename S::Scalar time, typename S::Scalar h);

// The stages of a step of h that starts at `time`; leaves its end in the bodies, not yet projected.
template <class S>
void take_stages(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar time,
                 typename S::Scalar h);

// The present state onto the constraints, with the accelerations there. `fresh`: J is not yet that of the step.
template <class S>
void project(WorldData<S>& world, Island<S>& island, typename S::Scalar time, bool fresh);

// The same for the end of a step, whose k becomes the last.
template <class S>
void project_end(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar time);

// The estimated error of the step over what is allowed [m], [rad], [m/s], [rad/s]: of velocities relative where they
// exceed 1, of no number less than its last bit.
template <class S>
double error_of_step(const Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar h, double allowed);
// The same in units of Island::size and of a radian, of velocities relative where they exceed that per second.
template <class S>
double share_of_size(const Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar h);

}  // namespace cdot
