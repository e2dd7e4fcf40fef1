// The complete state of a run: from these numbers and the Model a run continues with the same bits. StateNumbers and
// StateArrays lie in one block of bytes (runtime/state/block.hpp). <cdot/detail/bodies.hpp> has the state of bodies,
// <cdot/detail/block.hpp> that of rows, runtime/direct/system.hpp that of systems.
#pragma once

#include <limits>

#include <cdot/detail/state_array.hpp>
#include <cdot/step_counts.hpp>

namespace cdot {

struct JointState {
  StateNumber<bool> broken = false;    // or removed
  StateNumber<bool> left_out = false;  // broken before the last analysis of islands, which left it out
  StateArray<double> parameters;
};

// Resolution of a guarded row: smaller differences of C [m, rad], its rate and its force count as 0. `hop`: one that
// leaves its end at a rate of a smaller square, while something presses it back, returns before its way counts.
template <class T>
struct Resolution {
  T C, rate, force, hop;
};

// State of the Runge-Kutta methods. Poses and velocities are numbers by body, [S::pose_numbers + S::freedom].
template <class S>
struct FlowState {
  using T = typename S::Scalar;
  StateArray<Resolution<T>> resolution;  // [guarded], as the three that follow
  StateArray<T> row_rates;               // J v + dC/dt
  StateArray<T> margins;                 // distance of rows from their next event
  StateArray<T> margins_chosen;          // the same when their modes were chosen
  StateArray<T> largest_diagonals;       // of the rows in K so far
  StateNumber<T> next_step = T(0);       // [s] that the error control proposes; 0: none yet
  StateNumber<T> longest = T(0);         // [s] of the steps so far
  StateNumber<int> slivers = 0;          // consecutive steps that were far shorter
  StateNumber<int> exhausted = 0;        // calls of step(h) that took all their steps, less those that did not
  StateNumber<bool> known = false;       // C, J, forces and dv/dt belong to the end of the last step
  // An adaptive step may end beyond the end of step(h). The bodies then stand between its ends.
  StateNumber<T> ahead = T(0);         // [s] from the bodies to its end; 0: at its end
  StateNumber<T> length = T(0);        // [s] of that step
  StateNumber<bool> end_kept = false;  // `end` and `end_forces` belong to it
  StateArray<T> start, end;            // poses and velocities of that step
  StateArray<T> end_forces;            // of the joints, by row
  StateArray<T> rates;                 // of the numbers, [stage][...]
  StateArray<T> further_terms;         // of the interpolant, [term][...]
  // Work since the start of that step [J]: put in, taken, and by source as Accounts::by_source. More numbers that the
  // method integrates, after those of the bodies. Empty if nothing in the island does work.
  StateArray<T> work;

  // Call after a change of the state from outside.
  void forget() {
    known = end_kept = false;
    ahead = T(0);
  }
};

template <class S>
struct IslandState {
  using T = typename S::Scalar;
  StateNumber<T> size = T(1);  // longest arm or distance between joined bodies [m]
  // min(1, 10 size), times the least slope of a row if that is below 1: factor of the thresholds for C.
  StateNumber<T> scale = T(1);
  StateNumber<T> residual = std::numeric_limits<T>::infinity();  // largest C after the last projection
  StateArray<T> left;                                            // by row: the error then; empty: nothing projects
  StateNumber<T> evaluated_at = T(0);                            // [s]
  StateNumber<bool> evaluated = false;                           // C and J belong to the present poses
  StateNumber<bool> factored = false;                            // the system's factor is that of this J, all rows free
  StateNumber<bool> acceleration_level = false;                  // modes decide about rows under a law
  StateNumber<bool> asleep = false;
  StateNumber<double> rested = 0.0;     // [s]
  StateNumber<int> redundant_rows = 0;  // of the last factorisation
  StateNumber<double> gained = 0.0;     // from joints, by sweeps of Euler's steps [J]; below 0: lost
  StateNumber<double> level = 0.0;      // energy of the bodies after such a step [J]
  StateNumber<bool> levelled = false;   // level is that of the present state
  StateNumber<int> slack = 0;           // further steps of Drift::soft that take the joints for slack
  // Of an island that floats: momentum (3 numbers), angular momentum about its centre of mass (3), time [s] at which
  // they were measured; negative: not yet.
  StateArray<double> momentum;
};

// The accounts of a World's energy (<cdot/balance.hpp>) [J].
struct Accounts {
  StateNumber<bool> open = false;     // true since the first step
  StateNumber<bool> changed = false;  // from outside, since the last step
  StateNumber<double> start = 0.0, put_in = 0.0, taken = 0.0;
  StateNumber<double> before_change = 0.0;  // the energy then
  StateArray<double> by_source;             // put in, less taken, by Model::sources
};

template <class S>
struct State {
  StateNumber<double> time = 0.0;
  StateNumber<double> last_step = 0.0;  // [s], the last substep; warm starting scales impulses by h / last_step
  StateNumber<StepCounts> counts;
  Accounts accounts;
  StateArray<typename S::Gyroscope> gyroscopes;  // of Model::turning
};

}  // namespace cdot
