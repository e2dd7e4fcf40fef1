// One step of a Runge-Kutta method for the accelerations of an island: the index-1 form, in which gamma keeps J v =
// -dC/dt along the exact motion. A projection then removes the remaining C and Cdot. It uses the last stage's factor
// for the poses. The factor at the end serves the velocities and the next step's first stage.
#pragma once

#include <cmath>

#include "runtime/state/world_data.hpp"
#include "runtime/step/runge_kutta_tables.hpp"

namespace cdot {

// Coefficients in the number type of K.
template <class S>
using RungeKuttaOf = RungeKutta<ExactNumber<typename S::Scalar>>;

template <class S>
void step_runge_kutta(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar h);
template <class S>
void prepare_runge_kutta(Island<S>& island, const RungeKuttaOf<S>& method);

// keep_start() stores the present state and its accelerations as the start of the next steps, and books the work so
// far. `goes_on`: the state is the end of the last step. go_back() restores the start.
template <class S>
void keep_start(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar time,
                bool goes_on);
template <class S>
void go_back(WorldData<S>& world, Island<S>& island);
// Goes back from a step whose error is too large. Sweeps, and loads of friction, start from the last forces: those of a
// step that was far too long would mislead them.
template <class S>
void reject_step(WorldData<S>& world, Island<S>& island);

// Numbers of one body in the arrays of a Flow.
template <class S>
inline constexpr int numbers_per_body = S::pose_numbers + S::freedom;

// Copy the bodies' poses and velocities and FlowState::work, or their rates, to and from arrays of a Flow.
template <class S>
void read_numbers(const WorldData<S>& world, const Island<S>& island, typename S::Scalar* to);
template <class S>
void set_numbers(WorldData<S>& world, Island<S>& island, const typename S::Scalar* from);

// The k of a stage at Flow::now and time `at`.
template <class S>
void evaluate_stage(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, int stage,
                    typename S::Scalar at);

// Reads the k of a stage from the present rates of the bodies.
template <class S>
void note_stage(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, int stage,
                typename S::Scalar at);

// The k of an explicit method's stage at start + h sum_j a_stage,j k_j.
template <class S>
void take_stage(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, int stage,
                typename S::Scalar time, typename S::Scalar h);

// The stages of a step of h that starts at `time`; leaves its end in the bodies, not yet projected. False if there is
// no end: the equations of an implicit method could not be solved.
template <class S>
bool take_stages(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar time,
                 typename S::Scalar h);

// Projects the present state onto the constraints and computes its accelerations. `fresh`: J is not yet that of the
// step.
template <class S>
void project(WorldData<S>& world, Island<S>& island, typename S::Scalar time, bool fresh);

// The same for the end of a step; writes the last k.
template <class S>
void project_end(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar time);

// Estimated error of the step / `allowed` [m], [rad], [m/s], [rad/s]. The allowed error is relative for velocities
// above 1 and at least one unit in the last place of every number. Writes Flow::alike.
template <class S>
double error_of_step(Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar h, double allowed);
// In smooth steps of dop853 the estimate of fifth order is a small share of that of third order, in proportion to the
// square of the length and so to the fourth root of the local error; where a force has a kink both are as large.
// Smaller errors than this share of the allowed one tell nothing. Measured over all scenes and random mechanisms.
template <class S>
bool has_kink(const Flow<S>& flow, double local_error, double error) {
  constexpr double times_smooth = 2, least = 0.02;
  return error > least && flow.alike > times_smooth * std::sqrt(std::sqrt(local_error));
}
// Estimated error in units of Island::size and of 1 rad; relative for velocities above one such unit per second.
template <class S>
double share_of_size(Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar h);

}  // namespace cdot
