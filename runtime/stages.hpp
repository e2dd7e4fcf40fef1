// The stages of a step, in the order in which step() calls them. One file each.
#pragma once

#include "runtime/world_state.hpp"

namespace cdot {

// Islands, order of slots, patterns: all that depends on what is connected, not on where it is.
// Allocates; does nothing if nothing was added since.
template <class S>
void prepare_topology(WorldState<S>& world);

// Island::size and ::scale, from the present poses.
template <class S>
void measure_size(WorldState<S>& world, Island<S>& island);

// velocity += h M^-1 f: constant forces, gravity, springs between points, drag.
template <class S>
void apply_forces(WorldState<S>& world, Island<S>& island, typename S::Scalar h);

// M^-1 of the same forces, explicitly, into Bodies::velocity_rate; and with the gyroscopic torques dv/dt of bodies
// without joints.
template <class S>
void push_free_bodies(WorldState<S>& world, Island<S>& island);
template <class S>
void free_accelerations(WorldState<S>& world, Island<S>& island);

// Forces of springs on coordinates, from C and its rate, become both bounds of their rows: slots [begin, end) of a
// batch under such a law.
template <class S>
void find_known_forces(WorldState<S>& world, Batch<S>& batch, int begin, int end);

// The same, and -gamma for the bias of every row; forces of springs become both bounds of their rows.
template <class S>
void ask_for_gamma(WorldState<S>& world, Island<S>& island, typename S::Scalar time);

// dv/dt with joints, at the present poses (where C and J are evaluated) and velocities: into Bodies::velocity_rate, and
// the forces that hold the joints into the batches' lambda.
template <class S>
void accelerate(WorldState<S>& world, Island<S>& island, typename S::Scalar time);

// Adds to the inertias, and to the rows of the direct solver, what the tension of the last step's impulses stiffens:
// for Integrator::implicit.
template <class S>
void stiffen_bodies(WorldState<S>& world, Island<S>& island, typename S::Scalar h);

// C, J, bias of every row at the present poses, and of rows under a law its softness and bounds.
template <class S>
void evaluate_rows(WorldState<S>& world, Island<S>& island, typename S::Scalar h);

// Impulses such that J v = -bias, by the solver of the settings. The iterative one starts from `share` of the impulses
// at hand, unless warm starting is off.
template <class S>
void solve_iterative(WorldState<S>& world, Island<S>& island, typename S::Scalar share);
template <class S>
void solve_direct(WorldState<S>& world, Island<S>& island);

// q += h v; bodies whose inertia tensor turns with them keep I w.
template <class S>
void integrate(WorldState<S>& world, Island<S>& island, typename S::Scalar h);

// The inertia tensors at the present poses, w = I^-1 L with them: for whoever moves poses, in a
// space that has gyroscopes.
template <class S>
void turn_inertias(WorldState<S>& world, Island<S>& island);
// The same with w kept in place of L.
template <class S>
void set_inertias(WorldState<S>& world, Island<S>& island);
template <class S, class F>
void for_each_gyroscope(WorldState<S>& world, const Island<S>& island, F f) {
  for (int index : island.gyroscopes) f(world.gyroscopes[index], world.gyroscopes[index].body);
}

// Brings the poses back to C = 0, and the velocities with them. Only for Drift::projection.
template <class S>
void settle_poses(WorldState<S>& world, Island<S>& island);
template <class S>
void correct_drift(WorldState<S>& world, Island<S>& island, typename S::Scalar h);

// One step of h of the integrator of the settings, for one island.
template <class S>
void step_euler(WorldState<S>& world, Island<S>& island, typename S::Scalar h);
template <class S>
void step_rattle(WorldState<S>& world, Island<S>& island, typename S::Scalar h);
template <class S>
void step_runge_kutta(WorldState<S>& world, Island<S>& island, typename S::Scalar h);

// Islands that have rested long enough fall asleep.
template <class S>
void put_to_sleep(WorldState<S>& world, double h);
// For whoever changes a force on a body: its island wakes, and goes on from where it is.
template <class S>
void wake_pushed(WorldState<S>& world, int body);
// For whoever changes where it is, how it moves, or what holds it: nothing that was computed for its island holds.
template <class S>
void wake(WorldState<S>& world, int body);

// Fills K and, where the iterative solver needs it, its factorisation.
template <class S>
void factorize_rows(WorldState<S>& world, Island<S>& island);

}  // namespace cdot
